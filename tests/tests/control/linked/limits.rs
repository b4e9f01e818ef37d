//! An operated limit switch: no key leads farther into it, whatever happened since. If its end
//! is unknown, the axis moves in short pieces.

use gsk_core::operation::RunState;
use gsk_core::plc::address::BitAddress;
use gsk_link::{LinkConfig, LinkState};
use gsk_twins::grbl::{GrblSettings, GrblTwin, Variant};

use crate::bench::board::{BenchBoard, LinkedMachine};
use crate::bench::keys::{JOG, RESET, X_PLUS, Z_MINUS, Z_PLUS, ZERO};

/// A millimetre of Z, pulses.
const MM: i64 = 200;

/// Z- was jogged into its limit switch, which stays operated; the key is released.
fn machine_on_limit<T: BenchBoard>(ready: &LinkedMachine<T>) -> LinkedMachine<T> {
    let mut machine = ready.clone();
    machine.press(JOG);
    machine.simulation.cnc.set_panel_key(Z_MINUS, true);
    machine.run_ms(800);
    machine.twin.press_limit(true);
    machine.run_ms(500);
    machine.simulation.cnc.set_panel_key(Z_MINUS, false);
    machine.run_ms(500);
    assert_eq!(machine.alarms(), [622]);
    assert_eq!(machine.linked.state(), LinkState::Tripped);
    machine
}

/// Presses RESET until the alarm is cleared.
fn clear_limit<T: BenchBoard>(machine: &mut LinkedMachine<T>) {
    for _ in 0..2 {
        machine.press(RESET);
        machine.run_ms(4000);
    }
    machine.press(JOG);
    assert_eq!(machine.alarms(), [0_u16; 0]);
}

/// Pulses of Z that a key makes in a time, ms.
fn jogged_pulses<T: BenchBoard>(machine: &mut LinkedMachine<T>, key: BitAddress, ms: u32) -> i64 {
    let before = machine.twin.pulses()[1];
    machine.hold_key(key, ms);
    machine.run_ms(1500);
    machine.twin.pulses()[1] - before
}

/// Not farther, with the number that names the switch; back, and off it.
#[track_caller]
fn check_one_direction<T: BenchBoard>(machine: &mut LinkedMachine<T>) {
    assert_eq!(jogged_pulses(machine, Z_MINUS, 1500), 0);
    assert_eq!(machine.alarms(), [622]);
    clear_limit(machine);
    assert!(
        jogged_pulses(machine, Z_PLUS, 1500) > MM,
        "{:?}",
        machine.alarms()
    );
    assert_eq!(machine.alarms(), [0_u16; 0]);
    assert_eq!(jogged_pulses(machine, Z_MINUS, 300), 0, "still operated");
}

fn check_same_key<T: BenchBoard>(ready: &LinkedMachine<T>) {
    let mut machine = machine_on_limit(ready);
    clear_limit(&mut machine);
    check_one_direction(&mut machine);
}

#[test]
fn after_reset_the_same_key_leads_no_farther_into_the_switch() {
    for variant in super::LINES {
        check_same_key(&LinkedMachine::referenced(variant));
    }
    check_same_key(&LinkedMachine::timed_referenced());
}

#[test]
fn the_same_key_leads_no_farther_after_an_emergency_stop() {
    fn check_emergency_stop<T: BenchBoard>(ready: &LinkedMachine<T>) {
        let mut machine = machine_on_limit(ready);
        machine.press(RESET);
        machine.run_ms(500);
        machine.simulation.lathe.set_emergency_button(true);
        machine.run_ms(500);
        machine.simulation.lathe.set_emergency_button(false);
        machine.run_ms(300);
        clear_limit(&mut machine);
        check_one_direction(&mut machine);
    }
    check_emergency_stop(&LinkedMachine::referenced(Variant::Grbl));
    check_emergency_stop(&LinkedMachine::timed_referenced());
}

#[test]
fn the_same_key_leads_no_farther_after_a_reset_of_the_board() {
    let mut machine = machine_on_limit(&LinkedMachine::timed_referenced());
    machine.twin.press_reset();
    machine.run_ms(2500);
    clear_limit(&mut machine);
    check_one_direction(&mut machine);
    // A line board is silent while it starts, and after a new connection the end of the switch
    // is unknown.
    let mut machine = machine_on_limit(&LinkedMachine::referenced(Variant::Grbl));
    machine.twin.press_reset();
    machine.run_ms(2500);
    machine.reconnect();
    machine.run_until(8000, |machine| machine.linked.state() == LinkState::Locked);
    clear_limit(&mut machine);
    assert!((-MM..0).contains(&jogged_pulses(&mut machine, Z_MINUS, 3000)));
    assert_eq!(machine.alarms(), [622]);
}

