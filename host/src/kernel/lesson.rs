//! Runs lessons and exercises: a practice machine replaces the learner's own machine until the
//! learner leaves it.

use std::sync::Arc;

use gsk_core::operation::RunState;
use gsk_lesson::{Lesson, Practice, find_demonstration};
use gsk_messages::{Message, say};
use gsk_panel::emulator::Emulator;

use super::practice_session::{OwnState, PracticeSession, PracticeWork};
use super::{Kernel, Notice};
use crate::job::SelectedJob;

/// A command of the window for a lesson.
#[derive(Clone, Debug)]
pub enum LessonAction {
    /// Start this lesson at its beginning.
    Begin(Arc<Lesson>),
    /// Demonstrate this lesson from its beginning to its end.
    Demonstrate(Arc<Lesson>),
    /// Press the keys of the current step on behalf of the learner.
    ShowMe,
    /// Return the practice machine to the beginning of the previous step.
    Back,
    /// Return the practice machine to the beginning of the lesson.
    Restart,
    /// End the lesson and return to the learner's own machine.
    Leave,
}

impl Kernel {
    /// Returns the machine whose memory is saved: the learner's own, also during a lesson.
    pub(super) fn own_machine(&self) -> &Emulator {
        match &self.lesson {
            Some(lesson) => lesson.own_machine(),
            None => &self.emulator,
        }
    }

    pub(super) fn execute_lesson_command(&mut self, order: LessonAction) {
        match order {
            LessonAction::Begin(lesson) => self.begin_lesson(lesson),
            LessonAction::Demonstrate(lesson) => self.demonstrate_lesson(lesson),
            LessonAction::Leave => self.leave_lesson(),
            LessonAction::ShowMe => self.act_on_practice(Practice::show_me),
            LessonAction::Back => self.act_on_practice(Practice::go_back),
            LessonAction::Restart => self.act_on_practice(Practice::restart),
        }
    }

    fn act_on_practice(&mut self, act: impl FnOnce(&mut Practice, &mut Emulator)) {
        self.release_keys();
        let session = self.lesson.as_mut();
        if let Some(practice) = session.and_then(PracticeSession::practice_mut) {
            act(practice, &mut self.emulator);
            self.part.fresh_stock();
        }
    }

    /// Ends a running demonstration, because the learner has pressed a key.
    pub(super) fn interrupt_demonstration(&mut self) {
        let session = self.lesson.as_mut();
        if let Some(practice) = session.and_then(PracticeSession::practice_mut) {
            practice.interrupt(&mut self.emulator);
        }
    }

    /// Returns the reason why no lesson or exercise can begin at the moment; `None` if one can.
    pub(super) fn practice_refusal(&self) -> Option<Message> {
        if self.drive.is_some() {
            return Some(say::lesson_not_with_board());
        }
        let is_running = self.is_own_machine_running();
        is_running.then(say::lesson_not_while_running)
    }

    fn begin_lesson(&mut self, lesson: Arc<Lesson>) {
        if let Some(why) = self.practice_refusal() {
            return self.notify(Notice::Message(why));
        }
        self.start_practice(Practice::begin(lesson));
    }

    /// Starts a demonstration. If the learner is in a lesson, a board is connected or a program
    /// runs, sends a notice instead.
    fn demonstrate_lesson(&mut self, lesson: Arc<Lesson>) {
        let is_shown = |session: &PracticeSession| {
            let state = session.state();
            state.is_some_and(|it| find_demonstration(&it.name).is_some())
        };
        if self.lesson.as_ref().is_some_and(|it| !is_shown(it)) {
            return self.notify(Notice::Message(say::shown_lesson_under_way()));
        }
        if self.drive.is_some() {
            return self.notify(Notice::Message(say::shown_not_with_board()));
        }
        if self.is_own_machine_running() {
            return self.notify(Notice::Message(say::shown_not_while_running()));
        }
        self.start_practice(Practice::demonstrate(lesson));
    }

    fn is_own_machine_running(&self) -> bool {
        let run = self.own_machine().cnc().run_state();
        !matches!(run, RunState::Reset | RunState::Stop)
    }

    /// Replaces the learner's own machine with a practice machine, or notifies the window why the
    /// practice did not begin.
    fn start_practice(&mut self, begun: Result<(Practice, Emulator), Message>) {
        let (practice, machine) = match begun {
            Ok(begun) => begun,
            Err(why) => return self.notify(Notice::Message(why)),
        };
        let lesson = practice.lesson();
        let model = lesson.start.model();
        if model != self.own_machine().cnc().model().id() {
            self.notify(Notice::Message(say::lesson_on_model(model.name())));
        }
        let chosen = SelectedJob {
            job: lesson.stock_and_tools(),
            file: Some(format!("{}.ron", lesson.name).into()),
        };
        self.start_session(PracticeWork::Lesson(Box::new(practice)), machine);
        self.part
            .set_job(Some(chosen), self.emulator.lathe().config());
    }

    /// Replaces the learner's own machine, with its part, by a practice machine without a part.
    pub(super) fn start_session(&mut self, work: PracticeWork, machine: Emulator) {
        self.leave_lesson();
        self.release_keys();
        let lathe = machine.lathe().config();
        let beside = self.part.empty_for_same_window().with_empty_chuck(lathe);
        let timeline = match work {
            PracticeWork::Exercise(_) => {
                let empty = self.timeline.empty_for_same_window();
                Some(core::mem::replace(&mut self.timeline, empty))
            }
            PracticeWork::Lesson(_) => None,
        };
        let own = OwnState {
            timeline,
            emulator: Box::new(core::mem::replace(&mut self.emulator, machine)),
            part: core::mem::replace(&mut self.part, beside),
            opened: self.last_opened.take(),
            raised: core::mem::take(&mut self.alarm_history),
            start_watch: core::mem::take(&mut self.start_watch),
        };
        self.lesson = Some(PracticeSession::new(work, own));
        self.clear_key_refusals();
    }

    /// Ends the lesson and restores the learner's own machine unchanged; does nothing outside
    /// lessons.
    pub(super) fn leave_lesson(&mut self) {
        self.release_keys();
        if let Some(lesson) = self.lesson.take() {
            let own = lesson.into_own();
            self.emulator = *own.emulator;
            self.part = own.part.with_switches_of(&self.part);
            self.last_opened = own.opened;
            self.alarm_history = own.raised;
            if let Some(timeline) = own.timeline {
                self.timeline = timeline.with_switch_of(&self.timeline);
            }
            self.clear_key_refusals();
            self.start_watch = own.start_watch;
        }
    }

    fn release_keys(&mut self) {
        self.release_all_keys();
        self.interrupt_demonstration();
    }
}
