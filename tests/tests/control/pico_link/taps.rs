//! Tapping (G33) with our own board: Z follows the true angle in, through the stop and reversal of
//! the spindle, and back to exactly its start.

use gsk_core::operation::RunState;
use gsk_link::LinkState;
use gsk_twins::pico::{PicoState, PicoStep};

use super::machine::{COUNTS, PicoMachine, WIRED};
use super::stops::assert_stands_and_is_true;
use super::threads::PULSE_MM;
use crate::bench::keys::{CYCLE_START, FEED_HOLD, MACHINE_LOCK, RESET};
use crate::step_link::lathe::referenced_lathe;

/// Greatest run-on of the spindle after the programmed depth in these tests, s at its speed: the
/// report, the ladder, the output, and the time constant of the spindle.
const RUN_ON_S: f64 = 0.6;

fn program(spindle: &str, tap: &str) -> String {
    format!("O1\nG50 X40 Z5\nG97 {spindle}\nG00 X0 Z2\n{tap}\nG00 X40 Z5\nM30\n")
}

/// The steps of Z from the first of the tap on: those between the two rapids.
fn tap_steps(machine: &PicoMachine) -> Vec<PicoStep> {
    let (_, offset) = machine.program_offset();
    let z = |step: &PicoStep| (step.position - machine.origin[1]) as f64 * PULSE_MM + offset;
    let steps = machine.steps.iter().filter(|step| step.stepper == 1);
    // The last step of the rapid ends at Z2; the first of the next rapid leaves it upwards.
    let after = steps
        .skip_while(|step| z(step) > 2.0 + PULSE_MM / 2.0)
        .skip(1);
    after
        .take_while(|step| z(step) < 2.0 + PULSE_MM / 2.0)
        .copied()
        .collect()
}

/// The greatest distance, steps, between a step on the way in and the step back over the same
/// place, and the greatest distance of the way in from the lead, both beyond one count.
fn phase_errors(steps: &[PicoStep], lead: f64, direction: i64) -> (f64, f64) {
    let per_count = lead / PULSE_MM / f64::from(COUNTS);
    let top = steps[0].position + 1;
    let deepest = steps.iter().map(|step| step.position).min().unwrap();
    let bottom = steps
        .iter()
        .position(|step| step.position == deepest)
        .unwrap();
    let (down, up) = steps.split_at(bottom + 1);
    // The last step down into each place, and the first step up out of it.
    let mut apart: f64 = 0.0;
    let mut from_lead: f64 = 0.0;
    let middle = down.iter().find(|step| step.position == top - 500).unwrap();
    for position in deepest..top {
        let last = down.iter().rfind(|step| step.position == position);
        let first = up.iter().find(|step| step.position == position + 1);
        let (last, first) = (last.unwrap(), first.unwrap());
        let counts = (first.count - last.count).abs() as f64;
        apart = apart.max((counts - 1.0) * per_count);
        if position < middle.position {
            let turned = (last.count - middle.count) * direction;
            let made = (middle.position - position) as f64;
            from_lead = from_lead.max((turned as f64 * per_count - made).abs() - per_count);
        }
    }
    (apart, from_lead)
}

/// A tap of the table: spindle words, its block, its depth, mm, lead, mm, and turns per second.
type TapCase = (&'static str, &'static str, f64, f64, f64);

const TAPS: [TapCase; 8] = [
    ("M03 S300", "G33 Z-20 F1.5", -20.0, 1.5, 5.0),
    ("M03 S600", "G33 Z-8 F0.5", -8.0, 0.5, 10.0),
    ("M04 S300", "G33 Z-12 F2", -12.0, 2.0, 5.0),
    ("M03 S240", "G33 W-15 I16", -13.0, 25.4 / 16.0, 4.0),
    ("M03 S120", "G33 Z-6 F1", -6.0, 1.0, 2.0),
    ("M04 S900", "G33 Z-10 F0.75", -10.0, 0.75, 15.0),
    ("M03 S480", "G33 Z-10 F1.25", -10.0, 1.25, 8.0),
    ("M03 S300", "G33 Z-3 F3", -3.0, 3.0, 5.0),
];

