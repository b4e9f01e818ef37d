//! Runs exercises: the machine of a task replaces the learner's own machine, and everything that
//! the learner does at it is recorded until he hands in.

use std::sync::Arc;

use gsk_exercise::task::ExerciseTask;
use gsk_history::moment::MachineMoment;
use gsk_messages::say;

use super::exercise_run::ExerciseRun;
use super::practice_session::{PracticeSession, PracticeWork};
use super::timeline::changes_machine;
use super::{Command, Kernel, Notice};
use crate::flight::join_inputs;

/// A command of the window for an exercise.
#[derive(Clone, Debug)]
pub enum ExerciseAction {
    /// Start this exercise at its beginning.
    Begin(Arc<ExerciseTask>),
    /// End the recording and hand it in.
    HandIn,
    /// Show the machine at this time of the solution that was handed in, ms.
    ShowMoment(u64),
}

impl ExerciseAction {
    /// Returns whether the action changes the machine.
    pub(super) const fn changes_machine(&self) -> bool {
        match self {
            Self::Begin(_) | Self::HandIn => true,
            Self::ShowMoment(_) => false,
        }
    }
}

impl Kernel {
    pub(super) fn execute_exercise_command(&mut self, action: ExerciseAction) {
        match action {
            ExerciseAction::Begin(task) => self.begin_exercise(task),
            ExerciseAction::HandIn => self.hand_in_exercise(),
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
        match ExerciseRun::begin(task, self.tick) {
            Ok((run, MachineMoment { emulator, part })) => {
                self.start_session(PracticeWork::Exercise(run), emulator);
                self.part.replace_state(part);
                self.timeline
                    .follow(&self.emulator, self.part.state(), &[], false);
            }
            Err(why) => self.notify(Notice::Message(why)),
        }
    }

    /// Refuses what is no work at the machine during an exercise, with a notice: the recording of
    /// a solution has only inputs of an operator. A click on a fault at the bench is its repair.
    /// Returns whether the command is done with.
    pub(super) fn is_settled_in_exercise(&mut self, command: &Command) -> bool {
        if !self.is_in_exercise() || !changes_machine(command) {
            return false;
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

    /// Hands in when the time is over.
    pub(super) fn follow_exercise(&mut self) {
        let run = self.lesson.as_ref().and_then(PracticeSession::exercise);
        if run.is_some_and(|run| run.is_time_over(&self.emulator)) {
            self.hand_in_exercise();
        }
    }

    /// Records what the learner has done at the machine of an exercise up to this tick.
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
mod tests {
    use gsk_core::machine::LatheFault;
    use gsk_core::setup::Setup;
    use gsk_exercise::judge::judge;
    use gsk_exercise::library::built_in_tasks;
    use gsk_exercise::report::ExerciseReport;
    use gsk_panel::emulator::Emulator;
    use gsk_panel::keys::Key;

    use super::*;
    use crate::kernel::{Console, LessonAction};
    use crate::ports::dnc::DncSource;

    /// A kernel in an exercise.
    struct Started {
        kernel: Kernel,
        console: Console,
        task: Arc<ExerciseTask>,
    }

    fn start(id: &str) -> Started {
        let (mut kernel, console) = Kernel::new(Emulator::new(Setup::default()));
        kernel.set_dnc_source(DncSource::File("no-file.CNC".into()));
        let mut tasks = built_in_tasks().into_iter();
        let task = Arc::new(tasks.find(|task| task.id == id).expect("an exercise"));
        let mut started = Started {
            kernel,
            console,
            task: Arc::clone(&task),
        };
        started.send(Command::Exercise(ExerciseAction::Begin(task)), 100);
        started
    }

    impl Started {
        fn send(&mut self, command: Command, ticks: u64) {
            self.console.send(command);
            self.kernel.run(ticks);
        }

        fn tap(&mut self, keys: &[Key]) {
            for key in keys {
                self.send(Command::Tap(*key), 300);
            }
        }

        fn enter(&mut self, words: &[&str]) {
            for word in words {
                for letter in word.chars() {
                    self.send(Command::Type(letter), 100);
                }
                self.tap(&[Key::Input]);
            }
            self.tap(&[Key::CycleStart]);
        }

        fn notices(&self) -> Vec<Notice> {
            self.console.notices.try_iter().collect()
        }

        fn hand_in(&mut self) -> ExerciseReport {
            let _ = self.notices();
            self.send(Command::Exercise(ExerciseAction::HandIn), 100);
            let solution = self.notices().into_iter().find_map(|notice| match notice {
                Notice::HandedIn(solution) => Some(solution),
                _ => None,
            });
            let solution = solution.expect("a solution");
            judge(&self.task, &solution.recording).expect("marked")
        }
    }

    const MDI_PAGE: [Key; 3] = [Key::Mdi, Key::Program, Key::PageDown];

    #[test]
    fn keys_in_the_window_solve_an_exercise() {
        let mut started = start("04-spindle");
        // The proof that keys are held has expired.
        started.kernel.release_keys_and_wheel();
        started.tap(&MDI_PAGE);
        started.enter(&["S600", "M3"]);
        started.kernel.run(4000);
        started.enter(&["M5"]);
        started.kernel.run(5000);
        let report = started.hand_in();
        assert_eq!(report.unmet(), Vec::<&str>::new());
        let state = started.kernel.snapshot().exercise.expect("an exercise");
        assert!(state.is_handed_in && state.elapsed_s > 9, "{state:?}");
        started.send(Command::Lesson(LessonAction::Leave), 10);
        assert_eq!(started.kernel.snapshot().exercise, None);
    }

    #[test]
    fn what_no_operator_can_do_is_refused_and_a_crash_is_recorded() {
        let mut started = start("22-roughing-cycle");
        let job = started.kernel.part.state().job().clone();
        started.send(Command::ReleaseForcedBits, 10);
        started.send(Command::CrashStops(false), 10);
        started.send(Command::ClearFaults, 10);
        let refused = Notice::Message(say::exercise_keys_only());
        assert_eq!(
            started.notices(),
            [refused.clone(), refused.clone(), refused]
        );
        assert_eq!(*started.kernel.part.state().job(), job);
        started.tap(&MDI_PAGE);
        started.enter(&["T0101"]);
        started.kernel.run(3000);
        started.enter(&["G0", "X50", "Z-100"]);
        started.kernel.run(4000);
        let is_collision = |notice: &Notice| matches!(notice, Notice::Collided(_));
        assert!(started.notices().iter().any(is_collision));
        started.send(Command::FreeLathe, 1000);
        let report = started.hand_in();
        assert_eq!(report.points, 0, "{report:?}");
    }

    #[test]
    fn a_hidden_fault_is_not_shown_and_a_click_repairs_it() {
        let mut started = start("f10-drive-z");
        let snapshot = started.kernel.snapshot();
        assert_eq!(snapshot.forced.faults, 0);
        let is_faulty = |started: &Started| {
            started
                .kernel
                .emulator
                .lathe()
                .has_fault(LatheFault::DriveZ)
        };
        started.send(Command::FreeLathe, 10);
        assert!(is_faulty(&started), "the bench alone repairs it");
        started.tap(&[Key::EmergencyStop]);
        started.send(Command::Fault(LatheFault::DriveZ, true), 1000);
        assert!(!is_faulty(&started));
        let report = started.hand_in();
        assert_eq!(report.unmet(), ["works"]);
    }

    #[test]
    fn after_handing_in_the_machine_is_shown_at_any_moment_of_the_solution() {
        let mut started = start("04-spindle");
        let own = started.kernel.own_machine().clone();
        started.tap(&MDI_PAGE);
        started.enter(&["S600", "M3"]);
        started.kernel.run(4000);
        let turning = started.kernel.emulator.clone();
        let elapsed = turning.ticks() - started.task.create_start().expect("a start").ticks();
        started.enter(&["M5"]);
        started.kernel.run(5000);
        let show = || Command::Exercise(ExerciseAction::ShowMoment(elapsed));
        let _ = started.notices();
        started.send(show(), 10);
        let refused = Notice::Message(say::exercise_review_first());
        assert_eq!(started.notices(), [refused]);
        let report = started.hand_in();
        assert_eq!(report.unmet(), Vec::<&str>::new());
        let present = started.kernel.emulator.clone();
        started.send(show(), 10);
        let past = started.kernel.timeline.past_machine().expect("the past");
        assert!(*past == turning, "the machine at that moment");
        // A second moment, and nothing that changes the machine meanwhile.
        started.send(Command::Exercise(ExerciseAction::ShowMoment(0)), 10);
        started.send(Command::Tap(Key::Auto), 10);
        let tick = started.kernel.snapshot().past.expect("the past").tick;
        assert_eq!(turning.ticks() - tick, elapsed);
        assert!(started.kernel.emulator == present);
        started.send(Command::Lesson(LessonAction::Leave), 0);
        assert_eq!(started.kernel.snapshot().past, None);
        assert!(
            *started.kernel.own_machine() == own,
            "the own machine waited"
        );
    }

    #[test]
    fn a_learner_tries_again_from_a_moment_of_his_solution() {
        use crate::kernel::timeline::TimelineCommand;
        let mut started = start("04-spindle");
        started.tap(&MDI_PAGE);
        started.enter(&["S600", "M3"]);
        started.kernel.run(4000);
        started.hand_in();
        let begun_at = |started: &Started| {
            let state = started.kernel.snapshot().exercise.expect("an exercise");
            assert!(state.is_handed_in, "nothing counts any more");
            state.begun_at
        };
        let before = begun_at(&started);
        started.send(Command::Exercise(ExerciseAction::ShowMoment(500)), 10);
        started.send(Command::Timeline(TimelineCommand::ContinueFromHere), 100);
        assert_eq!(started.kernel.snapshot().past, None);
        started.tap(&[Key::Auto]);
        assert_eq!(begun_at(&started), before, "the same attempt");
    }

    #[test]
    fn the_end_of_the_time_hands_in() {
        let mut started = start("01-reference");
        started.kernel.run(started.task.time_limit_ms + 100);
        let is_solution = |notice: &Notice| matches!(notice, Notice::HandedIn(_));
        assert_eq!(
            started
                .notices()
                .iter()
                .filter(|it| is_solution(it))
                .count(),
            1
        );
    }
}
