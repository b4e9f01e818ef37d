//! Stops of our own board: the count is true after each, the axes stay on their path, and a
//! reason is shown.

use gsk_link::LinkState;
use gsk_twins::pico::{PicoState, TwinAxisEncoder};

use super::machine::{PicoMachine, WIRED};
use super::threads::disturb;
use crate::bench::keys::RESET;

/// A thread with a wide path on which something can happen.
pub const LONG_THREAD: &str =
    "O1\nG50 X40 Z5\nG98 G97 M03 S600\nG00 X30 Z5\nG92 X29 Z-60 F2\nX28.6\nG00 X40 Z5\nM30\n";

/// In the first pass of a thread, well inside.
pub fn in_thread() -> PicoMachine {
    let mut machine = PicoMachine::referenced(&[]);
    disturb(&mut machine, 0);
    machine.start_program(LONG_THREAD);
    assert!(machine.run_until(20_000, |machine| {
        machine.simulation.cnc.position_absolute().z < -15.0
    }));
    machine
}

/// Checks that nothing moves any more, and that the pulses that the control shows are those that
/// the board has made.
#[track_caller]
pub fn assert_stands_and_is_true(machine: &mut PicoMachine) {
    let stood = machine.twin.pulses();
    machine.run_ms(500);
    assert_eq!(machine.twin.pulses(), stood, "it moves on");
    machine.assert_agrees();
}

#[test]
fn a_limit_switch_in_a_thread_stops_at_a_known_position() {
    let mut machine = in_thread();
    let at = machine.twin.pulses()[1];
    machine.twin.set_pin("gpio22", true);
    machine.run_ms(500);
    let run_on = machine.twin.pulses()[1].abs_diff(at);
    println!("limit: {run_on} pulses");
    assert!(run_on <= 8, "{run_on}");
    let alarms = machine.alarms();
    assert!(alarms[0].contains("622"), "{alarms:?}");
    assert_stands_and_is_true(&mut machine);
}

#[test]
fn a_guard_stops_the_board_without_the_host() {
    let mut machine = in_thread();
    machine.is_host_dead = true;
    let at = machine.twin.pulses()[1];
    machine.twin.set_pin("gpio11", true);
    machine.run_ms(50);
    let run_on = machine.twin.pulses()[1].abs_diff(at);
    println!("guard: {run_on} pulses");
    assert!(run_on <= 4, "{run_on}");
    assert_eq!(
        machine.twin.state(),
        PicoState::Shutdown("Guard input tripped")
    );
    assert_eq!(machine.twin.output("gpio15"), Some(0.0), "spindle off");
    assert_eq!(machine.twin.output("gpio14"), Some(0.0), "drives off");
    machine.is_host_dead = false;
    machine.run_ms(300);
    let alarms = machine.alarms();
    assert!(
        alarms.iter().any(|alarm| alarm.contains("207")),
        "{alarms:?}"
    );
    assert_stands_and_is_true(&mut machine);
    // With the button still pressed the board cannot be opened.
    machine.press(RESET);
    machine.run_ms(3000);
    assert_eq!(machine.linked.state(), LinkState::Fault);
    machine.twin.set_pin("gpio11", false);
    machine.press(RESET);
    assert!(
        machine.run_until(5000, |machine| machine.linked.state() == LinkState::Locked),
        "{:?} {:?}",
        machine.linked.state(),
        machine.alarms()
    );
    assert!(!machine.linked.knows_position());
}

#[test]
fn without_the_host_the_lease_expires_and_the_axes_slow_down_on_their_path() {
    let mut machine = in_thread();
    machine.is_host_dead = true;
    let at = machine.twin.pulses()[1];
    let before = machine.steps.len();
    machine.run_ms(400);
    let run_on = machine.twin.pulses()[1].abs_diff(at);
    let speed = |steps: &[gsk_twins::pico::PicoStep]| {
        let ns = steps[steps.len() - 1].at_ns - steps[0].at_ns;
        (steps.len() - 1) as f64 / ns as f64 * 1e9
    };
    let tail = &machine.steps[machine.steps.len() - 4..];
    println!(
        "lease: {run_on} pulses, last at {:.0} of {:.0} steps/s",
        speed(tail),
        speed(&machine.steps[before - 40..before])
    );
    // 90 ms and half of 67 ms at 4000 pulses/s, with the ripple.
    assert!(run_on <= 650, "{run_on}");
    assert!(speed(tail) < 0.3 * speed(&machine.steps[before - 40..before]));
    assert_eq!(machine.twin.state(), PicoState::Shutdown("Lease expired"));
    assert_eq!(machine.twin.output("gpio15"), Some(0.0), "spindle off");
    machine.is_host_dead = false;
    machine.run_ms(300);
    let alarms = machine.alarms();
    assert!(alarms[0].contains("605"), "{alarms:?}");
    assert!(alarms[0].contains("by the board's count"), "{alarms:?}");
    assert_stands_and_is_true(&mut machine);
}

