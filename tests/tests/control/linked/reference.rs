//! Nothing runs before the reference return, which the board makes itself.

use gsk_link::{LinkConfig, LinkState};
use gsk_twins::grbl::{GrblSettings, Variant};

use super::SHAFT;
use crate::bench::board::LinkedMachine;
use crate::bench::keys::{JOG, RESET, X_MINUS, X_PLUS, Z_MINUS, Z_PLUS, ZERO};

#[test]
fn without_a_reference_no_program_starts() {
    let mut machine = LinkedMachine::connected(Variant::Grbl);
    assert_eq!(machine.linked.state(), LinkState::Locked);
    machine.load(SHAFT, None);
    machine.start_program();
    machine.run_ms(1000);
    assert_eq!(machine.alarms(), [610]);
    assert_eq!(machine.made_pulses(), [0, 0]);
    assert!(machine.simulation.cnc.is_shown_not_ready());
}

#[test]
fn a_switch_that_never_comes_is_alarm_609() {
    let mut machine = LinkedMachine::connected(Variant::Grbl);
    machine.twin.place_switches([900.0, 900.0]);
    machine.press(ZERO);
    machine.press(X_PLUS);
    assert!(machine.run_until(120_000, |machine| machine.alarms() == [609]));
    let stood = machine.made_pulses();
    machine.press(RESET);
    machine.run_ms(2000);
    assert_eq!(
        (machine.linked.state(), machine.alarms()),
        (LinkState::Locked, vec![])
    );
    assert_eq!(machine.made_pulses(), stood);
}

#[test]
fn reset_ends_a_reference_return() {
    for variant in super::LINES {
        let mut machine = LinkedMachine::connected(variant);
        machine.press(ZERO);
        machine.press(X_PLUS);
        machine.run_ms(1500);
        assert_eq!(machine.linked.state(), LinkState::Homing);
        machine.press(RESET);
        machine.run_ms(2000);
        let stood = machine.made_pulses();
        assert_eq!(
            machine.linked.state(),
            LinkState::Locked,
            "{variant:?} {:?}",
            machine.alarms()
        );
        machine.run_ms(2000);
        assert_eq!(machine.made_pulses(), stood);
        // And again from there.
        machine.press(RESET);
        machine.run_ms(500);
        machine.run_ms(1500);
        machine.return_to_reference();
    }
}

/// The larger boards may seek one switch alone (grblHAL with bit 1 of $22): the other axis has
/// its own key.
#[test]
fn a_board_that_can_returns_each_axis_by_its_key() {
    let mut machine = LinkedMachine::connected(Variant::GrblHal);
    machine.twin.write(b"$22=3\n");
    machine.run_ms(200);
    machine.reconnect();
    machine.run_until(6000, |machine| machine.linked.state() == LinkState::Locked);
    machine.press(RESET);
    machine.run_ms(500);
    check_separate_returns(machine);
    check_separate_returns(LinkedMachine::connected(Variant::FluidNc));
}

/// FluidNC stays locked until all its axes are homed, which the control does not request. It
/// also answers `ok` to a return that it has not made.
#[test]
fn fluidnc_returns_when_it_reports_so() {
    let mut machine = LinkedMachine::connected(Variant::FluidNc);
    machine.twin.press_reset();
    machine.run_ms(4000);
    machine.press(RESET);
    machine.run_until(6000, |machine| machine.alarms() == [603]);
    machine.linked.write_settings();
    machine.run_until(3000, |machine| machine.linked.state() == LinkState::Locked);
    // RESET does not unlock it: X is homed, Z is not, and X is to be moved by hand.
    machine.press(ZERO);
    machine.press(X_PLUS);
    assert!(machine.run_until(40_000, |machine| machine.simulation.cnc.referenced_axes().x));
    machine.run_ms(500);
    let [x, _] = machine.twin.pulses();
    machine.press(JOG);
    machine.hold_key(X_MINUS, 1000);
    machine.run_ms(500);
    assert!(machine.twin.pulses()[0] < x);
    // The position is set, nothing moves.
    machine
        .twin
        .set_config_item("axes/z/homing/cycle", "-1")
        .unwrap();
    let stood = machine.twin.pulses();
    machine.press(ZERO);
    machine.press(Z_PLUS);
    assert!(machine.run_until(5000, |machine| machine.alarms().contains(&609)));
    assert!(!machine.simulation.cnc.referenced_axes().z);
    assert_eq!(machine.twin.pulses(), stood);
}

