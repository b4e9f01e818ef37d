//! What stops the axes in the board: lease, limit, guard, overrun. The counts remain true.

mod support;

use gsk_motion::messages::{Command, Response};
use support::{ENABLE, ENABLE_PIN, GROUP, GUARD_PIN, INDEX_PIN, LIMIT, LIMIT_PIN, TestBoard, X, Z};

/// 50 µs, ticks.
const STOP_TICKS: u64 = 781;

/// A board whose two axes make 20 000 steps per second each, Z twice the way of X.
fn moving_board() -> TestBoard {
    let mut board = TestBoard::default();
    board.configure(4096);
    board.begin();
    for (axis, interval, count) in [(Z, 781, 60_000), (X, 1562, 30_000)] {
        board.send(Command::SetNextStepDir, &[axis.into(), 1]);
        let from = board.port.now as i64 + 1000;
        board.send(Command::ResetStepClock, &[axis.into(), from]);
        board.send(Command::QueueStep, &[axis.into(), interval, count, 0]);
    }
    let at = board.port.now as i64 + 1000;
    board.send(Command::QueueDigitalOut, &[ENABLE.into(), at, 1]);
    board.run(500_000);
    assert!(board.port.sum(0) > 500, "{:?}", board.shutdown_text());
    board
}

fn assert_counts_are_true(board: &TestBoard) {
    for axis in 0..2 {
        assert_eq!(board.engine.position(axis), board.port.sum(axis));
    }
}

#[test]
fn the_lease_expires_and_both_axes_stop_on_their_path() {
    let mut board = moving_board();
    let from = board.port.now;
    board.renewed = None;
    board.run(5_000_000);
    assert_eq!(board.shutdown_text(), Some("Lease expired"));
    assert!(board.has(Response::LeaseExpired));
    assert_counts_are_true(&board);
    assert_eq!(board.port.outputs.last(), Some(&(ENABLE_PIN, 0)));
    let last = board.port.steps.last().unwrap().at;
    // 100 ms of the lease, less than 67 ms of the planned stop.
    let stopped_after = (last - from) as f64 / 15_625.0;
    assert!(
        (100.0..167.5).contains(&stopped_after),
        "{stopped_after} ms"
    );
    // On the path: Z makes two steps for one of X, also while it slows down.
    let (mut z, mut x) = (0_i32, 0_i32);
    for step in &board.port.steps {
        if step.axis == 0 {
            z += 1
        } else {
            x += 1
        }
        assert!((z - 2 * x).abs() <= 3, "{z} {x}");
    }
    // The intervals grow: no step of the stop is faster than before it.
    let times: Vec<u64> = board
        .port
        .steps
        .iter()
        .filter(|step| step.axis == 0)
        .map(|step| step.at)
        .collect();
    assert!(
        times
            .windows(2)
            .all(|pair| pair[1] - pair[0] >= 781 - 2 * support::POLL_TICKS)
    );
    assert!(
        times
            .windows(2)
            .last()
            .is_some_and(|pair| pair[1] - pair[0] > 10 * 781)
    );
}

#[test]
fn a_renewed_lease_does_not_stop() {
    let mut board = moving_board();
    board.run(10_000_000);
    assert_eq!(board.shutdown_text(), None);
    let expected = (board.port.now - 1000) / 781;
    assert!(board.port.sum(0).abs_diff(expected as i32) <= 1);
}

#[test]
fn a_guard_stops_within_50_us() {
    let mut board = moving_board();
    board.port.levels |= 1 << GUARD_PIN;
    let from = board.port.now;
    board.run(100_000);
    assert_eq!(board.shutdown_text(), Some("Guard input tripped"));
    assert!(board.port.steps.last().unwrap().at <= from + STOP_TICKS);
    assert_counts_are_true(&board);
    assert_eq!(board.port.outputs.last(), Some(&(ENABLE_PIN, 0)));
}

#[test]
fn a_pulse_shorter_than_the_guard_time_does_not_stop() {
    let mut board = moving_board();
    board.port.levels |= 1 << GUARD_PIN;
    board.run(80);
    board.port.levels &= !(1 << GUARD_PIN);
    board.run(100_000);
    assert_eq!(board.shutdown_text(), None);
}

/// Arms the stop group on the limit switch as the link does: four samples, 15 µs apart.
fn arm_group(board: &mut TestBoard) {
    let now = board.port.now as i64;
    board.send(Command::TrsyncStart, &[GROUP.into(), now + 100, 0, 4]);
    for axis in [Z, X] {
        board.send(Command::StepperStopOnTrigger, &[axis.into(), GROUP.into()]);
    }
    let home = [LIMIT.into(), now + 100, 234, 4, 15_625, 1, GROUP.into(), 1];
    board.send(Command::EndstopHome, &home);
    board.send(Command::TrsyncSetTimeout, &[GROUP.into(), now + 9_000_000]);
}