#[test]
fn taps_follow_the_spindle_in_and_back_to_their_start() {
    let mut machine = PicoMachine::referenced(&[]);
    machine.twin.set_speed_ripple(20.0, 3.0);
    for (number, (spindle, tap, programmed, lead, speed)) in TAPS.into_iter().enumerate() {
        machine.sleep = 1 + number as u64 % 5;
        machine.start_program(&program(spindle, tap));
        machine.finish(60_000);
        assert_eq!(machine.alarms(), [""; 0], "{tap}");
        machine.assert_agrees();
        let steps = tap_steps(&machine);
        let sum = steps.last().map(|step| step.position);
        assert_eq!(sum, Some(steps[0].position + 1), "{tap}: net zero steps");
        assert!(steps.len().is_multiple_of(2), "{tap}");
        let (_, offset) = machine.program_offset();
        let deepest = steps.iter().map(|step| step.position).min().unwrap();
        let deepest = (deepest - machine.origin[1]) as f64 * PULSE_MM + offset;
        let run_on = programmed - deepest;
        let most = lead * speed * RUN_ON_S * 1.2 + lead;
        assert!(run_on > 0.0 && run_on < most, "{tap}: {run_on} of {most}");
        let direction = if spindle.starts_with("M04") { -1 } else { 1 };
        let (apart, from_lead) = phase_errors(&steps, lead, direction);
        println!(
            "{spindle} {tap}: run-on {run_on:.2} mm, in and back {apart:.2} steps, lead {from_lead:.2} steps"
        );
        assert!(
            apart <= 1.0 && from_lead <= 1.0,
            "{tap}: {apart} {from_lead}"
        );
        assert!(
            machine.twin.spindle_rpm().abs() < 1.0,
            "{tap}: M05 at the end"
        );
    }
}

/// A machine in a tap of 15 turns, below a depth, mm.
fn in_tap(depth: f64) -> PicoMachine {
    let mut machine = PicoMachine::referenced(&[]);
    machine.twin.set_speed_ripple(20.0, 3.0);
    machine.start_program(&program("M03 S300", "G33 Z-13 F1"));
    assert!(machine.run_until(20_000, |machine| {
        machine.simulation.cnc.position_absolute().z < depth
    }));
    machine
}

/// The same on its way back.
fn on_the_way_back() -> PicoMachine {
    let mut machine = in_tap(-12.9);
    assert!(machine.run_until(20_000, |machine| {
        machine.simulation.cnc.position_absolute().z > -8.0
    }));
    machine
}

#[test]
fn the_depth_that_the_control_shows_is_that_of_the_board() {
    let mut machine = in_tap(1.9);
    let mut worst: f64 = 0.0;
    for _ in 0..4000 {
        machine.run_one_ms();
        let kernel = machine.simulation.cnc.pulses().z.0;
        let board = machine.twin.pulses()[1] - machine.origin[1];
        worst = worst.max((kernel - board).abs() as f64 * PULSE_MM);
    }
    println!("shown depth at most {worst:.3} mm from the board's");
    // 5 turns/s and 20 %: a report every 10 ms, shown over the next 10 ms, and the line.
    assert!(worst < 0.18, "{worst}");
    machine.finish(20_000);
    assert_eq!(machine.alarms(), [""; 0]);
    machine.assert_agrees();
}

