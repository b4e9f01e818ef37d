//! A lesson under way: the machine of the learner is set aside as it stands, and a practice
//! machine takes its place until he leaves.

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

/// What may be asked of lessons.
#[derive(Clone, Debug)]
pub enum LessonOrder {
    /// Begin this one, from its beginning.
    Begin(Arc<Lesson>),
    /// Show this from its beginning to its end.
    Show(Arc<Lesson>),
    /// Press the keys of the step under way.
    ShowMe,
    /// Put the practice machine to where the step before began.
    Back,
    /// Put it to where the lesson begins.
    Again,
    /// Give the learner his own machine back.
    Leave,
}

/// The lesson under way, for the window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LessonState {
    /// Its name.
    pub name: String,
    /// How far it has come.
    pub view: View,
}

/// A practice machine, and what it has taken the place of.
#[derive(Debug)]
pub(super) struct Practising {
    practice: Practice,
    own: Box<Emulator>,
    own_part: PartSide,
    own_opened: Option<LastOpened>,
    own_raised: Raised,
}

impl Practising {
    /// One millisecond of the practice machine.
    pub(super) fn tick(&mut self, emulator: &mut Emulator) {
        self.practice.tick(emulator);
    }

    /// For the window.
    pub(super) fn state(&self) -> LessonState {
        LessonState {
            name: self.practice.lesson().name.clone(),
            view: self.practice.view(),
        }
    }

    /// The learner's own machine.
    pub(super) fn own(&mut self) -> &mut Emulator {
        &mut self.own
    }

    /// The learner's own part: what is asked of his job is for after the lesson.
    pub(super) const fn own_part(&mut self) -> &mut PartSide {
        &mut self.own_part
    }
}

impl Kernel {
    /// The machine whose memory is kept: the learner's own, also during a lesson.
    pub(super) fn kept(&self) -> &Emulator {
        match &self.lesson {
            Some(lesson) => &lesson.own,
            None => &self.emulator,
        }
    }

    /// Does what is asked of lessons.
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

    /// The learner presses a key himself: nothing is shown to him any more.
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

    /// Shows something, unless the learner is in a lesson: it would be lost.
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

    /// Puts a practice machine in the place of the learner's own.
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

    /// Gives the learner his own machine back, as it stood.
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
