//! The handwheel at the board: it moves an axis in handwheel mode, and only while it turns.

use gsk_core::units::Axis;

use super::machine::{PicoMachine, WIRED};
use crate::bench::keys::{AUTO, INCREMENT_100, JOG, RESET, STEP, WHEEL_Z};

/// The wires of the tests with a handwheel.
fn wired() -> String {
    WIRED.replace("io: (", "io: (wheel: \"gpio26\", ")
}

/// A referenced machine with a handwheel, in handwheel mode for Z.
fn with_wheel() -> PicoMachine {
    let mut machine = PicoMachine::new(&wired(), &[]);
    machine.return_axes();
    for key in [STEP, WHEEL_Z, INCREMENT_100] {
        machine.press(key);
    }
    machine
}

/// Turns the wheel by graduations, one in 10 ms.
fn turn(machine: &mut PicoMachine, graduations: i32) {
    for _ in 0..graduations.abs() {
        machine.twin.turn_wheel(4 * graduations.signum());
        machine.run_ms(10);
    }
}

fn z_pulses(machine: &PicoMachine) -> i64 {
    machine.twin.pulses()[1] - machine.origin[1]
}

#[test]
fn the_wheel_at_the_board_moves_the_axis_while_it_turns() {
    let mut machine = with_wheel();
    let from = z_pulses(&machine);
    // 30 graduations of 0.1 mm, 5 µm a pulse.
    turn(&mut machine, -30);
    machine.run_ms(800);
    assert_eq!(machine.alarms(), [""; 0]);
    assert_eq!(z_pulses(&machine) - from, -600);
    machine.assert_agrees();
    machine.run_ms(500);
    assert_eq!(z_pulses(&machine) - from, -600, "it moves on");
    turn(&mut machine, 10);
    machine.run_ms(800);
    assert_eq!(z_pulses(&machine) - from, -400);
}

#[test]
fn the_wheel_moves_nothing_in_other_modes() {
    let mut machine = with_wheel();
    let from = z_pulses(&machine);
    for key in [JOG, AUTO] {
        machine.press(key);
        turn(&mut machine, -20);
        machine.run_ms(500);
        assert_eq!(z_pulses(&machine), from);
    }
    // Turns in another mode are not made up.
    machine.press(STEP);
    machine.run_ms(500);
    assert_eq!(z_pulses(&machine), from);
    turn(&mut machine, -5);
    machine.run_ms(500);
    assert_eq!(z_pulses(&machine) - from, -100);
}

#[test]
fn turns_during_a_silence_move_nothing() {
    let mut machine = with_wheel();
    let from = z_pulses(&machine);
    // The computer is busy for half a second; its port keeps the reports.
    machine.is_host_dead = true;
    turn(&mut machine, -30);
    machine.run_ms(300);
    machine.is_host_dead = false;
    machine.run_ms(1500);
    assert_eq!(z_pulses(&machine), from, "{:?}", machine.alarms());
}

#[test]
fn the_emergency_stop_ends_the_motion_of_the_wheel() {
    let mut machine = with_wheel();
    turn(&mut machine, -10);
    machine.twin.set_pin("gpio11", true);
    machine.run_ms(5);
    let stood = z_pulses(&machine);
    turn(&mut machine, -20);
    machine.run_ms(500);
    assert_eq!(z_pulses(&machine), stood);
    assert!(!machine.alarms().is_empty());
    machine.twin.set_pin("gpio11", false);
    machine.press(RESET);
    machine.run_ms(3000);
    assert_eq!(z_pulses(&machine), stood, "the turns are not made up");
    assert!(!*machine.simulation.cnc.referenced_axes().get(Axis::Z));
}
