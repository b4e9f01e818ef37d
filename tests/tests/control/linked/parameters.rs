//! Parameters that change after the check at the opening, and boards that change after it.

use gsk_link::LinkState;
use gsk_twins::grbl::Variant;

use crate::bench::board::{Board, Machine};
use crate::bench::keys::{JOG, RESET, Z_MINUS, Z_PLUS, ZERO};

/// Alarm 603 names the parameter, and nothing moves.
#[track_caller]
fn is_refused<T: Board>(machine: &mut Machine<T>, number: &str) {
    let expected =
        format!("No.{number} has changed since the board was connected: connect it again");
    assert_eq!(machine.alarms(), [603], "No.{number}");
    let detail = machine.simulation.cnc.alarms()[0].detail_en();
    assert_eq!(detail, expected);
    machine.press(RESET);
    machine.pass(300);
    assert_eq!(machine.alarms(), [0_u16; 0]);
}

/// No start of motion works.
fn nothing_begins<T: Board>(ready: &Machine<T>, number: u16, value: i32) {
    let mut machine = ready.clone();
    machine.press(JOG);
    machine.hold(Z_MINUS, 500);
    machine.set(number, value);
    let name = format!("{number:03}");
    let (stood, at) = (
        machine.twin.pulses(),
        machine.simulation.cnc.position_machine(),
    );
    machine.load("O1\nG98 G01 W-5 F300\nM30\n", None);
    machine.start();
    machine.pass(500);
    is_refused(&mut machine, &name);
    machine.press(JOG);
    machine.hold(Z_MINUS, 500);
    is_refused(&mut machine, &name);
    machine.press(ZERO);
    machine.hold(Z_PLUS, 1000);
    is_refused(&mut machine, &name);
    assert_eq!(machine.twin.pulses(), stood, "No.{name}");
    let now = machine.simulation.cnc.position_machine();
    assert!((now - at).length() < 0.001, "No.{name}: {now:?} {at:?}");
}

#[test]
fn another_gear_needs_another_check() {
    let (line, timed) = (
        Machine::referenced(Variant::Grbl),
        Machine::timed_referenced(),
    );
    for (number, value) in [(15, 2), (16, 2), (17, 4), (18, 6)] {
        nothing_begins(&line, number, value);
        nothing_begins(&timed, number, value);
    }
}

#[test]
fn a_line_board_is_checked_again_for_what_is_faster_than_it_allows() {
    let ready = Machine::referenced(Variant::Grbl);
    // 022 and 023 are 3800 and 7600, 027 is 8000, 024 and 025 are 100 as delivered.
    for (number, value) in [(22, 9000), (23, 9000), (24, 10), (25, 10), (27, 9000)] {
        nothing_begins(&ready, number, value);
    }
    // A board with higher limits than the control is no problem.
    let mut machine = ready;
    for (number, value) in [(22, 1000), (23, 1000), (27, 2000), (24, 200)] {
        machine.set(number, value);
    }
    machine.works();
    // A board of timed steps has no rate limits.
    let mut machine = Machine::timed_referenced();
    machine.set(24, 10);
    machine.works();
}

/// After a new connection the board is compared with the new gear.
#[test]
fn the_board_connected_again_is_asked_for_its_settings() {
    let mut machine = Machine::referenced(Variant::Grbl);
    machine.set(17, 4);
    machine.set(22, 3000);
    machine.reconnect();
    assert!(machine.wait(6000, |machine| machine.alarms() == [603]));
    machine.linked.write_settings();
    assert!(machine.wait(3000, |machine| machine.linked.state() == LinkState::Locked));
    machine.press(RESET);
    machine.pass(500);
    machine.reference();
    machine.works();
}

/// A board that restarted may be another one, or have other settings: RESET reads them again.
#[test]
fn a_line_board_that_was_reset_is_asked_again() {
    let mut machine = Machine::referenced(Variant::Grbl);
    machine.twin.press_emergency(true);
    machine.twin.advance(100_000);
    machine.twin.press_emergency(false);
    machine.pass(500);
    assert_eq!(machine.alarms(), [606]);
    // As another board would be.
    machine.twin.write(b"$X\n$100=500\n");
    machine.pass(500);
    machine.press(RESET);
    assert!(machine.wait(3000, |machine| machine.alarms() == [603]));
    assert_eq!(machine.linked.state(), LinkState::Configure);
    machine.starts_nothing();
    machine.linked.write_settings();
    assert!(machine.wait(3000, |machine| machine.linked.state() == LinkState::Locked));
    machine.press(RESET);
    machine.pass(500);
    machine.reference();
    machine.works();
}

/// A reset while its settings differ reads them again too.
#[test]
fn a_reset_beside_603_is_no_dead_end() {
    let mut machine = Machine::new(Variant::Grbl, 10_000, 5);
    assert!(machine.wait(6000, |machine| machine.alarms() == [603]));
    machine.twin.press_reset();
    machine.pass(2000);
    assert_eq!(machine.linked.state(), LinkState::Fault);
    machine.press(RESET);
    assert!(machine.wait(3000, |machine| machine.alarms() == [603]));
    assert_eq!(machine.linked.state(), LinkState::Configure);
    machine.linked.write_settings();
    assert!(machine.wait(3000, |machine| machine.linked.state() == LinkState::Locked));
    machine.press(RESET);
    machine.pass(500);
    machine.reference();
    machine.works();
}

/// A lost board that answers again is not accepted as the same one. Only the operator brings
/// it back, and then its identity and settings are read.
fn stays_lost<T: Board>(ready: &Machine<T>) {
    let mut machine = ready.clone();
    machine.cut_cable();
    machine.pass(1500);
    assert_eq!(machine.linked.state(), LinkState::Lost);
    machine.mend_cable();
    machine.twin.press_reset();
    machine.pass(2000);
    let state = machine.linked.state();
    assert!(matches!(state, LinkState::Lost | LinkState::Fault));
    assert!(machine.alarms().contains(&605));
    machine.simulation.cnc.set_panel_key(RESET, true);
    let asked = machine.wait(500, |machine| {
        machine.linked.is_to_be_reopened() || machine.linked.state() == LinkState::Opening
    });
    assert!(asked, "{:?}", machine.linked.state());
}

#[test]
fn a_board_that_restarts_while_it_is_lost_is_asked_again() {
    stays_lost(&Machine::referenced(Variant::Grbl));
    stays_lost(&Machine::timed_referenced());
}
