//! Runs exercises: the machine of a task replaces the learner's own machine, and everything that
//! the learner does at it is recorded until he hands in.

use std::sync::Arc;

use gsk_exercise::task::ExerciseTask;
use gsk_history::moment::MachineMoment;
use gsk_messages::{Message, say};

use super::exercise_run::{ExamTask, ExerciseRun};
use super::practice_session::{PracticeSession, PracticeWork};
use super::timeline::changes_machine;
use super::{Command, Kernel, Notice};
use crate::flight::join_inputs;

/// A command of the window for an exercise.
#[derive(Clone, Debug)]
pub enum ExerciseAction {
    /// Start this exercise at its beginning.
    Begin(Arc<ExerciseTask>),
    /// End the recording of the current exercise and hand it in.
    HandIn,
    /// Start or continue an exercise of an exam.
    BeginExam(Box<ExamTask>),
    /// Pause the exam (true) or continue it; the window checks the PIN before.
    PauseExam(bool),
    /// Leave an exam that has ended.
    LeaveExam,
    /// Show the machine at this time of the solution that was handed in, ms.
    ShowMoment(u64),
}

impl ExerciseAction {
    /// Returns whether the action changes the machine.
    pub(super) const fn changes_machine(&self) -> bool {
        match self {
            Self::Begin(_) | Self::HandIn | Self::BeginExam(_) | Self::LeaveExam => true,
            Self::ShowMoment(_) | Self::PauseExam(_) => false,
        }
    }
}

impl Kernel {
    pub(super) fn execute_exercise_command(&mut self, action: ExerciseAction) {
        match action {
            ExerciseAction::Begin(task) => self.begin_exercise(task),
            ExerciseAction::HandIn => self.hand_in_exercise(),
            ExerciseAction::BeginExam(exam) => {
                // The exercise before it has been handed in.
                self.leave_lesson();
                if let Some(why) = self.practice_refusal() {
                    return self.notify(Notice::Message(why));
                }
                let begun = ExerciseRun::begin_in_exam(&exam, self.tick);
                self.start_exercise(begun);
            }
            ExerciseAction::PauseExam(is_paused) => self.pause_exam(is_paused),
            ExerciseAction::LeaveExam => self.leave_lesson(),
            ExerciseAction::ShowMoment(elapsed_ms) => {
                let run = self.lesson.as_ref().and_then(PracticeSession::exercise);
                if let Some(start) = run.map(ExerciseRun::start_tick) {
                    self.look_at(start + elapsed_ms);
                }
            }
        }
    }

    fn begin_exercise(&mut self, task: Arc<ExerciseTask>) {
        if let Some(why) = self.practice_refusal() {
            return self.notify(Notice::Message(why));
        }
        let begun = ExerciseRun::begin(task, self.tick);
        self.start_exercise(begun);
    }

    fn start_exercise(&mut self, begun: Result<(ExerciseRun, MachineMoment), Message>) {
        match begun {
            Ok((run, MachineMoment { emulator, part })) => {
                self.start_session(PracticeWork::Exercise(run), emulator);
                self.part.replace_state(part);
                self.timeline
                    .follow(&self.emulator, self.part.state(), &[], false);
            }
            Err(why) => self.notify(Notice::Message(why)),
        }
    }

    fn pause_exam(&mut self, is_paused: bool) {
        self.release_all_keys();
        self.record_exercise();
        let run = self.lesson.as_mut();
        if let Some(run) = run.and_then(PracticeSession::exercise_mut) {
            run.set_paused(is_paused);
        }
    }

    /// Whether the instructor has paused an exam, so that machine time is halted.
    pub(super) fn is_exam_paused(&self) -> bool {
        let run = self.lesson.as_ref().and_then(PracticeSession::exercise);
        run.is_some_and(ExerciseRun::is_paused)
    }

