use std::fs;
use std::time::{Duration, Instant};

use gsk_core::cnc::ControlRequest;
use gsk_core::machine::LatheFault;
use gsk_core::operation::{OperatingMode, RunState};
use gsk_core::setup::Setup;
use gsk_history::replay::replay;
use gsk_lesson::built_in_lessons;
use gsk_messages::Message;
use gsk_tests::test_folder;
use gsk_workpiece::job::Job;
use gsk_workpiece::part::TurnedPart;
use gsk_workpiece::stock::Stock;
use gsk_workpiece::tool::Tool;

use super::*;
use crate::kernel::{Console, LessonAction};

const PROGRAM: &str = "O0001;\nG50 X60 Z20;\nT0101 M03 S800;\nG00 X52 Z2;\nG90 X46 Z-20 F200;\n\
     X42;\nX38 Z-12;\nG00 X60 Z20;\nM30;\n";

fn selected_job() -> SelectedJob {
    let mut job = Job::new(Stock::bar(50.0, 0.0, 60.0));
    job.tools.insert(1, Tool::turning());
    SelectedJob {
        job,
        file: Some("bar.job.ron".into()),
    }
}

/// A kernel that has cut the program for some seconds.
fn cutting_kernel() -> (Kernel, Console) {
    let (mut kernel, console) = Kernel::new(Emulator::new(Setup::default()));
    kernel.run(4000);
    console.send(Command::Job(Some(Box::new(selected_job()))));
    console.send(Command::Timeline(TimelineCommand::Publish(true)));
    let store = ControlRequest::StoreProgram(PROGRAM.to_owned());
    console.send(Command::Request(Box::new(store)));
    for key in [Key::Auto, Key::CycleStart] {
        console.send(Command::Tap(key));
        kernel.run(500);
    }
    kernel.run(15_000);
    kernel.publish();
    (kernel, console)
}

fn send(kernel: &mut Kernel, console: &Console, command: TimelineCommand) {
    console.send(Command::Timeline(command));
    kernel.run(0);
}

/// Shows the machine at a tick and waits until its part is computed.
fn look_at(kernel: &mut Kernel, console: &Console, tick: u64) {
    send(kernel, console, TimelineCommand::LookAt(tick));
    while (kernel.snapshot().past).is_some_and(|past| past.is_part_pending) {
        kernel.run(1);
    }
}

fn messages(console: &Console) -> Vec<Message> {
    let notices = console.notices.try_iter();
    notices
        .filter_map(|notice| match notice {
            Notice::Message(message) => Some(message),
            _ => None,
        })
        .collect()
}

fn cut_part(kernel: &Kernel) -> TurnedPart {
    let machining = kernel.part.state().machining().expect("a job");
    machining.scene().part().clone()
}

#[test]
fn ten_seconds_back_and_the_same_inputs_lead_to_the_same_end() {
    let (mut kernel, console) = cutting_kernel();
    let end = kernel.emulator.ticks();
    console.send(Command::Turn(3));
    kernel.run(2000);
    let (machine, part) = (kernel.emulator.clone(), cut_part(&kernel));
    look_at(&mut kernel, &console, end - 10_000);
    let shown = kernel.snapshot();
    assert_eq!(
        shown.past.map(|past| (past.tick, past.age_ms)),
        Some((end - 10_000, 12_000))
    );
    send(&mut kernel, &console, TimelineCommand::ContinueFromHere);
    assert_eq!(kernel.emulator.ticks(), end - 10_000);
    assert!(messages(&console).contains(&say::timeline_continued()));
    // No key was down, so that their release changes nothing.
    kernel.run(10_000);
    console.send(Command::Turn(3));
    kernel.run(2000);
    assert!(kernel.emulator == machine);
    assert!(cut_part(&kernel) == part);
}

