//! A computer that was stopped or asleep for longer than the lookahead, and late reports. A
//! line board at rest receives nothing before it has reported its position. No report is
//! compared with motion from after its request.

use core::time::Duration;

use gsk_link::LinkState;
use gsk_twins::grbl::{GrblTwin, Variant};
use gsk_twins::wire::Damage;

use super::{LINES, assert_counts_agree};
use crate::bench::board::LinkedMachine;
use crate::bench::keys::{AUTO, CYCLE_START, JOG, RAPID, RESET, Z_MINUS};

const MS: u64 = 1_000_000;
const CUT: &str = "O1\nG50 X60 Z20\nG98 G01 X50 Z-180 F900\nM30\n";
const DWELL: &str = "O1\nG50 X60 Z20\nM03 S500\nG04 X6\nG98 G01 X50 Z0 F900\nM30\n";

/// The current motion.
#[derive(Clone, Copy, Debug)]
enum PausedMotion {
    Jog,
    Rapid,
    Cut,
}

fn machine_in_motion(ready: &LinkedMachine, motion: PausedMotion, after: u32) -> LinkedMachine {
    let mut machine = ready.clone();
    match motion {
        PausedMotion::Cut => {
            machine.load(CUT, None);
            machine.start_program();
        }
        PausedMotion::Jog | PausedMotion::Rapid => {
            machine.press(JOG);
            if matches!(motion, PausedMotion::Rapid) {
                machine.press(RAPID);
            }
            machine.simulation.cnc.set_panel_key(Z_MINUS, true);
        }
    }
    assert!(machine.run_until(5000, |machine| machine.linked.state() == LinkState::Moving));
    machine.run_ms(after);
    machine
}

/// The axis stays where it stopped, the control shows the same position, and the operator
/// continues from there.
fn check_stop_and_continue(mut machine: LinkedMachine, place: &str) {
    let stood = machine.twin.pulses();
    machine.run_ms(2000);
    assert_eq!(machine.twin.pulses(), stood, "{place}: it moves again");
    assert_eq!(machine.alarms(), [612], "{place}");
    assert_eq!(machine.linked.state(), LinkState::Ready, "{place}");
    assert_counts_agree(&machine);
    machine.simulation.cnc.set_panel_key(Z_MINUS, false);
    machine.press(RESET);
    machine.run_ms(500);
    machine.check_program_runs();
}

#[test]
fn after_a_pause_only_a_request_is_sent_until_the_board_has_answered() {
    for variant in LINES {
        let ready = LinkedMachine::referenced(variant);
        for motion in [PausedMotion::Jog, PausedMotion::Rapid, PausedMotion::Cut] {
            // The pause begins at any moment between two reports, and in the run-up.
            for (after, pause) in [(40, 3000), (603, 400), (611, 3000), (617, 60_000)] {
                let place = format!("{variant:?} {motion:?} {after} ms, away {pause} ms");
                let mut machine = machine_in_motion(&ready, motion, after);
                machine.pause_host(pause);
                machine.record_path();
                machine.run_ms(1);
                let lines = machine.sent.iter().filter(|byte| **byte != b'?').count();
                assert_eq!(lines, 0, "{place}: {:?}", machine.sent);
                check_stop_and_continue(machine, &place);
            }
        }
    }
}

#[test]
fn a_line_that_was_cut_off_by_the_pause_is_never_completed() {
    for variant in LINES {
        let mut machine =
            machine_in_motion(&LinkedMachine::referenced(variant), PausedMotion::Cut, 600);
        // The port accepts half of the queue, then the computer sleeps.
        machine.takes_at_most = Some(7);
        machine.run_ms(20);
        machine.takes_at_most = None;
        machine.pause_host(3000);
        check_stop_and_continue(machine, &format!("{variant:?}"));
    }
}

