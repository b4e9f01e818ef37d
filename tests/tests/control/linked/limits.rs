//! An operated limit switch: no key leads farther into it, whatever happened since. If its end
//! is unknown, the axis moves in short pieces.

use gsk_core::plc::address::BitAddress;
use gsk_link::{LinkConfig, LinkState};
use gsk_twins::grbl::{GrblSettings, GrblTwin, Variant};

use crate::bench::board::{Board, Machine};
use crate::bench::keys::{JOG, RESET, X_PLUS, Z_MINUS, Z_PLUS, ZERO};

/// A millimetre of Z, pulses.
const MM: i64 = 200;

/// Z- was jogged into its limit switch, which stays operated; the key is released.
fn tripped<T: Board>(ready: &Machine<T>) -> Machine<T> {
    let mut machine = ready.clone();
    machine.press(JOG);
    machine.simulation.cnc.set_panel_key(Z_MINUS, true);
    machine.pass(800);
    machine.twin.press_limit(true);
    machine.pass(500);
    machine.simulation.cnc.set_panel_key(Z_MINUS, false);
    machine.pass(500);
    assert_eq!(machine.alarms(), [622]);
    assert_eq!(machine.linked.state(), LinkState::Tripped);
    machine
}

/// Presses RESET until the alarm is cleared.
fn cleared<T: Board>(machine: &mut Machine<T>) {
    for _ in 0..2 {
        machine.press(RESET);
        machine.pass(4000);
    }
    machine.press(JOG);
    assert_eq!(machine.alarms(), [0_u16; 0]);
}

/// Pulses of Z that a key makes in a time, ms.
fn goes<T: Board>(machine: &mut Machine<T>, key: BitAddress, ms: u32) -> i64 {
    let before = machine.twin.pulses()[1];
    machine.hold(key, ms);
    machine.pass(1500);
    machine.twin.pulses()[1] - before
}

/// Not farther, with the number that names the switch; back, and off it.
#[track_caller]
fn leaves_one_way_only<T: Board>(machine: &mut Machine<T>) {
    assert_eq!(goes(machine, Z_MINUS, 1500), 0);
    assert_eq!(machine.alarms(), [622]);
    cleared(machine);
    assert!(goes(machine, Z_PLUS, 1500) > MM, "{:?}", machine.alarms());
    assert_eq!(machine.alarms(), [0_u16; 0]);
    assert_eq!(goes(machine, Z_MINUS, 300), 0, "still operated");
}

fn the_same_key_again<T: Board>(ready: &Machine<T>) {
    let mut machine = tripped(ready);
    cleared(&mut machine);
    leaves_one_way_only(&mut machine);
}

#[test]
fn after_reset_the_same_key_leads_no_farther_into_the_switch() {
    for variant in super::LINES {
        the_same_key_again(&Machine::referenced(variant));
    }
    the_same_key_again(&Machine::timed_referenced());
}

#[test]
fn nor_after_an_emergency_stop() {
    fn stopped<T: Board>(ready: &Machine<T>) {
        let mut machine = tripped(ready);
        machine.press(RESET);
        machine.pass(500);
        machine.simulation.lathe.set_emergency_button(true);
        machine.pass(500);
        machine.simulation.lathe.set_emergency_button(false);
        machine.pass(300);
        cleared(&mut machine);
        leaves_one_way_only(&mut machine);
    }
    stopped(&Machine::referenced(Variant::Grbl));
    stopped(&Machine::timed_referenced());
}

#[test]
fn nor_after_a_reset_of_the_board() {
    let mut machine = tripped(&Machine::timed_referenced());
    machine.twin.press_reset();
    machine.pass(2500);
    cleared(&mut machine);
    leaves_one_way_only(&mut machine);
    // A line board is silent while it starts, and after a new connection the end of the switch
    // is unknown.
    let mut machine = tripped(&Machine::referenced(Variant::Grbl));
    machine.twin.press_reset();
    machine.pass(2500);
    machine.reconnect();
    machine.wait(8000, |machine| machine.linked.state() == LinkState::Locked);
    cleared(&mut machine);
    assert!((-MM..0).contains(&goes(&mut machine, Z_MINUS, 3000)));
    assert_eq!(machine.alarms(), [622]);
}