#[test]
fn the_keeper_saves_the_present_and_the_past_stands_still() {
    let (mut kernel, console) = cutting_kernel();
    let before = kernel.emulator.clone();
    let position = kernel.snapshot().screen;
    look_at(&mut kernel, &console, before.ticks() - 12_000);
    assert_ne!(kernel.snapshot().screen, position);
    for command in [
        Command::Tap(Key::Reset),
        Command::Turn(5),
        Command::Fault(LatheFault::DoorOpen, true),
        Command::PowerCycle,
        Command::FreshStock,
    ] {
        console.send(command);
        kernel.run(1000);
    }
    let refusals = messages(&console);
    assert_eq!(refusals.len(), 5);
    assert!(
        refusals
            .iter()
            .all(|it| *it == say::timeline_past_is_shown())
    );
    assert!(*kernel.own_machine() == before);
    send(&mut kernel, &console, TimelineCommand::ReturnToPresent);
    assert_eq!(kernel.snapshot().screen, position);
    assert!(kernel.emulator == before);
    kernel.run(1);
    assert_eq!(kernel.emulator.ticks(), before.ticks() + 1);
}

#[test]
fn the_other_future_is_kept_and_returns_with_its_marks_and_alarms() {
    let (mut kernel, console) = cutting_kernel();
    let early = kernel.emulator.ticks() - 10_000;
    console.send(Command::Key {
        key: Key::EmergencyStop,
        down: true,
    });
    kernel.run(1000);
    kernel.publish();
    let end = kernel.emulator.clone();
    let part = cut_part(&kernel);
    let alarms = |kernel: &Kernel| kernel.alarm_history.records().len();
    assert_eq!(alarms(&kernel), 1);
    let marks = |console: &Console| console.timeline.pop().expect("a time line").marks.clone();
    let alarm_marks = |marks: &[TimelineMark]| {
        let alarms = marks.iter();
        alarms
            .filter(|mark| matches!(mark.kind, TimelineMarkKind::Alarm(_)))
            .count()
    };
    assert_eq!(alarm_marks(&marks(&console)), 1);
    look_at(&mut kernel, &console, early);
    send(&mut kernel, &console, TimelineCommand::ContinueFromHere);
    kernel.run(5000);
    kernel.publish();
    assert_eq!(alarms(&kernel), 0);
    let view = console.timeline.pop().expect("a time line");
    assert_eq!(alarm_marks(&view.marks), 0);
    assert!(
        view.marks
            .iter()
            .any(|it| it.kind == TimelineMarkKind::Key(Key::CycleStart))
    );
    assert!(
        view.marks
            .iter()
            .any(|it| it.kind == TimelineMarkKind::Block)
    );
    assert_eq!(view.branch, Some((early, end.ticks())));
    send(&mut kernel, &console, TimelineCommand::ReturnToBranch);
    kernel.publish();
    assert_eq!((alarms(&kernel), alarm_marks(&marks(&console))), (1, 1));
    assert_eq!(kernel.emulator.ticks(), end.ticks());
    assert_eq!(kernel.emulator.cnc().alarms(), end.cnc().alarms());
    assert!(cut_part(&kernel) == part);
}