/// On a switch since power-on: each RESET allows a millimetre, in either direction.
#[test]
fn on_a_switch_of_an_unknown_end_it_moves_a_millimetre_at_a_time() {
    fn check_pieces<T: BenchBoard>(machine: &mut LinkedMachine<T>) {
        machine.press(JOG);
        for key in [Z_MINUS, Z_PLUS, Z_PLUS] {
            let went = jogged_pulses(machine, key, 3000).abs();
            assert!((1..=MM).contains(&went), "{went}");
            assert_eq!(machine.alarms(), [622]);
            assert_eq!(jogged_pulses(machine, key, 1000), 0);
            clear_limit(machine);
        }
        let [x, _] = machine.twin.pulses();
        machine.hold_key(X_PLUS, 1500);
        machine.run_ms(1000);
        assert!(machine.twin.pulses()[0] > x, "X has no switch to mind");
    }
    // A switch that was held since before power-on.
    let mut machine = LinkedMachine::new(Variant::Grbl, 10_000, 5);
    machine.twin.press_limit(true);
    check_pieces(&mut machine.open());
    let mut machine = LinkedMachine::timed_unlocked(10_000);
    machine.twin.press_limit(true);
    machine.run_until(6000, |machine| machine.linked.state() == LinkState::Locked);
    machine.press(RESET);
    machine.run_ms(500);
    check_pieces(&mut machine);
}

/// Off its switch the axis is stopped by the next one, even if it did not stop in between.
#[test]
fn a_released_switch_counts_again_in_motion() {
    let mut machine = LinkedMachine::timed_referenced();
    machine.press(JOG);
    machine.hold_key(Z_MINUS, 3000);
    let mut machine = machine_on_limit(&machine);
    clear_limit(&mut machine);
    machine.simulation.cnc.set_panel_key(Z_PLUS, true);
    machine.run_ms(300);
    machine.twin.press_limit(false);
    machine.run_ms(1200);
    let met = machine.twin.pulses()[1];
    assert!(machine.linked.has_pending_motion());
    machine.twin.press_limit(true);
    machine.run_ms(1000);
    machine.simulation.cnc.set_panel_key(Z_PLUS, false);
    assert_eq!(machine.alarms(), [622]);
    let farther = machine.twin.pulses()[1] - met;
    assert!((0..MM / 10).contains(&farther), "{farther}");
}

/// Grbl would mistake the switch of the far end for the one it seeks, and pull off it
/// outwards.
#[test]
fn a_return_from_the_switch_of_the_other_end_is_refused() {
    let mut machine = machine_on_limit(&LinkedMachine::referenced(Variant::Grbl));
    clear_limit(&mut machine);
    let stood = machine.twin.pulses();
    machine.press(ZERO);
    machine.press(Z_PLUS);
    machine.run_ms(3000);
    assert_eq!(machine.alarms(), [609]);
    assert_eq!(machine.twin.pulses(), stood);
}

/// Method A for X, a switch for Z: Grbl has one homing command for both.
#[test]
fn grbl_does_not_seek_a_switch_that_014_excludes() {
    let config = LinkConfig {
        flush_keep_speed: 10_000,
        ..LinkConfig::default()
    };
    let twin = GrblTwin::new(Variant::Grbl, GrblSettings::default());
    let mut machine = LinkedMachine::with_wiring(twin, config, &[(17, 5), (18, 5), (14, 2)]).open();
    machine.twin.place_switches([900.0, 40.0]);
    let stood = machine.twin.pulses();
    machine.press(ZERO);
    machine.press(Z_PLUS);
    machine.run_ms(3000);
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
    let mut machine = LinkedMachine::with_wiring(twin, LinkConfig::default(), &changes).open();
    machine.twin.place_switches([900.0, 40.0]);
    let [x, _] = machine.twin.pulses();
    machine.press(ZERO);
    machine.press(Z_PLUS);
    assert!(machine.run_until(60_000, |machine| machine.simulation.cnc.referenced_axes().z));
    assert_eq!(machine.twin.pulses()[0], x);
}

/// The board names the switch up to a second after it has stopped.
fn check_last_move<T: BenchBoard>(ready: &LinkedMachine<T>) {
    let mut machine = ready.clone();
    let parts = machine.simulation.cnc.counters().parts;
    machine.load("O1\nG50 X60 Z20\nG98 G01 Z18 F600\nZ-22\nM30\n", None);
    machine.start_program();
    let is_under_way = |machine: &LinkedMachine<T>| {
        let cnc = &machine.simulation.cnc;
        cnc.cursor().line == 4 && cnc.position_absolute().z < 10.0
    };
    assert!(machine.run_until(60_000, is_under_way));
    machine.twin.press_limit(true);
    machine.run_ms(6000);
    assert_eq!(machine.alarms(), [622]);
    assert_eq!(
        machine.simulation.cnc.counters().parts,
        parts,
        "M30 is not reached"
    );
    assert_ne!(machine.simulation.cnc.run_state(), RunState::Run);
}

#[test]
fn a_limit_in_the_last_move_does_not_end_the_program_well() {
    for variant in super::LINES {
        check_last_move(&LinkedMachine::referenced(variant));
    }
    check_last_move(&LinkedMachine::timed_referenced());
}