#[test]
fn a_limit_stops_both_axes_within_50_us_and_later_entries_are_dropped() {
    let mut board = moving_board();
    arm_group(&mut board);
    board.run(10_000);
    board.port.levels |= 1 << LIMIT_PIN;
    let from = board.port.now;
    board.run(100_000);
    assert!(board.port.steps.last().unwrap().at <= from + STOP_TICKS);
    let state = board
        .events
        .iter()
        .rfind(|event| event.response == Response::TrsyncState);
    assert_eq!(
        state.map(|event| event.values()[..3].to_vec()),
        Some(vec![i64::from(GROUP), 0, 1])
    );
    assert_counts_are_true(&board);
    assert_eq!(board.shutdown_text(), None);
    // Entries on the way when the group triggered: without effect, also those of a thread.
    let steps = board.port.steps.len();
    board.send(Command::QueueStep, &[Z.into(), 781, 100, 0]);
    board.send(
        Command::BeginAngle,
        &[X.into(), board.port.now as i64, 0, 2, 1, 0],
    );
    board.send(Command::QueueAngle, &[X.into(), 100, 2, 0]);
    board.send(Command::EndAngle, &[X.into()]);
    board.run(200_000);
    assert_eq!(
        (board.port.steps.len(), board.shutdown_text()),
        (steps, None)
    );
}

#[test]
fn an_armed_group_that_is_not_renewed_stops() {
    let mut board = moving_board();
    arm_group(&mut board);
    board.run(12_000_000);
    let state = board
        .events
        .iter()
        .rfind(|event| event.response == Response::TrsyncState);
    assert_eq!(state.map(|event| event.values()[2]), Some(4));
    assert_counts_are_true(&board);
}

#[test]
fn no_motion_before_the_configuration_and_its_hash() {
    let mut board = TestBoard::default();
    board.configure(4096);
    board.send(Command::ResetStepClock, &[Z.into(), 0]);
    board.send(Command::QueueStep, &[Z.into(), 1000, 10, 0]);
    assert_eq!(
        board.shutdown_text(),
        Some("Motion without lease or armed trsync")
    );

    let mut board = TestBoard::default();
    board.configure(4096);
    board.send(
        Command::RenewLease,
        &[i64::from(support::CRC) + 1, 1_000_000],
    );
    assert_eq!(
        board.shutdown_text(),
        Some("Lease for another configuration")
    );

    let mut board = TestBoard::default();
    board.send(Command::AllocateOids, &[2]);
    board.send(Command::ConfigStepper, &[0, 2, 3, 0, 31]);
    board.send(Command::ResetStepClock, &[0, 0]);
    board.send(Command::QueueStep, &[0, 1000, 10, 0]);
    assert_eq!(
        board.shutdown_text(),
        Some("Motion before the configuration is final")
    );
    board.run(100_000);
    assert_eq!(board.port.steps, []);
}

#[test]
fn an_output_that_is_not_renewed_shuts_down() {
    let mut board = TestBoard::default();
    board.send(Command::AllocateOids, &[1]);
    board.send(Command::ConfigDigitalOut, &[0, 14, 0, 0, 100_000]);
    board.send(Command::FinalizeConfig, &[1]);
    board.send(Command::QueueDigitalOut, &[0, 1000, 1]);
    board.run(50_000);
    assert_eq!(board.port.outputs.last(), Some(&(14, 1)));
    board.run(100_000);
    assert_eq!(
        board.shutdown_text(),
        Some("Missed scheduling of next digital out event")
    );
    assert_eq!(board.port.outputs.last(), Some(&(14, 0)));
}

#[test]
fn positions_are_reported_after_a_shutdown() {
    let mut board = moving_board();
    board.send(Command::EmergencyStop, &[]);
    board.send(Command::StepperGetPosition, &[Z.into()]);
    let state = board
        .events
        .iter()
        .rfind(|event| event.response == Response::StepperPosition);
    let made = i64::from(board.port.sum(0));
    assert_eq!(
        state.map(|event| event.values().to_vec()),
        Some(vec![0, made])
    );
    board.send(Command::QueueStep, &[Z.into(), 781, 100, 0]);
    assert!(board.has(Response::IsShutdown));
}

/// A board with a thread of one step for two counts on Z that follows the spindle.
fn threading_board(length: i64) -> TestBoard {
    let mut board = TestBoard::default();
    board.configure(4096);
    board.begin();
    let now = board.port.now as i64;
    board.send(Command::BeginAngle, &[Z.into(), now, 0, 2, 1, 0]);
    board.send(Command::QueueAngle, &[Z.into(), length, 1, 0]);
    board.send(Command::EndAngle, &[Z.into()]);
    turn(&mut board, 8192 + 1000);
    assert_eq!(board.engine.position(0), 500);
    board
}

/// Turns the spindle by a number of counts, at one count per two polls.
fn turn(board: &mut TestBoard, counts: i32) {
    for _ in 0..counts.abs() {
        board.port.counts[0] += counts.signum();
        board.run(2 * support::POLL_TICKS);
    }
}