#[test]
fn a_lesson_and_real_slides_do_not_continue_from_the_past() {
    let (mut kernel, console) = cutting_kernel();
    let tick = kernel.emulator.ticks();
    console.send(Command::Tap(Key::Reset));
    kernel.run(500);
    messages(&console);
    let lesson = built_in_lessons().into_iter().next().expect("a lesson");
    kernel.execute_lesson_command(LessonAction::Begin(lesson.into()));
    send(&mut kernel, &console, TimelineCommand::LookAt(tick - 5000));
    assert!(kernel.snapshot().past.is_none());
    assert_eq!(messages(&console), [say::timeline_not_in_lesson()]);
    kernel.leave_lesson();

    // A board is connected: the past remains visible, and the present runs.
    kernel.has_real_slides = true;
    kernel.run(5000);
    let shown = |kernel: &Kernel| kernel.snapshot().past.map(|past| past.tick);
    let linked = kernel.emulator.ticks();
    send(
        &mut kernel,
        &console,
        TimelineCommand::LookAt(linked - 1500),
    );
    let state = shown(&kernel).expect("a past moment");
    assert!((linked - 2500..=linked - 1500).contains(&state), "{state}");
    send(&mut kernel, &console, TimelineCommand::ContinueFromHere);
    assert_eq!(messages(&console), [say::timeline_not_with_board()]);
    kernel.run(100);
    assert_eq!(kernel.emulator.ticks(), linked + 100);
    // Other keys do nothing; one that stops acts on the present.
    console.send(Command::Tap(Key::Mdi));
    kernel.run(300);
    assert!(shown(&kernel).is_some());
    assert_eq!(kernel.emulator.cnc().mode(), OperatingMode::Auto);
    console.send(Command::Tap(Key::Reset));
    kernel.run(300);
    assert_eq!(shown(&kernel), None);
}

#[test]
fn the_job_of_the_window_does_not_replace_the_restored_part() {
    let (mut kernel, console) = cutting_kernel();
    let part = cut_part(&kernel);
    let tick = kernel.emulator.ticks();
    kernel.run(5000);
    console.send(Command::Tap(Key::Reset));
    kernel.run(300);
    let other = ControlRequest::StoreProgram("O0002;\nM30;\n".to_owned());
    console.send(Command::Request(Box::new(other)));
    console.send(Command::Job(None));
    kernel.run(300);
    look_at(&mut kernel, &console, tick);
    send(&mut kernel, &console, TimelineCommand::ContinueFromHere);
    // The window finds the job of the program that is selected again.
    console.send(Command::Job(Some(Box::new(selected_job()))));
    kernel.run(0);
    assert!(cut_part(&kernel) == part);
    console.send(Command::Job(Some(Box::new(selected_job()))));
    kernel.run(0);
    assert!(cut_part(&kernel) != part, "a second job is another stock");
}

#[test]
fn the_saved_minutes_replay_without_a_difference() {
    let (mut kernel, console) = cutting_kernel();
    let folder = test_folder("timeline-save");
    fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("last.gskrec");
    kernel.run(70_000);
    let save = TimelineCommand::Save {
        minutes: Some(1),
        path: path.clone(),
    };
    send(&mut kernel, &console, save);
    let limit = Instant::now() + Duration::from_secs(60);
    let mut received = Vec::new();
    while received.is_empty() && Instant::now() < limit {
        std::thread::sleep(Duration::from_millis(20));
        received = messages(&console);
    }
    assert_eq!(received, [say::timeline_saved(path.display())]);
    let replayed = replay(&fs::read(&path).expect("a file")).expect("a recording");
    assert_eq!((replayed.error, replayed.difference), (None, None));
    assert!(replayed.is_complete && replayed.equal_hashes >= 5);
    let ticks = replayed.replayed_ticks;
    assert!((60_000..71_000).contains(&ticks), "{ticks} ticks");
}

#[test]
fn the_program_follows_the_handwheel_forwards_and_back() {
    let (mut kernel, console) = cutting_kernel();
    send(&mut kernel, &console, TimelineCommand::RunByHandwheel(true));
    kernel.run(1000);
    let start = kernel.emulator.ticks();
    kernel.run(1000);
    assert_eq!(kernel.emulator.ticks(), start, "the program waits");
    assert!(kernel.emulator.cnc().is_moving(), "in the middle of a cut");
    console.send(Command::Turn(20));
    kernel.run(1000);
    assert_eq!(kernel.emulator.ticks(), start + 400);
    let position = kernel.snapshot().screen;
    console.send(Command::Turn(-100));
    kernel.run(10);
    let past = kernel.snapshot().past.expect("the past");
    assert_eq!(past.tick, start - 1600);
    assert_ne!(kernel.snapshot().screen, position);
    console.send(Command::Turn(150));
    kernel.run(1);
    assert_eq!(kernel.snapshot().past, None);
    assert_eq!(kernel.snapshot().screen, position);
    kernel.run(1000);
    assert_eq!(kernel.emulator.ticks(), start + 400);
    // Feed hold acts, and afterwards the clock runs as usual.
    console.send(Command::Tap(Key::FeedHold));
    kernel.run(1000);
    assert!(!kernel.emulator.cnc().is_moving());
    assert!(kernel.emulator.ticks() > start + 1000);
}