    /// Whether the machine of an exam replaces the learner's own one.
    pub(super) fn is_in_exam(&self) -> bool {
        let run = self.lesson.as_ref().and_then(PracticeSession::exercise);
        run.is_some_and(ExerciseRun::is_exam)
    }

    /// Refuses commands during an exercise that are no work at the machine, with a notice: the
    /// recording of a solution contains only inputs of an operator. A click on a fault at the bench
    /// repairs it. Returns whether the command is done with.
    pub(super) fn is_settled_in_exercise(&mut self, command: &Command) -> bool {
        if !self.is_in_exercise() || !changes_machine(command) {
            return false;
        }
        let leaves_exam = match command {
            Command::Lesson(_) => true,
            Command::Exercise(action) => matches!(action, ExerciseAction::Begin(_)),
            _ => false,
        };
        if self.is_in_exam() && leaves_exam {
            self.notify(Notice::Message(say::exam_no_help()));
            return true;
        }
        if self.is_exam_paused() && !matches!(command, Command::Exercise(_)) {
            self.notify(Notice::Message(say::exam_paused()));
            return true;
        }
        match command {
            Command::Fault(fault, _) => {
                self.emulator.set_fault(*fault, false);
                let repaired = say::exercise_repaired(fault.row().label());
                self.notify(Notice::Message(repaired));
                true
            }
            // It would repair a hidden fault of the same kind: a click on the bench is a guess.
            Command::FreeLathe if self.hides_faults() => {
                self.notify(Notice::Message(say::exercise_repair_at_bench()));
                true
            }
            Command::Key { .. }
            | Command::Tap(_)
            | Command::Type(_)
            | Command::Turn(_)
            | Command::FitGraphic { .. }
            | Command::FreshStock
            | Command::FreeLathe
            | Command::PowerCycle
            | Command::Lesson(_)
            | Command::Exercise(_) => false,
            _ => {
                self.notify(Notice::Message(say::exercise_keys_only()));
                true
            }
        }
    }

    /// Whether the machine of an exercise replaces the learner's own one.
    pub(super) fn is_in_exercise(&self) -> bool {
        let session = self.lesson.as_ref();
        session.is_some_and(|session| session.exercise().is_some())
    }

    /// Whether the current exercise is to find faults, which therefore are not shown.
    pub(super) fn hides_faults(&self) -> bool {
        let run = self.lesson.as_ref().and_then(PracticeSession::exercise);
        run.is_some_and(ExerciseRun::hides_faults)
    }

    /// Hands the exercise in when its time limit is exceeded.
    pub(super) fn follow_exercise(&mut self) {
        let run = self.lesson.as_ref().and_then(PracticeSession::exercise);
        if run.is_some_and(|run| run.is_time_over(&self.emulator)) {
            self.hand_in_exercise();
        }
    }

    /// Records the inputs of the learner at the machine of an exercise up to this tick.
    pub(super) fn record_exercise(&mut self) {
        let run = self.lesson.as_mut();
        let Some(run) = run.and_then(PracticeSession::exercise_mut) else {
            return;
        };
        let inputs = self.emulator.take_inputs();
        let inputs = join_inputs(self.emulator.ticks(), inputs, self.part.take_inputs());
        self.timeline
            .follow(&self.emulator, self.part.state(), &inputs, false);
        if let Err(why) = run.record(&self.emulator, inputs) {
            self.notify(Notice::Message(why));
        }
    }

    fn hand_in_exercise(&mut self) {
        self.release_all_keys();
        self.record_exercise();
        let run = self.lesson.as_mut();
        let run = run.and_then(PracticeSession::exercise_mut);
        match run.and_then(|run| run.hand_in(&self.emulator)) {
            Some(Ok(solution)) => self.notify(Notice::HandedIn(Box::new(solution))),
            Some(Err(why)) => self.notify(Notice::Message(why)),
            None => {}
        }
    }
}

#[cfg(test)]
mod tests;