#[test]
fn a_thread_follows_a_spindle_that_turns_back() {
    let mut board = threading_board(8192);
    turn(&mut board, -800);
    assert!(board.engine.position(0).abs_diff(100) <= 1);
    turn(&mut board, -700);
    assert!(board.engine.position(0).abs() <= 1);
    turn(&mut board, 500 + 8192 + 100);
    assert_eq!((board.engine.position(0), board.port.sum(0)), (4096, 4096));
    let state = board
        .events
        .iter()
        .rfind(|event| event.response == Response::AngleState);
    assert_eq!(state.map(|event| event.values()[1]), Some(0));
    assert_eq!(board.shutdown_text(), None);
}

#[test]
fn a_spindle_that_trembles_does_not_move_the_axis() {
    let mut board = threading_board(8192);
    let steps = board.port.steps.len();
    for _ in 0..1000 {
        turn(&mut board, 1);
        turn(&mut board, -1);
    }
    assert!(board.port.steps.len() - steps <= 1);
}

#[test]
fn a_guard_in_a_thread_stops_and_the_count_is_true() {
    let mut board = threading_board(8192);
    board.port.levels |= 1 << GUARD_PIN;
    turn(&mut board, 1000);
    assert_eq!(board.shutdown_text(), Some("Guard input tripped"));
    assert!(board.port.sum(0) < 510);
    assert_counts_are_true(&board);
}

#[test]
fn the_lease_expires_in_a_thread_and_the_axis_slows_down() {
    let mut board = threading_board(100_000);
    board.renewed = None;
    while board.shutdown_text().is_none() && board.port.counts[0] < 90_000 {
        turn(&mut board, 1);
    }
    assert_eq!(board.shutdown_text(), Some("Lease expired"));
    // One step for two counts before, ever fewer during the stop.
    let counts: Vec<i32> = board.port.steps.iter().map(|step| step.count).collect();
    let gaps: Vec<i32> = counts.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert!(gaps.iter().all(|gap| *gap >= 2) && gaps.last().is_some_and(|gap| *gap > 10));
    assert_counts_are_true(&board);
}

#[test]
fn an_index_at_another_count_is_an_alarm() {
    let pulse = |board: &mut TestBoard| {
        board.port.levels |= 1 << INDEX_PIN;
        turn(board, 4);
        board.port.levels &= !(1 << INDEX_PIN);
    };
    let mut board = threading_board(100_000);
    board.port.index_turn = 0;
    turn(&mut board, 3096);
    pulse(&mut board);
    turn(&mut board, 4092);
    pulse(&mut board);
    assert_eq!(board.shutdown_text(), None);
    // The encoder loses 50 counts in a turn.
    turn(&mut board, 4042);
    pulse(&mut board);
    assert_eq!(
        board.shutdown_text(),
        Some("Spindle index at another count")
    );
}

#[test]
fn an_axis_that_cannot_follow_and_a_queue_that_runs_empty_are_alarms() {
    let mut board = TestBoard::default();
    board.configure(4096);
    board.begin();
    let now = board.port.now as i64;
    board.send(Command::BeginAngle, &[Z.into(), now, 0, 1, 0, 0]);
    board.send(Command::QueueAngle, &[Z.into(), 4096, 5, 0]);
    turn(&mut board, 8300);
    assert_eq!(
        board.shutdown_text(),
        Some("Axis cannot follow the spindle")
    );
    assert_counts_are_true(&board);

    let mut board = TestBoard::default();
    board.configure(4096);
    board.begin();
    board.send(Command::BeginAngle, &[Z.into(), 0, 0, 2, 0, 0]);
    board.send(Command::QueueAngle, &[Z.into(), 100, 1, 0]);
    turn(&mut board, 8400);
    assert_eq!(board.shutdown_text(), Some("Angle queue empty"));
}

#[test]
fn a_following_error_is_an_alarm() {
    let mut board = TestBoard::default();
    board.send(Command::AllocateOids, &[3]);
    board.send(Command::ConfigStepper, &[0, 2, 3, 0, 31]);
    // 4 counts in 10 steps, 20 steps of error.
    board.send(Command::ConfigAxisEncoder, &[1, 8, 0, 4, 10, 20]);
    board.send(Command::FinalizeConfig, &[support::CRC.into()]);
    board.renew();
    board.send(Command::SetNextStepDir, &[0, 1]);
    board.send(Command::ResetStepClock, &[0, 1000]);
    board.send(Command::QueueStep, &[0, 781, 1000, 0]);
    for _ in 0..5000 {
        board.port.counts[1] = board.port.sum(0) * 4 / 10;
        board.run(40);
    }
    assert_eq!(board.shutdown_text(), None);
    let stuck = board.port.sum(0);
    board.run(100_000);
    assert_eq!(board.shutdown_text(), Some("Following error too large"));
    assert!((board.port.sum(0) - stuck - 20).abs() <= 4);
}