#[test]
fn in_feed_hold_the_wheel_goes_back_from_the_last_motion() {
    let (mut kernel, console) = cutting_kernel();
    console.send(Command::Tap(Key::FeedHold));
    kernel.run(1000);
    assert_eq!(kernel.emulator.cnc().run_state(), RunState::Hold);
    let held = kernel.snapshot().screen;
    kernel.run(20_000);
    let end = kernel.emulator.ticks();
    send(&mut kernel, &console, TimelineCommand::RunByHandwheel(true));
    console.send(Command::Turn(-25));
    kernel.run(5);
    let past = kernel.snapshot().past.expect("the past");
    let back = end - past.tick;
    assert!((20_500..21_600).contains(&back), "{back} ticks back");
    assert_ne!(kernel.snapshot().screen, held, "the slides were elsewhere");
    // Forwards the wheel passes over the time of the hold, too.
    console.send(Command::Turn(25));
    kernel.run(1);
    assert_eq!(kernel.snapshot().past, None);
}

#[test]
fn with_real_slides_the_switch_of_the_handwheel_run_retraces_the_path() {
    let (mut kernel, console) = cutting_kernel();
    kernel.has_real_slides = true;
    console.send(Command::Tap(Key::FeedHold));
    kernel.run(1000);
    send(&mut kernel, &console, TimelineCommand::RunByHandwheel(true));
    assert!(kernel.emulator.cnc().has_retrace());
    // A turn is for the slides: the window keeps showing the present.
    console.send(Command::Turn(-5));
    kernel.run(5);
    assert_eq!(kernel.snapshot().past, None);
    send(
        &mut kernel,
        &console,
        TimelineCommand::RunByHandwheel(false),
    );
    assert!(!kernel.emulator.cnc().has_retrace());
}

#[test]
fn a_run_by_handwheel_equals_a_run_by_the_clock() {
    let (mut by_clock, _) = cutting_kernel();
    let (mut by_wheel, console) = cutting_kernel();
    send(
        &mut by_wheel,
        &console,
        TimelineCommand::RunByHandwheel(true),
    );
    by_wheel.run(200);
    for turn in 1..=40 {
        console.send(Command::Turn(30 + turn));
        by_wheel.run(300);
        console.send(Command::Turn(-turn));
        by_wheel.run(30);
        console.send(Command::Turn(2 * turn));
        by_wheel.run(5);
    }
    let ticks = by_wheel.emulator.ticks() - by_clock.emulator.ticks();
    assert!(ticks > 6000, "{ticks}");
    by_clock.run(ticks);
    assert!(by_clock.emulator == by_wheel.emulator);
    assert!(cut_part(&by_clock) == cut_part(&by_wheel));
}

#[test]
fn a_program_that_waits_for_the_handwheel_is_held_when_the_run_ends() {
    let (mut kernel, console) = cutting_kernel();
    send(&mut kernel, &console, TimelineCommand::RunByHandwheel(true));
    kernel.run(500);
    assert_eq!(kernel.emulator.cnc().run_state(), RunState::Run);
    send(
        &mut kernel,
        &console,
        TimelineCommand::RunByHandwheel(false),
    );
    kernel.run(500);
    assert_eq!(kernel.emulator.cnc().run_state(), RunState::Hold);
}
