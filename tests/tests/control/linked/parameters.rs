//! Parameters that change after the check at the opening, and boards that change after it.

use gsk_link::LinkState;
use gsk_twins::grbl::Variant;

use crate::bench::board::{BenchBoard, LinkedMachine};
use crate::bench::keys::{JOG, RESET, Z_MINUS, Z_PLUS, ZERO};

/// Alarm 603 names the parameter, and nothing moves.
#[track_caller]
fn check_refusal<T: BenchBoard>(machine: &mut LinkedMachine<T>, number: &str) {
    let expected =
        format!("No.{number} was changed after the board was connected: connect it again");
    assert_eq!(machine.alarms(), [603], "No.{number}");
    let detail = machine.simulation.cnc.alarms()[0].detail_en();
    assert_eq!(detail, expected);
    machine.press(RESET);
    machine.run_ms(300);
    assert_eq!(machine.alarms(), [0_u16; 0]);
}

/// No start of motion works.
fn check_nothing_starts<T: BenchBoard>(ready: &LinkedMachine<T>, number: u16, value: i32) {
    let mut machine = ready.clone();
    machine.press(JOG);
    machine.hold_key(Z_MINUS, 500);
    machine.set_parameter(number, value);
    let name = format!("{number:03}");
    let (stood, at) = (
        machine.twin.pulses(),
        machine.simulation.cnc.position_machine(),
    );
    machine.load("O1\nG98 G01 W-5 F300\nM30\n", None);
    machine.start_program();
    machine.run_ms(500);
    check_refusal(&mut machine, &name);
    machine.press(JOG);
    machine.hold_key(Z_MINUS, 500);
    check_refusal(&mut machine, &name);
    machine.press(ZERO);
    machine.hold_key(Z_PLUS, 1000);
    check_refusal(&mut machine, &name);
    assert_eq!(machine.twin.pulses(), stood, "No.{name}");
    let now = machine.simulation.cnc.position_machine();
    assert!((now - at).length() < 0.001, "No.{name}: {now:?} {at:?}");
}

#[test]
fn another_gear_needs_another_check() {
    let (line, timed) = (
        LinkedMachine::referenced(Variant::Grbl),
        LinkedMachine::timed_referenced(),
    );
    for (number, value) in [(15, 2), (16, 2), (17, 4), (18, 6)] {
        check_nothing_starts(&line, number, value);
        check_nothing_starts(&timed, number, value);
    }
}

#[test]
fn a_line_board_is_checked_again_for_what_is_faster_than_it_allows() {
    let ready = LinkedMachine::referenced(Variant::Grbl);
    // 022 and 023 are 3800 and 7600, 027 is 8000, 024 and 025 are 100 as delivered.
    for (number, value) in [(22, 9000), (23, 9000), (24, 10), (25, 10), (27, 9000)] {
        check_nothing_starts(&ready, number, value);
    }
    // A board with higher limits than the control is no problem.
    let mut machine = ready;
    for (number, value) in [(22, 1000), (23, 1000), (27, 2000), (24, 200)] {
        machine.set_parameter(number, value);
    }
    machine.check_program_runs();
    // A board of timed steps has no rate limits.
    let mut machine = LinkedMachine::timed_referenced();
    machine.set_parameter(24, 10);
    machine.check_program_runs();
}

/// After a new connection the board is compared with the new gear.
#[test]
fn the_settings_of_a_reconnected_board_are_read_again() {
    let mut machine = LinkedMachine::referenced(Variant::Grbl);
    machine.set_parameter(17, 4);
    machine.set_parameter(22, 3000);
    machine.reconnect();
    assert!(machine.run_until(6000, |machine| machine.alarms() == [603]));
    machine.linked.write_settings();
    assert!(machine.run_until(3000, |machine| machine.linked.state() == LinkState::Locked));
    machine.press(RESET);
    machine.run_ms(500);
    machine.return_to_reference();
    machine.check_program_runs();
}

/// A board that restarted may be another one, or have other settings: RESET reads them again.
#[test]
fn a_line_board_that_was_reset_is_checked_again() {
    let mut machine = LinkedMachine::referenced(Variant::Grbl);
    machine.twin.press_emergency(true);
    machine.twin.advance(100_000);
    machine.twin.press_emergency(false);
    machine.run_ms(500);
    assert_eq!(machine.alarms(), [606]);
    // As another board would be.
    machine.twin.write(b"$X\n$100=500\n");
    machine.run_ms(500);
    machine.press(RESET);
    assert!(machine.run_until(3000, |machine| machine.alarms() == [603]));
    assert_eq!(machine.linked.state(), LinkState::Configure);
    machine.check_nothing_starts();
    machine.linked.write_settings();
    assert!(machine.run_until(3000, |machine| machine.linked.state() == LinkState::Locked));
    machine.press(RESET);
    machine.run_ms(500);
    machine.return_to_reference();
    machine.check_program_runs();
}

/// A reset while its settings differ reads them again too.
#[test]
fn a_reset_during_603_can_be_recovered() {
    let mut machine = LinkedMachine::new(Variant::Grbl, 10_000, 5);
    assert!(machine.run_until(6000, |machine| machine.alarms() == [603]));
    machine.twin.press_reset();
    machine.run_ms(2000);
    assert_eq!(machine.linked.state(), LinkState::Fault);
    machine.press(RESET);
    assert!(machine.run_until(3000, |machine| machine.alarms() == [603]));
    assert_eq!(machine.linked.state(), LinkState::Configure);
    machine.linked.write_settings();
    assert!(machine.run_until(3000, |machine| machine.linked.state() == LinkState::Locked));
    machine.press(RESET);
    machine.run_ms(500);
    machine.return_to_reference();
    machine.check_program_runs();
}

/// A lost board that answers again is not accepted as the same one. Only the operator brings
/// it back, and then its identity and settings are read.
fn check_stays_lost<T: BenchBoard>(ready: &LinkedMachine<T>) {
    let mut machine = ready.clone();
    machine.cut_cable();
    machine.run_ms(1500);
    assert_eq!(machine.linked.state(), LinkState::Lost);
    machine.reconnect_cable();
    machine.twin.press_reset();
    machine.run_ms(2000);
    let state = machine.linked.state();
    assert!(matches!(state, LinkState::Lost | LinkState::Fault));
    assert!(machine.alarms().contains(&605));
    machine.simulation.cnc.set_panel_key(RESET, true);
    let settings_read = machine.run_until(500, |machine| {
        machine.linked.needs_reopening() || machine.linked.state() == LinkState::Opening
    });
    assert!(settings_read, "{:?}", machine.linked.state());
}

#[test]
fn a_board_that_restarts_while_it_is_lost_is_checked_again() {
    check_stays_lost(&LinkedMachine::referenced(Variant::Grbl));
    check_stays_lost(&LinkedMachine::timed_referenced());
}