#[test]
fn a_spindle_that_stalls_stops_the_axes_with_it() {
    let mut machine = in_thread();
    machine.twin.set_stalled(true);
    machine.run_ms(100);
    let at = machine.twin.pulses();
    machine.run_ms(2000);
    assert_eq!(machine.twin.pulses(), at, "the axes wait");
    let alarms = machine.alarms();
    assert!(alarms[0].contains("614"), "{alarms:?}");
    assert_stands_and_is_true(&mut machine);
    assert!(machine.linked.knows_position());
    // The next program runs from the known position.
    machine.twin.set_stalled(false);
    machine.press(RESET);
    machine.start_program("O2\nG50 X40 Z5\nG98 M03 S600\nG01 U1 W1 F500\nM30\n");
    machine.finish(20_000);
    assert_eq!(machine.alarms(), [""; 0]);
    machine.assert_agrees();
}

#[test]
fn reset_in_a_thread_brakes_on_the_path() {
    let mut machine = in_thread();
    machine.press(RESET);
    machine.run_ms(1500);
    assert_stands_and_is_true(&mut machine);
    assert!(machine.simulation.cnc.position_absolute().z > -40.0);
}

#[test]
fn an_encoder_that_counts_backwards_cuts_nothing() {
    let mut machine = PicoMachine::new(WIRED, &[]);
    machine.twin.set_encoder_reversed(true);
    machine.return_axes();
    machine.start_program(LONG_THREAD);
    machine.finish(20_000);
    let alarms = machine.alarms();
    assert!(alarms[0].contains("614"), "{alarms:?}");
    assert!(alarms[0].contains("exchange"), "{alarms:?}");
    machine.assert_agrees();
    let at = machine.simulation.cnc.position_absolute();
    assert_eq!(at.z, 5.0, "not fed in");
}

#[test]
fn a_missing_index_is_reported_and_a_disturbed_one_stops() {
    let mut machine = PicoMachine::referenced(&[]);
    machine.twin.set_index_lost(true);
    machine.start_program(LONG_THREAD);
    machine.finish(20_000);
    let alarms = machine.alarms();
    assert!(alarms[0].contains("614"), "{alarms:?}");
    assert!(alarms[0].contains("io.index"), "{alarms:?}");
    assert_stands_and_is_true(&mut machine);

    let mut machine = in_thread();
    while (machine.twin.spindle_turns() * 10.0).rem_euclid(10.0) < 5.0 {
        machine.run_one_ms();
    }
    machine.twin.set_index_stuck(true);
    machine.run_ms(500);
    let alarms = machine.alarms();
    assert!(alarms[0].contains("614"), "{alarms:?}");
    assert_eq!(
        machine.twin.state(),
        PicoState::Shutdown("Spindle index at another count")
    );
    assert_stands_and_is_true(&mut machine);
}

#[test]
fn a_motor_that_does_not_follow_has_its_own_alarm() {
    let wired = WIRED.replace(
        r#"dec: "gpio13")"#,
        r#"dec: "gpio13", encoder: (pin: "gpio8", counts: 4, steps: 1, limit: 20))"#,
    );
    let mut machine = PicoMachine::new(&wired, &[]);
    machine.twin.attach_axis_encoder(
        1,
        TwinAxisEncoder {
            counts: 4,
            steps: 1,
            lost_steps: 0,
        },
    );
    machine.return_axes();
    machine.start_program("O1\nG50 X40 Z5\nG98 M03 S600\nG01 W-20 F500\nM30\n");
    machine.run_ms(1000);
    machine.twin.lose_steps(1, 15);
    machine.run_ms(200);
    assert_eq!(machine.alarms(), [""; 0], "within the limit");
    machine.twin.lose_steps(1, 15);
    machine.run_ms(300);
    let alarms = machine.alarms();
    assert!(alarms[0].contains("613"), "{alarms:?}");
    assert_stands_and_is_true(&mut machine);
}