#[test]
fn several_starts_restart_the_spindle_and_feed_hold_waits_for_the_start() {
    let mut machine = PicoMachine::referenced(&[]);
    machine.start_program(&program("M03 S300", "G33 Z-5 F2 L2"));
    machine.finish(60_000);
    assert_eq!(machine.alarms(), [""; 0]);
    machine.assert_agrees();
    let turns = machine
        .steps
        .windows(2)
        .filter(|pair| pair[0].stepper == 1 && pair[1].stepper == 1)
        .filter(|pair| pair[1].at_ns - pair[0].at_ns > 300_000_000)
        .count();
    assert!(turns >= 3, "two taps with a standstill each: {turns}");

    for mut machine in [in_tap(-3.0), on_the_way_back()] {
        machine.press(FEED_HOLD);
        assert_eq!(machine.simulation.cnc.run_state(), RunState::Hold);
        assert!(machine.run_until(20_000, |machine| {
            machine.linked.state() == LinkState::Ready && machine.twin.spindle_rpm().abs() < 1.0
        }));
        machine.run_ms(500);
        assert_eq!(machine.simulation.cnc.run_state(), RunState::Hold);
        let z = machine.simulation.cnc.position_absolute().z;
        assert!((z - 2.0).abs() < 1e-6, "{z}");
        machine.assert_agrees();
        machine.press(CYCLE_START);
        machine.finish(20_000);
        assert_eq!(machine.alarms(), [""; 0]);
        machine.assert_agrees();
    }
}

#[test]
fn reset_and_emergency_stop_leave_a_true_count() {
    let machines = [in_tap(-3.0), on_the_way_back()];
    for is_emergency in [false, true] {
        for mut machine in machines.clone() {
            if is_emergency {
                machine.simulation.lathe.set_emergency_button(true);
            } else {
                machine.press(RESET);
            }
            machine.run_ms(1500);
            assert_stands_and_is_true(&mut machine);
            // 300 mm/min and the ripple are more than a motor may stop from.
            assert!(!machine.linked.knows_position());
            assert!(!machine.alarms().is_empty());
        }
    }
}

#[test]
fn a_slow_tap_keeps_its_position_after_reset() {
    let mut machine = PicoMachine::referenced(&[]);
    machine.start_program(&program("M03 S100", "G33 Z-13 F1"));
    assert!(machine.run_until(30_000, |machine| {
        machine.simulation.cnc.position_absolute().z < -2.0
    }));
    machine.press(RESET);
    machine.run_ms(1500);
    assert_stands_and_is_true(&mut machine);
    assert!(machine.linked.knows_position());
    assert_eq!(machine.alarms(), [""; 0]);
    machine.start_program("O2\nG98 G01 W2 F100\nM30\n");
    machine.finish(20_000);
    machine.assert_agrees();
}

#[test]
fn a_spindle_that_does_not_stop_shuts_the_board_down_at_the_bound() {
    let mut machine = in_tap(-3.0);
    machine.twin.set_spindle_drive_stuck(true);
    machine.run_ms(12_000);
    assert_eq!(
        machine.twin.state(),
        PicoState::Shutdown("Tap beyond its last segment")
    );
    let alarms = machine.alarms();
    assert!(alarms[0].contains("614"), "{alarms:?}");
    assert_stands_and_is_true(&mut machine);
    assert!(!machine.linked.knows_position());
    // 15 turns, and 3 s and two turns more.
    let z = machine.simulation.cnc.position_absolute().z;
    assert!((-30.5..-29.5).contains(&z), "{z}");
}

#[test]
fn a_spindle_that_is_not_reversed_is_reported_at_a_known_position() {
    let mut machine = in_tap(-3.0);
    machine.twin.set_reverse_missing(true);
    machine.run_ms(15_000);
    let alarms = machine.alarms();
    assert!(alarms[0].contains("614"), "{alarms:?}");
    assert_stands_and_is_true(&mut machine);
    assert!(machine.linked.knows_position());
}

#[test]
fn a_stalled_spindle_and_a_dead_encoder_stop_z_with_them() {
    for mut machine in [in_tap(-3.0), on_the_way_back()] {
        machine.twin.set_stalled(true);
        machine.run_ms(100);
        let at = machine.twin.pulses();
        machine.run_ms(6500);
        assert_eq!(machine.twin.pulses(), at);
        let alarms = machine.alarms();
        assert!(alarms[0].contains("614"), "{alarms:?}");
        assert_stands_and_is_true(&mut machine);
        assert!(machine.linked.knows_position());
    }
}

