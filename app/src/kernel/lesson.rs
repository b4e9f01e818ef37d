//! Runs lessons: a practice machine replaces the learner's own machine until the learner
//! leaves the lesson.

use std::sync::Arc;

use gsk_core::operation::RunState;
use gsk_messages::{Message, say};
use gsk_panel::emulator::Emulator;
use gsk_runner::lesson::{Lesson, Practice, View, demonstration_named};
use gsk_workpiece::job::Job;
use gsk_workpiece::stock::Stock;

use super::opening::LastOpened;
use super::part::PartSide;
use super::raised::Raised;
use super::refused::Refusals;
use super::{Kernel, Notice};
use crate::job::Chosen;

/// A command for lessons.
#[derive(Clone, Debug)]
pub enum LessonOrder {
    /// Start this lesson at its beginning.
    Begin(Arc<Lesson>),
    /// Demonstrate this lesson from its beginning to its end.
    Show(Arc<Lesson>),
    /// Press the keys of the current step for the learner.
    ShowMe,
    /// Return the practice machine to the beginning of the previous step.
    Back,
    /// Return the practice machine to the beginning of the lesson.
    Again,
    /// End the lesson and return to the learner's own machine.
    Leave,
}

/// The lesson under way, for the window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LessonState {
    pub name: String,
    /// Progress of the lesson.
    pub view: View,
}

/// A practice machine, and the learner's own state that it replaces.
#[derive(Debug)]
pub(super) struct Practising {
    practice: Practice,
    own: Box<Emulator>,
    own_part: PartSide,
    own_opened: Option<LastOpened>,
    own_raised: Raised,
}

impl Practising {
    /// Runs one tick of the practice machine.
    pub(super) fn tick(&mut self, emulator: &mut Emulator) {
        self.practice.tick(emulator);
    }

    /// Returns the state for the window.
    pub(super) fn state(&self) -> LessonState {
        LessonState {
            name: self.practice.lesson().name.clone(),
            view: self.practice.view(),
        }
    }

    /// Returns the learner's own machine.
    pub(super) fn own(&mut self) -> &mut Emulator {
        &mut self.own
    }

    /// Returns the learner's own part: a job set during the lesson applies after it.
    pub(super) const fn own_part(&mut self) -> &mut PartSide {
        &mut self.own_part
    }
}

impl Kernel {
    /// Returns the machine whose memory is saved: the learner's own, also during a lesson.
    pub(super) fn kept(&self) -> &Emulator {
        match &self.lesson {
            Some(lesson) => &lesson.own,
            None => &self.emulator,
        }
    }

    pub(super) fn order_lesson(&mut self, order: LessonOrder) {
        match order {
            LessonOrder::Begin(lesson) => self.begin_lesson(lesson),
            LessonOrder::Show(lesson) => self.show_lesson(lesson),
            LessonOrder::Leave => self.leave_lesson(),
            LessonOrder::ShowMe => self.at_practice(Practice::show_me),
            LessonOrder::Back => self.at_practice(Practice::back),
            LessonOrder::Again => self.at_practice(Practice::again),
        }
    }

    fn at_practice(&mut self, act: impl FnOnce(&mut Practice, &mut Emulator)) {
        self.let_go_of_keys();
        if let Some(lesson) = &mut self.lesson {
            act(&mut lesson.practice, &mut self.emulator);
            self.part.fresh_stock();
        }
    }

    /// The learner presses a key: this ends a demonstration.
    pub(super) fn learner_acts(&mut self) {
        if let Some(lesson) = &mut self.lesson {
            lesson.practice.interrupt(&mut self.emulator);
        }
    }

    fn begin_lesson(&mut self, lesson: Arc<Lesson>) {
        if self.drive.is_some() {
            return self.say(Notice::Said(say::lesson_not_with_board()));
        }
        if self.own_machine_runs() {
            return self.say(Notice::Said(say::lesson_not_while_running()));
        }
        let job = lesson.job.clone();
        self.practise(Practice::begin(lesson), job);
    }

    /// Starts a demonstration, unless the learner is in a lesson: its progress would be
    /// lost.
    fn show_lesson(&mut self, lesson: Arc<Lesson>) {
        let under_way = self.lesson.as_ref().map(Practising::state);
        if under_way.is_some_and(|it| demonstration_named(&it.name).is_none()) {
            return self.say(Notice::Said(say::shown_lesson_under_way()));
        }
        if self.drive.is_some() {
            return self.say(Notice::Said(say::shown_not_with_board()));
        }
        if self.own_machine_runs() {
            return self.say(Notice::Said(say::shown_not_while_running()));
        }
        let job = lesson.job.clone();
        self.practise(Practice::demonstrate(lesson), job);
    }

    fn own_machine_runs(&self) -> bool {
        let run = self.kept().simulation.cnc.run_state();
        !matches!(run, RunState::Reset | RunState::Stop)
    }

    /// Replaces the learner's own machine with a practice machine.
    fn practise(&mut self, begun: Result<(Practice, Emulator), Message>, job: Option<Job>) {
        let (practice, machine) = match begun {
            Ok(begun) => begun,
            Err(why) => return self.say(Notice::Said(why)),
        };
        self.leave_lesson();
        self.let_go_of_keys();
        let beside = self.part.beside();
        let own = Practising {
            practice,
            own: Box::new(core::mem::replace(&mut self.emulator, machine)),
            own_part: core::mem::replace(&mut self.part, beside),
            own_opened: self.opened.take(),
            own_raised: core::mem::take(&mut self.raised),
        };
        self.lesson = Some(own);
        self.part.set(Some(Chosen {
            job: job.unwrap_or_else(|| Job::new(Stock::bar(50.0, 0.0, 60.0))),
            file: None,
        }));
        self.refusals = Refusals::default();
    }

    /// Restores the learner's own machine unchanged.
    pub(super) fn leave_lesson(&mut self) {
        self.let_go_of_keys();
        if let Some(lesson) = self.lesson.take() {
            self.emulator = *lesson.own;
            self.part = lesson.own_part.with_switches_of(&self.part);
            self.opened = lesson.own_opened;
            self.raised = lesson.own_raised;
            self.refusals = Refusals::default();
        }
    }

    fn let_go_of_keys(&mut self) {
        self.release_all();
        self.learner_acts();
    }
}