#[test]
fn a_sleep_that_only_the_wall_clock_shows_is_a_pause() {
    let slept = Duration::from_secs(3600);
    for motion in [PausedMotion::Jog, PausedMotion::Rapid, PausedMotion::Cut] {
        let mut machine = machine_in_motion(&LinkedMachine::referenced(Variant::Grbl), motion, 600);
        machine.linked.handle_host_gap(slept);
        // The board executes what it holds.
        machine.run_ms(300);
        check_stop_and_continue(machine, &format!("{motion:?}"));
    }
}

#[test]
fn a_program_in_a_dwell_does_not_continue_after_a_sleep() {
    for pause in [200, 3000] {
        let mut machine = LinkedMachine::referenced(Variant::Grbl);
        machine.load(DWELL, None);
        machine.press(AUTO);
        machine.press(CYCLE_START);
        machine.run_ms(2500);
        let stood = machine.twin.pulses();
        machine.pause_host(pause);
        if pause > 1000 {
            machine.run_ms(8000);
            assert_eq!(machine.twin.pulses(), stood);
            assert_eq!(machine.alarms(), [612]);
            machine.press(RESET);
            machine.run_ms(1000);
            machine.check_program_runs();
        } else {
            machine.run_to_end(60_000);
            assert_eq!(machine.alarms(), [0_u16; 0]);
        }
    }
}

/// A board lost during motion is reported as lost, and not as refusing motion.
#[test]
fn a_board_that_falls_silent_in_motion_is_lost_and_not_late() {
    for variant in LINES {
        let ready = LinkedMachine::referenced(variant);
        for after in (600..640).step_by(4) {
            let mut machine = machine_in_motion(&ready, PausedMotion::Cut, after);
            machine.cut_cable();
            machine.run_ms(3000);
            assert_eq!(machine.alarms(), [605], "{variant:?} after {after} ms");
        }
    }
}

/// The process with the port has ended, and another one has stopped the board. The board's
/// banner proves that the spindle is off, and the control shows that.
#[test]
fn a_board_that_another_holder_has_stopped_is_shown_without_its_spindle() {
    let mut machine = LinkedMachine::referenced(Variant::Grbl);
    machine.load(DWELL, None);
    machine.start_program();
    machine.run_ms(2500);
    assert!(machine.simulation.cnc.spindle_switched() > 0.0);
    machine
        .linked
        .handle_port_failure(gsk_messages::say::port_holder_gone());
    machine.run_ms(500);
    assert!(
        machine.simulation.cnc.spindle_switched() > 0.0,
        "nobody knows"
    );
    machine.linked.handle_guard_stop(b"ok\r\n");
    machine.run_ms(100);
    assert!(machine.simulation.cnc.spindle_switched() > 0.0, "no banner");
    machine
        .linked
        .handle_guard_stop(b"\r\nGrbl 1.1h ['$' for help]\r\n");
    machine.run_ms(500);
    assert!(machine.simulation.cnc.spindle_switched() == 0.0);
}

/// Delays the line to the host: reports come late, and the answers after them too.
fn delay_reports(machine: &mut LinkedMachine<GrblTwin>, bytes: u64, ms: u64) {
    let byte = machine.twin.to_host.sent_count() + bytes;
    machine.twin.to_host.damage(byte, Damage::Stalled(ms * MS));
}

#[test]
fn a_late_report_is_compared_with_the_motion_since_its_request() {
    for variant in LINES {
        let ready = LinkedMachine::referenced(variant);
        for feed in [60, 300, 900] {
            for ms in [90, 200, 310, 400, 480] {
                for bytes in [0, 13, 37] {
                    let mut machine = ready.clone();
                    let text = format!("O1\nG50 X60 Z20\nG98 G01 X50 Z-180 F{feed}\nM30\n");
                    machine.load(&text, None);
                    machine.start_program();
                    machine.run_ms(2000);
                    delay_reports(&mut machine, bytes, ms);
                    machine.run_ms(1500);
                    let alarms = machine.alarms();
                    let place = format!("{variant:?} F{feed}, {ms} ms late: {alarms:?}");
                    assert!(!alarms.contains(&611), "{place}");
                    assert!(alarms.is_empty() || alarms == [612], "{place}");
                }
            }
        }
    }
}