/// The name of a fault, and what brings it about.
type TapFault = (&'static str, fn(&mut PicoMachine));

#[test]
fn switches_index_and_line_faults_in_a_tap_are_reported() {
    let faults: [TapFault; 6] = [
        ("622", |machine| machine.twin.set_pin("gpio22", true)),
        ("207", |machine| machine.twin.set_pin("gpio11", true)),
        ("614", |machine| machine.twin.jump_encoder(300)),
        ("605", |machine| {
            machine.twin.to_board.set_cut(true);
            machine.twin.to_host.set_cut(true);
        }),
        ("606", |machine| machine.twin.press_reset()),
        ("605", |machine| {
            machine.is_host_dead = true;
            machine.run_ms(400);
            machine.is_host_dead = false;
        }),
    ];
    let machines = [in_tap(-3.0), in_tap(-12.99), on_the_way_back()];
    for (number, fault) in faults {
        for mut machine in machines.clone() {
            fault(&mut machine);
            machine.run_ms(2500);
            let alarms = machine.alarms();
            let is_shown = alarms.iter().any(|alarm| alarm.contains(number));
            assert!(is_shown, "{number}: {alarms:?}");
            let stood = machine.twin.pulses();
            machine.run_ms(500);
            assert_eq!(machine.twin.pulses(), stood, "{number}: it moves on");
            if machine.linked.knows_position() {
                machine.assert_agrees();
            }
        }
    }
}

#[test]
fn a_tap_that_cannot_begin_is_refused() {
    // The encoder counts backwards.
    let mut machine = PicoMachine::new(WIRED, &[]);
    machine.twin.set_encoder_reversed(true);
    machine.return_axes();
    machine.start_program(&program("M03 S300", "G33 Z-10 F1"));
    machine.finish(20_000);
    let alarms = machine.alarms();
    assert!(alarms[0].contains("614"), "{alarms:?}");
    machine.assert_agrees();
    // No index.
    let mut machine = PicoMachine::referenced(&[]);
    machine.twin.set_index_lost(true);
    machine.start_program(&program("M03 S300", "G33 Z-10 F1"));
    machine.finish(20_000);
    let alarms = machine.alarms();
    assert!(alarms[0].contains("614"), "{alarms:?}");
    machine.assert_agrees();
    assert!(machine.linked.knows_position());
    // Older firmware.
    let mut machine = PicoMachine::new(WIRED, &[]);
    machine.twin.use_older_firmware("begin_tap");
    machine.return_axes();
    machine.start_program(&program("M03 S300", "G33 Z-10 F1"));
    machine.finish(20_000);
    let alarms = machine.alarms();
    assert!(alarms[0].contains("604"), "{alarms:?}");
    assert!(alarms[0].contains("firmware"), "{alarms:?}");
    machine.assert_agrees();
    // Klipper's firmware sees the index only.
    let mut lathe = referenced_lathe(true, &[]);
    lathe.start_program(&program("M03 S300", "G33 Z-10 F1"));
    lathe.finish(60_000);
    let alarms = lathe.alarms();
    assert!(alarms[0].contains("604"), "{alarms:?}");
    assert!(alarms[0].contains("brakes"), "{alarms:?}");
}

#[test]
fn with_machine_lock_a_tap_moves_nothing() {
    let mut machine = PicoMachine::referenced(&[]);
    machine.press(MACHINE_LOCK);
    let at = machine.twin.pulses();
    machine.start_program(&program("M03 S300", "G33 Z-10 F1"));
    machine.finish(60_000);
    assert_eq!((machine.alarms(), machine.twin.pulses()), (vec![], at));
}

#[test]
fn backlash_is_taken_up_before_and_after_a_tap() {
    // 035: 0.1 mm of Z, 20 pulses.
    let mut machine = PicoMachine::referenced(&[(35, 100)]);
    machine.start_program(&program("M03 S300", "G33 Z-10 F1"));
    machine.finish(60_000);
    assert_eq!(machine.alarms(), [""; 0]);
    machine.assert_agrees();
    let z = machine.simulation.cnc.position_absolute().z;
    assert!((z - 5.0).abs() < PULSE_MM, "{z}");
}
