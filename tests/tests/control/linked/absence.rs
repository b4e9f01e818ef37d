//! A computer that was stopped or asleep for longer than the lookahead, and late reports. A
//! line board at rest receives nothing before it has reported its position. No report is
//! compared with motion from after its request.

use core::time::Duration;

use gsk_link::LinkState;
use gsk_twins::grbl::{GrblTwin, Variant};
use gsk_twins::wire::Damage;

use super::{LINES, assert_together};
use crate::bench::board::Machine;
use crate::bench::keys::{AUTO, CYCLE_START, JOG, RAPID, RESET, Z_MINUS};

const MS: u64 = 1_000_000;
const CUT: &str = "O1\nG50 X60 Z20\nG98 G01 X50 Z-180 F900\nM30\n";
const DWELL: &str = "O1\nG50 X60 Z20\nM03 S500\nG04 X6\nG98 G01 X50 Z0 F900\nM30\n";

/// The current motion.
#[derive(Clone, Copy, Debug)]
enum Motion {
    Jog,
    Rapid,
    Cut,
}

fn moving(ready: &Machine, motion: Motion, after: u32) -> Machine {
    let mut machine = ready.clone();
    match motion {
        Motion::Cut => {
            machine.load(CUT, None);
            machine.start();
        }
        Motion::Jog | Motion::Rapid => {
            machine.press(JOG);
            if matches!(motion, Motion::Rapid) {
                machine.press(RAPID);
            }
            machine.simulation.cnc.set_panel_key(Z_MINUS, true);
        }
    }
    assert!(machine.wait(5000, |machine| machine.linked.state() == LinkState::Moving));
    machine.pass(after);
    machine
}

/// The axis stays where it stopped, the control shows the same position, and the operator
/// continues from there.
fn stands_and_goes_on(mut machine: Machine, place: &str) {
    let stood = machine.twin.pulses();
    machine.pass(2000);
    assert_eq!(machine.twin.pulses(), stood, "{place}: it moves again");
    assert_eq!(machine.alarms(), [612], "{place}");
    assert_eq!(machine.linked.state(), LinkState::Ready, "{place}");
    assert_together(&machine);
    machine.simulation.cnc.set_panel_key(Z_MINUS, false);
    machine.press(RESET);
    machine.pass(500);
    machine.works();
}

#[test]
fn after_an_absence_nothing_but_a_question_is_sent_before_the_board_has_answered() {
    for variant in LINES {
        let ready = Machine::referenced(variant);
        for motion in [Motion::Jog, Motion::Rapid, Motion::Cut] {
            // The pause begins at any moment between two reports, and in the run-up.
            for (after, pause) in [(40, 3000), (603, 400), (611, 3000), (617, 60_000)] {
                let place = format!("{variant:?} {motion:?} {after} ms, away {pause} ms");
                let mut machine = moving(&ready, motion, after);
                machine.pause(pause);
                machine.record();
                machine.pass(1);
                let lines = machine.sent.iter().filter(|byte| **byte != b'?').count();
                assert_eq!(lines, 0, "{place}: {:?}", machine.sent);
                stands_and_goes_on(machine, &place);
            }
        }
    }
}

#[test]
fn a_line_that_was_cut_off_by_the_absence_is_never_completed() {
    for variant in LINES {
        let mut machine = moving(&Machine::referenced(variant), Motion::Cut, 600);
        // The port accepts half of the queue, then the computer sleeps.
        machine.takes_at_most = Some(7);
        machine.pass(20);
        machine.takes_at_most = None;
        machine.pause(3000);
        stands_and_goes_on(machine, &format!("{variant:?}"));
    }
}

#[test]
fn a_sleep_that_only_the_clock_on_the_wall_shows_is_an_absence() {
    let slept = Duration::from_secs(3600);
    for motion in [Motion::Jog, Motion::Rapid, Motion::Cut] {
        let mut machine = moving(&Machine::referenced(Variant::Grbl), motion, 600);
        machine.linked.judge_absence(slept);
        // The board executes what it holds.
        machine.pass(300);
        stands_and_goes_on(machine, &format!("{motion:?}"));
    }
}

#[test]
fn a_program_in_a_dwell_does_not_go_on_after_a_sleep() {
    for pause in [200, 3000] {
        let mut machine = Machine::referenced(Variant::Grbl);
        machine.load(DWELL, None);
        machine.press(AUTO);
        machine.press(CYCLE_START);
        machine.pass(2500);
        let stood = machine.twin.pulses();
        machine.pause(pause);
        if pause > 1000 {
            machine.pass(8000);
            assert_eq!(machine.twin.pulses(), stood);
            assert_eq!(machine.alarms(), [612]);
            machine.press(RESET);
            machine.pass(1000);
            machine.works();
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
        let ready = Machine::referenced(variant);
        for after in (600..640).step_by(4) {
            let mut machine = moving(&ready, Motion::Cut, after);
            machine.cut_cable();
            machine.pass(3000);
            assert_eq!(machine.alarms(), [605], "{variant:?} after {after} ms");
        }
    }
}

/// The process with the port has ended, and another one has stopped the board. The board's
/// banner proves that the spindle is off, and the control shows that.
#[test]
fn a_board_that_another_holder_has_stopped_is_shown_without_its_spindle() {
    let mut machine = Machine::referenced(Variant::Grbl);
    machine.load(DWELL, None);
    machine.start();
    machine.pass(2500);
    assert!(machine.simulation.cnc.spindle_switched() > 0.0);
    machine.linked.lost(gsk_messages::say::port_holder_gone());
    machine.pass(500);
    assert!(
        machine.simulation.cnc.spindle_switched() > 0.0,
        "nobody knows"
    );
    machine.linked.stopped_by_holder(b"ok\r\n");
    machine.pass(100);
    assert!(machine.simulation.cnc.spindle_switched() > 0.0, "no banner");
    machine
        .linked
        .stopped_by_holder(b"\r\nGrbl 1.1h ['$' for help]\r\n");
    machine.pass(500);
    assert!(machine.simulation.cnc.spindle_switched() == 0.0);
}

/// Delays the line to the host: reports come late, and the answers after them too.
fn late(machine: &mut Machine<GrblTwin>, bytes: u64, ms: u64) {
    let byte = machine.twin.to_host.sent_count() + bytes;
    machine.twin.to_host.damage(byte, Damage::Stalled(ms * MS));
}

#[test]
fn a_late_report_is_compared_with_the_motion_from_its_question_on() {
    for variant in LINES {
        let ready = Machine::referenced(variant);
        for feed in [60, 300, 900] {
            for ms in [90, 200, 310, 400, 480] {
                for bytes in [0, 13, 37] {
                    let mut machine = ready.clone();
                    let text = format!("O1\nG50 X60 Z20\nG98 G01 X50 Z-180 F{feed}\nM30\n");
                    machine.load(&text, None);
                    machine.start();
                    machine.pass(2000);
                    late(&mut machine, bytes, ms);
                    machine.pass(1500);
                    let alarms = machine.alarms();
                    let place = format!("{variant:?} F{feed}, {ms} ms late: {alarms:?}");
                    assert!(!alarms.contains(&611), "{place}");
                    assert!(alarms.is_empty() || alarms == [612], "{place}");
                }
            }
        }
    }
}
