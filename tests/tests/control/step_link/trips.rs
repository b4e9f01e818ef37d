//! A limit switch that was hit: the board proves the position, so the reference remains.

use gsk_core::operation::RunState;
use gsk_link::LinkState;

use super::machine::Machine;
use crate::bench::keys::{CYCLE_START, JOG, RESET, Z_MINUS, Z_PLUS};

fn referenced() -> Machine {
    let mut machine = Machine::new();
    machine.return_axes();
    machine
}

fn ends(machine: &mut Machine) {
    let ended = machine.wait(120_000, |machine| {
        machine.simulation.cnc.run_state() != RunState::Run && !machine.linked.is_behind()
    });
    assert!(ended);
}

#[test]
fn a_slow_trip_keeps_the_reference() {
    let mut machine = referenced();
    machine.start("O1\nG98 G01 Z-20 F250\nM30\n");
    machine.pass(2500);
    machine.twin.set_pin("PC1", true);
    machine.pass(300);
    assert_eq!(machine.linked.state(), LinkState::Tripped);
    assert!(
        machine.alarms()[0].contains("622"),
        "{:?}",
        machine.alarms()
    );
    machine.agrees();
    assert!(machine.linked.knows_position());
    let referenced = machine.simulation.cnc.referenced();
    assert!(referenced.x && referenced.z);
    let stood = machine.twin.pulses();
    machine.pass(1000);
    assert_eq!(machine.twin.pulses(), stood);
    // Farther is refused, the other direction is allowed; RESET may come before or after.
    machine.press(JOG);
    machine.press(Z_MINUS);
    machine.pass(500);
    assert_eq!(machine.twin.pulses(), stood);
    machine.simulation.cnc.set_panel_key(Z_PLUS, true);
    machine.pass(600);
    machine.twin.set_pin("PC1", false);
    machine.pass(300);
    machine.simulation.cnc.set_panel_key(Z_PLUS, false);
    machine.pass(800);
    assert!(machine.twin.pulses()[1] > stood[1]);
    machine.press(RESET);
    assert_eq!(machine.alarms(), Vec::<String>::new());
    assert_eq!(machine.linked.state(), LinkState::Ready);
    machine.agrees();
    machine.start("O1\nG98 G01 Z-20 F800\nG00 Z0 X3\nM30\n");
    ends(&mut machine);
    assert_eq!(machine.alarms(), Vec::<String>::new());
    machine.agrees();
    let at = machine.simulation.cnc.position_machine();
    assert_eq!(machine.simulation.cnc.run_state(), RunState::Reset);
    assert!(at.z.abs() < 30.0);
}

#[test]
fn reset_first_and_then_off_the_switch_does_as_well() {
    let mut machine = referenced();
    machine.start("O1\nG98 G01 Z-20 F250\nM30\n");
    machine.pass(2500);
    machine.twin.set_pin("PC1", true);
    machine.pass(500);
    machine.simulation.cnc.set_panel_key(Z_MINUS, false);
    machine.pass(100);
    assert!(
        machine.alarms()[0].contains("622"),
        "{:?}",
        machine.alarms()
    );
    machine.press(RESET);
    machine.pass(300);
    assert_eq!(machine.linked.state(), LinkState::Ready);
    assert!(machine.simulation.cnc.referenced().z);
    machine.press(JOG);
    machine.simulation.cnc.set_panel_key(Z_PLUS, true);
    machine.pass(600);
    machine.twin.set_pin("PC1", false);
    machine.pass(600);
    machine.simulation.cnc.set_panel_key(Z_PLUS, false);
    machine.pass(800);
    assert_eq!(machine.alarms(), Vec::<String>::new());
    assert_eq!(machine.linked.state(), LinkState::Ready);
}

#[test]
fn a_fast_trip_needs_a_new_reference() {
    let mut machine = referenced();
    machine.start("O1\nG98 G01 Z-60 F2000\nM30\n");
    machine.pass(1500);
    machine.twin.set_pin("PC1", true);
    machine.pass(500);
    assert!(
        machine.alarms()[0].contains("622"),
        "{:?}",
        machine.alarms()
    );
    assert!(!machine.simulation.cnc.referenced().z);
    machine.press(RESET);
    machine.press(CYCLE_START);
    assert!(
        machine.alarms()[0].contains("610"),
        "{:?}",
        machine.alarms()
    );
}
