//! A limit switch that was hit: the board proves the position, so the reference remains.

use gsk_core::operation::RunState;
use gsk_link::LinkState;

use super::machine::StepMachine;
use crate::bench::keys::{CYCLE_START, JOG, RESET, Z_MINUS, Z_PLUS};

fn referenced_machine() -> StepMachine {
    let mut machine = StepMachine::new();
    machine.return_axes();
    machine
}

fn run_to_end(machine: &mut StepMachine) {
    let ended = machine.run_until(120_000, |machine| {
        machine.simulation.cnc.run_state() != RunState::Run && !machine.linked.has_pending_motion()
    });
    assert!(ended);
}

#[test]
fn a_slow_trip_keeps_the_reference() {
    let mut machine = referenced_machine();
    machine.start_program("O1\nG98 G01 Z-20 F250\nM30\n");
    machine.run_ms(2500);
    machine.twin.set_pin("PC1", true);
    machine.run_ms(300);
    assert_eq!(machine.linked.state(), LinkState::Tripped);
    assert!(
        machine.alarms()[0].contains("622"),
        "{:?}",
        machine.alarms()
    );
    machine.assert_agrees();
    assert!(machine.linked.knows_position());
    let referenced = machine.simulation.cnc.referenced_axes();
    assert!(referenced.x && referenced.z);
    let stood = machine.twin.pulses();
    machine.run_ms(1000);
    assert_eq!(machine.twin.pulses(), stood);
    // Farther is refused, the other direction is allowed; RESET may come before or after.
    machine.press(JOG);
    machine.press(Z_MINUS);
    machine.run_ms(500);
    assert_eq!(machine.twin.pulses(), stood);
    machine.simulation.cnc.set_panel_key(Z_PLUS, true);
    machine.run_ms(600);
    machine.twin.set_pin("PC1", false);
    machine.run_ms(300);
    machine.simulation.cnc.set_panel_key(Z_PLUS, false);
    machine.run_ms(800);
    assert!(machine.twin.pulses()[1] > stood[1]);
    machine.press(RESET);
    assert_eq!(machine.alarms(), Vec::<String>::new());
    assert_eq!(machine.linked.state(), LinkState::Ready);
    machine.assert_agrees();
    machine.start_program("O1\nG98 G01 Z-20 F800\nG00 Z0 X3\nM30\n");
    run_to_end(&mut machine);
    assert_eq!(machine.alarms(), Vec::<String>::new());
    machine.assert_agrees();
    let at = machine.simulation.cnc.position_machine();
    assert_eq!(machine.simulation.cnc.run_state(), RunState::Reset);
    assert!(at.z.abs() < 30.0);
}

#[test]
fn reset_first_and_then_off_the_switch_does_as_well() {
    let mut machine = referenced_machine();
    machine.start_program("O1\nG98 G01 Z-20 F250\nM30\n");
    machine.run_ms(2500);
    machine.twin.set_pin("PC1", true);
    machine.run_ms(500);
    machine.simulation.cnc.set_panel_key(Z_MINUS, false);
    machine.run_ms(100);
    assert!(
        machine.alarms()[0].contains("622"),
        "{:?}",
        machine.alarms()
    );
    machine.press(RESET);
    machine.run_ms(300);
    assert_eq!(machine.linked.state(), LinkState::Ready);
    assert!(machine.simulation.cnc.referenced_axes().z);
    machine.press(JOG);
    machine.simulation.cnc.set_panel_key(Z_PLUS, true);
    machine.run_ms(600);
    machine.twin.set_pin("PC1", false);
    machine.run_ms(600);
    machine.simulation.cnc.set_panel_key(Z_PLUS, false);
    machine.run_ms(800);
    assert_eq!(machine.alarms(), Vec::<String>::new());
    assert_eq!(machine.linked.state(), LinkState::Ready);
}

#[test]
fn a_fast_trip_needs_a_new_reference() {
    let mut machine = referenced_machine();
    machine.start_program("O1\nG98 G01 Z-60 F2000\nM30\n");
    machine.run_ms(1500);
    machine.twin.set_pin("PC1", true);
    machine.run_ms(500);
    assert!(
        machine.alarms()[0].contains("622"),
        "{:?}",
        machine.alarms()
    );
    assert!(!machine.simulation.cnc.referenced_axes().z);
    machine.press(RESET);
    machine.press(CYCLE_START);
    assert!(
        machine.alarms()[0].contains("610"),
        "{:?}",
        machine.alarms()
    );
}