/// On a switch since power-on: each RESET allows a millimetre, in either direction.
#[test]
fn upon_a_switch_of_an_unknown_end_it_goes_a_millimetre_at_a_time() {
    fn pieces<T: Board>(machine: &mut Machine<T>) {
        machine.press(JOG);
        for key in [Z_MINUS, Z_PLUS, Z_PLUS] {
            let went = goes(machine, key, 3000).abs();
            assert!((1..=MM).contains(&went), "{went}");
            assert_eq!(machine.alarms(), [622]);
            assert_eq!(goes(machine, key, 1000), 0);
            cleared(machine);
        }
        let [x, _] = machine.twin.pulses();
        machine.hold(X_PLUS, 1500);
        machine.pass(1000);
        assert!(machine.twin.pulses()[0] > x, "X has no switch to mind");
    }
    // A switch that was held since before power-on.
    let mut machine = Machine::new(Variant::Grbl, 10_000, 5);
    machine.twin.press_limit(true);
    pieces(&mut machine.open());
    let mut machine = Machine::timed(10_000);
    machine.twin.press_limit(true);
    machine.wait(6000, |machine| machine.linked.state() == LinkState::Locked);
    machine.press(RESET);
    machine.pass(500);
    pieces(&mut machine);
}

/// Off its switch the axis is stopped by the next one, even if it did not stop in between.
#[test]
fn a_switch_that_was_left_behind_counts_again_in_motion() {
    let mut machine = Machine::timed_referenced();
    machine.press(JOG);
    machine.hold(Z_MINUS, 3000);
    let mut machine = tripped(&machine);
    cleared(&mut machine);
    machine.simulation.cnc.set_panel_key(Z_PLUS, true);
    machine.pass(300);
    machine.twin.press_limit(false);
    machine.pass(1200);
    let met = machine.twin.pulses()[1];
    assert!(machine.linked.is_behind());
    machine.twin.press_limit(true);
    machine.pass(1000);
    machine.simulation.cnc.set_panel_key(Z_PLUS, false);
    assert_eq!(machine.alarms(), [622]);
    let farther = machine.twin.pulses()[1] - met;
    assert!((0..MM / 10).contains(&farther), "{farther}");
}

/// Grbl would mistake the switch of the far end for the one it seeks, and pull off it
/// outwards.
#[test]
fn a_return_from_the_switch_of_the_other_end_is_refused() {
    let mut machine = tripped(&Machine::referenced(Variant::Grbl));
    cleared(&mut machine);
    let stood = machine.twin.pulses();
    machine.press(ZERO);
    machine.press(Z_PLUS);
    machine.pass(3000);
    assert_eq!(machine.alarms(), [609]);
    assert_eq!(machine.twin.pulses(), stood);
}

/// Method A for X, a switch for Z: Grbl has one homing command for both.
#[test]
fn grbl_does_not_seek_a_switch_that_014_says_is_not_there() {
    let config = LinkConfig {
        flush_keep_speed: 10_000,
        ..LinkConfig::default()
    };
    let twin = GrblTwin::new(Variant::Grbl, GrblSettings::default());
    let mut machine = Machine::wired(twin, config, &[(17, 5), (18, 5), (14, 2)]).open();
    machine.twin.place_switches([900.0, 40.0]);
    let stood = machine.twin.pulses();
    machine.press(ZERO);
    machine.press(Z_PLUS);
    machine.pass(3000);
    assert_eq!(machine.alarms(), [609]);
    let text = machine.simulation.cnc.alarms()[0].to_string();
    assert!(text.contains("014.0"), "{text}");
    assert_eq!(machine.twin.pulses(), stood);
}

/// A board that can home single axes seeks that of Z alone.
#[test]
fn a_board_that_seeks_single_switches_needs_that_of_its_axis_only() {
    let mut settings = GrblSettings::default();
    settings.set(22, 3.0).unwrap();
    let twin = GrblTwin::new(Variant::GrblHal, settings);
    let changes = [(17, 5), (18, 5), (14, 2)];
    let mut machine = Machine::wired(twin, LinkConfig::default(), &changes).open();
    machine.twin.place_switches([900.0, 40.0]);
    let [x, _] = machine.twin.pulses();
    machine.press(ZERO);
    machine.press(Z_PLUS);
    assert!(machine.wait(60_000, |machine| machine.simulation.cnc.referenced().z));
    assert_eq!(machine.twin.pulses()[0], x);
}