fn check_separate_returns(mut machine: LinkedMachine) {
    let [_, z] = machine.made_pulses();
    machine.press(ZERO);
    machine.press(X_PLUS);
    assert!(machine.run_until(40_000, |machine| machine.simulation.cnc.referenced_axes().x));
    assert_eq!(machine.made_pulses()[1], z, "Z stands");
    assert_eq!(machine.linked.state(), LinkState::Locked);
    machine.press(Z_PLUS);
    assert!(machine.run_until(40_000, |machine| machine.linked.state() == LinkState::Ready));
    let referenced = machine.simulation.cnc.referenced_axes();
    assert!(referenced.x && referenced.z);
}

/// However a return of both axes ends, neither axis is where it was. A board that moves a
/// single axis and stops early proves nothing.
#[test]
fn an_interrupted_return_leaves_no_reference() {
    type ReturnEnd = fn(&mut LinkedMachine);
    let ends: [(&str, ReturnEnd); 5] = [
        ("RESET", |machine| machine.press(RESET)),
        ("the board is reset", |machine| machine.twin.press_reset()),
        ("the cable is out", |machine| machine.cut_cable()),
        ("emergency stop", |machine| {
            machine.simulation.lathe.set_emergency_button(true);
            machine.run_ms(500);
            machine.simulation.lathe.set_emergency_button(false);
        }),
        ("no switch comes", |machine| {
            machine.twin.place_switches([900.0, 900.0]);
            machine.run_until(120_000, |machine| machine.alarms() == [609]);
        }),
    ];
    let alone = {
        let mut settings = GrblSettings::default();
        settings.set(22, 3.0).unwrap();
        LinkedMachine::for_threading(LinkConfig::default(), settings, &[])
    };
    for ready in [LinkedMachine::referenced(Variant::Grbl), alone] {
        for (name, end) in ends {
            let mut machine = ready.clone();
            machine.press(JOG);
            machine.hold_key(Z_MINUS, 2000);
            machine.run_ms(1000);
            machine.press(ZERO);
            machine.press(X_PLUS);
            assert!(machine.run_until(3000, |machine| machine.linked.state() == LinkState::Homing));
            machine.run_ms(300);
            end(&mut machine);
            machine.run_ms(2500);
            machine.run_until(120_000, |machine| {
                machine.linked.state() != LinkState::Homing
            });
            let referenced = machine.simulation.cnc.referenced_axes();
            assert!(!referenced.x && !referenced.z, "{name}");
            machine.press(RESET);
            machine.run_ms(2500);
            assert_ne!(machine.linked.state(), LinkState::Ready, "{name}");
            assert!(!machine.linked.knows_position(), "{name}");
        }
    }
}

/// Neither lamp is on during the return: both axes move.
#[test]
fn a_return_of_both_axes_takes_both_references_at_once() {
    let mut machine = LinkedMachine::referenced(Variant::Grbl);
    machine.press(JOG);
    machine.hold_key(Z_MINUS, 2000);
    machine.run_ms(1000);
    machine.press(ZERO);
    machine.press(X_PLUS);
    assert!(machine.run_until(3000, |machine| machine.linked.state() == LinkState::Homing));
    machine.run_ms(300);
    assert!(!machine.simulation.cnc.referenced_axes().z);
    assert!(machine.run_until(60_000, |machine| machine.linked.state() == LinkState::Ready));
}
