use std::fs;
use std::path::Path;
use std::thread;
use std::time::Duration;

use gsk_core::machine::LatheFault;
use gsk_core::setup::Setup;
use gsk_exercise::judge::judge;
use gsk_exercise::library::built_in_tasks;
use gsk_exercise::report::ExerciseReport;
use gsk_history::recording::{RecordingEvent, RecordingReader};
use gsk_panel::emulator::Emulator;
use gsk_panel::keys::Key;
use gsk_tests::test_folder;

use super::*;
use crate::kernel::pace::RunSpeed;
use crate::kernel::{Console, LessonAction};
use crate::ports::dnc::DncSource;

/// A kernel that runs an exercise, for tests.
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
    let limit_s = started.task.time_limit_ms / 1000;
    assert!(
        state.is_handed_in && state.remaining_s < limit_s - 9,
        "{state:?}"
    );
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

/// The tick up to which a recording goes, 0 without one.
fn last_recorded_tick(bytes: &[u8]) -> u64 {
    let mut last = 0;
    let Ok(mut reader) = RecordingReader::new(bytes) else {
        return last;
    };
    while let Ok(Some(event)) = reader.next_event() {
        if let RecordingEvent::Reached(tick) | RecordingEvent::Hash { tick, .. } = event {
            last = tick;
        }
    }
    last
}

fn exam_task(task: &Arc<ExerciseTask>, file: &Path) -> Command {
    Command::Exercise(ExerciseAction::BeginExam(Box::new(ExamTask {
        task: Arc::clone(task),
        recording_file: file.to_owned(),
        recorded: fs::read(file).ok().map(Arc::from),
        is_paused: false,
    })))
}

#[test]
fn an_exam_continues_after_a_power_failure_where_it_was() {
    let folder = test_folder("exam-power-failure");
    let file = folder.join("1-04-spindle.gskrec");
    let mut started = start("04-spindle");
    let task = Arc::clone(&started.task);
    started.send(exam_task(&task, &file), 100);
    started.tap(&MDI_PAGE);
    started.enter(&["S600", "M3"]);
    started.kernel.run(4000);
    let tick = started.kernel.emulator.ticks();
    // The disk gets the last second when the next one is over, from another thread.
    started.kernel.run(2200);
    for _ in 0..3000 {
        if last_recorded_tick(&fs::read(&file).expect("a recording")) >= tick {
            break;
        }
        thread::sleep(Duration::from_millis(10));
    }
    // The process is gone; the last frame is cut off.
    let bytes = fs::read(&file).expect("a recording");
    fs::write(&file, &bytes[..bytes.len() - 3]).expect("written");
    drop(started);
    let mut continued = start("04-spindle");
    continued.send(exam_task(&task, &file), 0);
    let state = continued.kernel.snapshot().exercise.expect("an exercise");
    assert!(state.is_exam && !state.is_handed_in, "{state:?}");
    let now = continued.kernel.emulator.ticks();
    assert!(
        now.abs_diff(tick) <= 11_000 && now > 4000,
        "{now} of {tick}"
    );
    assert!(
        continued.kernel.emulator.lathe().spindle_rpm() > 500.0,
        "it turns"
    );
    continued.enter(&["M5"]);
    continued.kernel.run(5000);
    let report = continued.hand_in();
    assert_eq!(report.unmet(), Vec::<&str>::new());
    let handed_in = fs::read(&file).expect("a recording");
    assert_eq!(judge(&task, &handed_in).as_ref(), Ok(&report));
}

#[test]
fn an_exam_stands_still_while_it_is_paused_and_is_left_only_by_its_own_command() {
    let folder = test_folder("exam-pause");
    let mut started = start("04-spindle");
    let task = Arc::clone(&started.task);
    started.send(exam_task(&task, &folder.join("a.gskrec")), 100);
    let _ = started.notices();
    started.send(Command::Exercise(ExerciseAction::PauseExam(true)), 100);
    let paused = started.kernel.emulator.clone();
    started.send(Command::Tap(Key::Auto), 5000);
    assert!(started.kernel.emulator == paused);
    assert_eq!(started.notices(), [Notice::Message(say::exam_paused())]);
    started.send(Command::Exercise(ExerciseAction::PauseExam(false)), 100);
    assert!(started.kernel.emulator.ticks() > paused.ticks());
    let refused = [
        Command::Lesson(LessonAction::Leave),
        Command::Exercise(ExerciseAction::Begin(Arc::clone(&task))),
    ];
    for command in refused {
        started.send(command, 10);
        assert_eq!(started.notices(), [Notice::Message(say::exam_no_help())]);
    }
    started.hand_in();
    started.send(Command::Exercise(ExerciseAction::ShowMoment(0)), 10);
    assert_eq!(started.kernel.snapshot().past, None);
    started.send(Command::Exercise(ExerciseAction::LeaveExam), 10);
    assert_eq!(started.kernel.snapshot().exercise, None);
}

#[test]
fn an_exam_has_the_speed_of_the_machine() {
    let folder = test_folder("exam-speed");
    let mut started = start("04-spindle");
    let task = Arc::clone(&started.task);
    started.send(Command::Speed(RunSpeed::Fastest), 10);
    let speed_of_dwell = |started: &mut Started| {
        started.tap(&MDI_PAGE);
        started.enter(&["G4", "X9"]);
        started.kernel.run(1000);
        started.kernel.speed()
    };
    assert_eq!(speed_of_dwell(&mut started), RunSpeed::Fastest);
    started.send(exam_task(&task, &folder.join("a.gskrec")), 100);
    assert_eq!(speed_of_dwell(&mut started), RunSpeed::REAL);
}

#[test]
fn a_recording_that_no_operator_made_does_not_continue() {
    let folder = test_folder("exam-foreign");
    let file = folder.join("a.gskrec");
    let mut other = start("05-tool-change");
    let task = Arc::clone(&other.task);
    other.send(exam_task(&task, &file), 100);
    other.hand_in();
    let mut started = start("04-spindle");
    let task = Arc::clone(&started.task);
    let _ = started.notices();
    started.send(exam_task(&task, &file), 10);
    let refused = Notice::Message(say::exercise_foreign_state());
    assert_eq!(started.notices(), [refused]);
    assert_eq!(started.kernel.snapshot().exercise, None);
}
