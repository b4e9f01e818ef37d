//! Feed hold, single block, reset and the spindle override in threads.

use gsk_core::machine::LatheFault;
use gsk_core::operation::RunState;

use super::run::{CYCLE_START, FEED_HOLD, G32, RESET, SINGLE_BLOCK, SPINDLE_FASTER, ThreadRun};
use crate::bench::press;

#[test]
fn feed_hold_waits_for_the_first_block_after_a_thread() {
    let mut run = ThreadRun::started(G32, &[]);
    run.run_until_z(-5.0);
    run.press(FEED_HOLD);
    assert_eq!(run.state(), RunState::Hold, "SPL stands at once");
    run.run_ticks(15_000);
    assert_eq!(run.state(), RunState::Hold, "the hold stands");
    assert!(!run.simulation.cnc.is_moving());
    let at = run.simulation.cnc.position_absolute();
    assert_eq!((at.diameter().0, at.z), (60.0, -30.0));
    assert_eq!(run.line(), 7);
    run.press(CYCLE_START);
    run.finish();
    assert_eq!(run.z(), 5.0);
}

#[test]
fn hold_that_is_still_pressed_stops_in_the_block_after_a_thread() {
    let mut run = ThreadRun::started(&G32.replace("G00 X60", "G01 X160 F300"), &[]);
    run.run_until_z(-5.0);
    run.simulation.cnc.set_panel_key(FEED_HOLD, true);
    run.run_ticks(6000);
    run.simulation.cnc.set_panel_key(FEED_HOLD, false);
    assert_eq!((run.state(), run.line()), (RunState::Hold, 7));
    let at = run.simulation.cnc.position_absolute();
    assert!(at.z == -30.0 && at.x < 60.0 && !run.simulation.cnc.is_moving());
    run.press(CYCLE_START);
    run.finish();
    assert_eq!((run.z(), run.alarm()), (5.0, None));
}

#[test]
fn feed_hold_lets_a_thread_cycle_retract() {
    let text = "O0001\nM03 S500\nG04 X1\nG00 X40 Z5\nG92 X36 Z-20 F2\nX35\nM30\n";
    let mut run = ThreadRun::started(text, &[]);
    run.run_until_z(-5.0);
    run.press(FEED_HOLD);
    assert_eq!(run.state(), RunState::Hold);
    run.run_ticks(15_000);
    assert_eq!(run.state(), RunState::Hold, "the hold stands");
    assert!(!run.simulation.cnc.is_moving());
    let at = run.simulation.cnc.position_absolute();
    assert_eq!((at.diameter().0, at.z), (40.0, -20.0), "after the retract");
    run.press(CYCLE_START);
    run.finish();
    assert_eq!((run.z(), run.alarm()), (5.0, None));
}

#[test]
fn single_block_stops_after_the_first_block_without_a_thread() {
    let mut run = ThreadRun::new(G32, &[]);
    press(&mut run.simulation, SINGLE_BLOCK);
    run.start();
    let mut stops = Vec::new();
    while run.state() != RunState::Reset {
        run.finish();
        stops.push(run.line());
        run.press(CYCLE_START);
    }
    stops.dedup();
    assert_eq!(stops[..4], [2, 3, 4, 7]);
}

#[test]
fn reset_stops_a_thread_at_once() {
    let mut run = ThreadRun::started(G32, &[]);
    run.run_until_z(-5.0);
    run.press(RESET);
    run.run_ticks(500);
    assert_eq!(run.state(), RunState::Reset);
    assert!(
        !run.simulation.cnc.is_moving() && run.z() > -12.0,
        "{}",
        run.z()
    );
}

#[test]
fn a_change_of_the_spindle_override_waits_for_the_end_of_the_thread() {
    let mut run = ThreadRun::started(G32, &[]);
    run.run_until_z(0.0);
    run.press(SPINDLE_FASTER);
    run.run_ticks(300);
    assert!(run.z() > -18.0);
    assert!((run.simulation.cnc.spindle_commanded() - 500.0).abs() < 1e-9);
    let chosen = f64::from(run.simulation.cnc.spindle_override()) / 100.0;
    assert!(chosen > 1.0, "the key acts");
    run.run_until("out", |simulation| {
        simulation.cnc.position_absolute().x > 25.0
    });
    assert!((run.simulation.cnc.spindle_commanded() - 500.0 * chosen).abs() < 1e-9);
}

#[test]
fn emergency_stop_and_a_drive_alarm_stop_a_thread_at_once() {
    for drive in [false, true] {
        for text in [G32, &G32.replace("G32", "G33")] {
            let mut run = ThreadRun::started(text, &[]);
            run.run_until_z(-5.0);
            if drive {
                run.simulation.lathe.set_fault(LatheFault::DriveZ, true);
            } else {
                run.simulation.lathe.set_emergency_button(true);
            }
            run.run_ticks(16);
            let at = run.z();
            run.run_ticks(500);
            assert_eq!(run.z(), at, "no way to brake");
            assert!(at > -5.4, "{at}");
            assert_ne!(run.state(), RunState::Run);
            assert_eq!(run.alarm(), Some(if drive { 222 } else { 207 }));
        }
    }
}

#[test]
fn feed_hold_before_the_one_turn_signal_does_not_keep_a_thread_from_beginning() {
    // At 20 r/min the signal is up to three seconds away.
    let text = "O0001\nM03 S20\nG04 X1\nG00 X40 Z5\nG32 Z3 F2\nG00 X60\nZ5\nM30\n";
    let mut run = ThreadRun::started(text, &[]);
    run.run_until("at the thread", |simulation| {
        simulation.cnc.cursor().line == 5
    });
    run.press(FEED_HOLD);
    assert_eq!((run.state(), run.z()), (RunState::Hold, 5.0));
    run.run_ticks(15_000);
    assert_eq!(run.state(), RunState::Hold, "the hold stands");
    assert!(!run.simulation.cnc.is_moving());
    let at = run.simulation.cnc.position_absolute();
    assert_eq!((at.diameter().0, at.z), (60.0, 3.0));
}

#[test]
fn single_block_stops_after_each_move_of_a_thread_cycle() {
    let text = "O0001\nM03 S500\nG04 X1\nG00 X40 Z5\nG92 X36 Z-20 F2 J1 K1\nM30\n";
    let mut run = ThreadRun::started(text, &[]);
    run.run_until("at the cycle", |simulation| {
        simulation.cnc.cursor().line == 4
    });
    press(&mut run.simulation, SINGLE_BLOCK);
    let mut stops = Vec::new();
    loop {
        run.finish();
        let at = run.simulation.cnc.position_absolute();
        stops.push((at.diameter().0, at.z));
        // Another key press would start the program again.
        if run.state() == RunState::Reset {
            break;
        }
        run.press(CYCLE_START);
    }
    stops.dedup();
    let moves = [
        (40.0, 5.0),
        (36.0, 5.0),
        (38.0, -20.0),
        (40.0, -20.0),
        (40.0, 5.0),
    ];
    assert_eq!(stops, moves);
}
