//! The practice machine in use, what the learner does at it, and his own state that it replaces.

use gsk_core::machine::LatheConfig;
use gsk_lesson::{Practice, PracticeView};
use gsk_panel::emulator::Emulator;

use super::alarm_history::AlarmHistory;
use super::exercise_run::ExerciseRun;
use super::part::KernelPart;
use super::program::opening::LastOpened;
use super::program::start::StartWatch;
use super::timeline::Timeline;

/// The state of the current lesson that the window shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LessonState {
    pub name: String,
    /// The current step of the lesson, with the texts that the window displays.
    pub view: PracticeView,
}

/// The lesson or exercise that the learner does at the practice machine.
#[derive(Debug)]
pub(super) enum PracticeWork {
    /// He follows the steps of a lesson, or watches a demonstration.
    Lesson(Box<Practice>),
    /// The learner solves this exercise.
    Exercise(ExerciseRun),
}

/// The learner's own machine with its part and recorders, while a practice machine replaces it.
#[derive(Debug)]
pub(super) struct OwnState {
    pub(super) emulator: Box<Emulator>,
    pub(super) part: KernelPart,
    pub(super) opened: Option<LastOpened>,
    pub(super) raised: AlarmHistory,
    pub(super) start_watch: StartWatch,
    /// His time line, while an exercise has a separate one.
    pub(super) timeline: Option<Timeline>,
}

/// A practice machine in use, and the learner's own state that it replaces.
#[derive(Debug)]
pub(super) struct PracticeSession {
    work: PracticeWork,
    own: OwnState,
}

impl PracticeSession {
    pub(super) const fn new(work: PracticeWork, own: OwnState) -> Self {
        Self { work, own }
    }

    /// Ends the session and returns the state of the learner's own machine.
    pub(super) fn into_own(self) -> OwnState {
        self.own
    }

    /// Runs one tick of the practice on `emulator`, the practice machine.
    pub(super) fn tick(&mut self, emulator: &mut Emulator) {
        match &mut self.work {
            PracticeWork::Lesson(practice) => practice.tick(emulator),
            PracticeWork::Exercise(_) => emulator.tick(),
        }
    }

    /// Returns the state of the lesson for the window; `None` in an exercise.
    pub(super) fn state(&self) -> Option<LessonState> {
        match &self.work {
            PracticeWork::Lesson(practice) => Some(LessonState {
                name: practice.lesson().name.clone(),
                view: practice.view(),
            }),
            PracticeWork::Exercise(_) => None,
        }
    }

    /// Returns the exercise; `None` in a lesson.
    pub(super) const fn exercise(&self) -> Option<&ExerciseRun> {
        match &self.work {
            PracticeWork::Lesson(_) => None,
            PracticeWork::Exercise(run) => Some(run),
        }
    }

    /// Returns the exercise; `None` in a lesson.
    pub(super) const fn exercise_mut(&mut self) -> Option<&mut ExerciseRun> {
        match &mut self.work {
            PracticeWork::Lesson(_) => None,
            PracticeWork::Exercise(run) => Some(run),
        }
    }

    /// Returns the lesson; `None` in an exercise.
    pub(super) fn practice_mut(&mut self) -> Option<&mut Practice> {
        match &mut self.work {
            PracticeWork::Lesson(practice) => Some(practice),
            PracticeWork::Exercise(_) => None,
        }
    }

    /// Returns the learner's own machine, which the practice machine replaces.
    pub(super) fn own(&mut self) -> &mut Emulator {
        &mut self.own.emulator
    }

    /// Returns the learner's own machine, which waits during the practice.
    pub(super) fn own_machine(&self) -> &Emulator {
        &self.own.emulator
    }

    /// Returns the learner's own machine with its part and recorders.
    pub(super) const fn own_state(&mut self) -> &mut OwnState {
        &mut self.own
    }

    /// Returns the learner's own part and lathe. A job that is set during the lesson goes to
    /// them, and applies after the lesson.
    pub(super) fn own_part(&mut self) -> (&mut KernelPart, &LatheConfig) {
        (&mut self.own.part, self.own.emulator.lathe().config())
    }
}
