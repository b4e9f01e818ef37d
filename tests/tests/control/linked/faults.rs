//! Faults of cables, boards, bytes and power, and obstacles.

use gsk_core::operation::RunState;
use gsk_link::LinkState;
use gsk_twins::grbl::Variant;
use gsk_twins::wire::Damage;

use super::{SHORT, assert_counts_agree};
use crate::bench::board::LinkedMachine;
use crate::bench::dice::{TestRandom, round_count};
use crate::bench::keys::{AUTO, CYCLE_START, JOG, RESET, Z_MINUS, Z_PLUS};

#[test]
fn a_limit_of_the_board_is_left_by_hand() {
    for variant in super::LINES {
        let mut machine = LinkedMachine::connected(variant);
        machine.twin.place_switches([20.0, 2.0]);
        machine.press(JOG);
        machine.hold_key(Z_PLUS, 15_000);
        assert_eq!(machine.alarms(), [622], "{variant:?}");
        assert_eq!(machine.linked.state(), LinkState::Tripped);
        let stood = machine.made_pulses();
        machine.run_ms(1000);
        assert_eq!(machine.made_pulses(), stood);
        machine.press(RESET);
        machine.run_ms(500);
        machine.hold_key(Z_MINUS, 3000);
        machine.run_ms(1000);
        if variant == Variant::Grbl {
            // Releasing the switch is an edge too.
            assert!(machine.alarms().contains(&622));
            machine.press(RESET);
            machine.run_ms(500);
            machine.hold_key(Z_MINUS, 3000);
            machine.run_ms(1000);
        }
        assert_eq!(machine.alarms(), [0_u16; 0], "{variant:?}");
        assert!(machine.made_pulses()[1] < stood[1], "{variant:?}");
        assert!(!machine.twin.limits()[1]);
    }
}

#[test]
fn a_cable_out_or_a_reset_at_any_time_is_a_defined_stop() {
    let ready = LinkedMachine::referenced(Variant::Grbl);
    let mut dice = TestRandom(11);
    for round in 0..round_count(10) {
        let mut machine = ready.clone();
        machine.load(SHORT, None);
        machine.start_program();
        machine.run_ms(dice.below(5000));
        match round % 2 {
            0 => machine.cut_cable(),
            _ => machine.twin.press_reset(),
        }
        machine.run_ms(2500);
        assert_ne!(machine.linked.state(), LinkState::Ready, "round {round}");
        assert!(!machine.alarms().is_empty(), "round {round}");
        assert!(!machine.simulation.cnc.referenced_axes().x);
        let stood = machine.twin.pulses();
        machine.run_ms(1000);
        for key in [RESET, AUTO, CYCLE_START] {
            machine.press(key);
        }
        machine.run_ms(1000);
        assert_eq!(machine.twin.pulses(), stood, "round {round}: it moves on");
        assert!(!machine.alarms().is_empty(), "round {round}");
    }
}

/// With any damage to a byte, the part is made to the pulse, or the machine stops with an
/// alarm and nothing moves any more.
#[test]
fn a_damaged_byte_at_any_place_ends_known_or_stopped() {
    let ready = LinkedMachine::referenced(Variant::Grbl);
    let clean = {
        let mut machine = ready.clone();
        machine.load(SHORT, None);
        machine.start_program();
        machine.run_to_end(120_000);
        machine
    };
    let mut dice = TestRandom(5);
    let (mut made, mut stopped) = (0, 0);
    for round in 0..round_count(16) {
        let mut machine = ready.clone();
        let damage = [
            Damage::Lost,
            Damage::Changed(1 << dice.below(8)),
            Damage::Doubled,
            Damage::Cut,
        ][dice.below(4) as usize];
        let to_board = dice.below(2) == 0;
        let wires = |machine: &LinkedMachine| {
            let twin = &machine.twin;
            if to_board {
                twin.to_board.sent_count()
            } else {
                twin.to_host.sent_count()
            }
        };
        let (from, to) = (wires(&machine), wires(&clean));
        let byte = from + u64::from(dice.below((to - from) as u32));
        if to_board {
            machine.twin.to_board.damage(byte, damage);
        } else {
            machine.twin.to_host.damage(byte, damage);
        }
        machine.load(SHORT, None);
        machine.start_program();
        let over = machine.run_until(60_000, |machine| {
            let idle = machine.simulation.cnc.run_state() == RunState::Reset;
            !machine.alarms().is_empty() || (idle && !machine.linked.has_pending_motion())
        });
        let place = format!("{round}: {damage:?} at {byte}, to the board: {to_board}");
        assert!(over, "{place}: it hangs");
        machine.run_ms(3000);
        if machine.alarms().is_empty() {
            assert_eq!(machine.made_pulses(), clean.made_pulses(), "{place}");
            assert_counts_agree(&machine);
            made += 1;
        } else {
            stopped += 1;
        }
        let stood = machine.twin.pulses();
        machine.press(RESET);
        machine.run_ms(1500);
        assert_eq!(machine.twin.pulses(), stood, "{place}: it moves on");
        if machine.linked.state() == LinkState::Ready {
            assert_counts_agree(&machine);
        }
    }
    assert!(made > 0 && stopped > 0, "{made} {stopped}");
}

#[test]
fn without_power_the_board_is_still_and_forgets() {
    let mut machine = LinkedMachine::referenced(Variant::Grbl);
    machine.load(SHORT, None);
    machine.start_program();
    machine.run_ms(2600);
    machine.simulation.power_cycle();
    machine.run_ms(3000);
    assert_eq!(
        machine.linked.state(),
        LinkState::Locked,
        "{:?}",
        machine.alarms()
    );
    assert!(!machine.simulation.cnc.referenced_axes().z);
    let stood = machine.twin.pulses();
    machine.press(AUTO);
    machine.press(CYCLE_START);
    machine.run_ms(1000);
    assert_eq!(machine.alarms(), [610]);
    assert_eq!(machine.twin.pulses(), stood);
    assert_eq!(machine.twin.outputs().0, 5);
}

#[test]
fn the_emergency_stop_of_the_board_is_that_of_the_control() {
    for variant in super::LINES {
        let mut machine = LinkedMachine::referenced(variant);
        machine.load(SHORT, None);
        machine.start_program();
        machine.run_ms(1500);
        machine.twin.pins.emergency = true;
        machine.run_ms(1000);
        assert!(
            machine.alarms().contains(&207),
            "{variant:?} {:?}",
            machine.alarms()
        );
        assert_ne!(machine.linked.state(), LinkState::Ready);
        let stood = machine.twin.pulses();
        machine.press(RESET);
        assert!(machine.alarms().contains(&207), "as long as it is pressed");
        machine.twin.pins.emergency = false;
        machine.run_ms(1000);
        machine.press(RESET);
        machine.run_ms(1500);
        assert_eq!(
            machine.linked.state(),
            LinkState::Locked,
            "{variant:?} {:?}",
            machine.alarms()
        );
        assert_eq!(machine.alarms(), [0_u16; 0], "{variant:?}");
        assert_eq!(machine.twin.pulses(), stood);
    }
}

#[test]
fn reset_requests_a_lost_board_and_nothing_moves_with_it() {
    let mut machine = LinkedMachine::referenced(Variant::Grbl);
    machine.load(SHORT, None);
    machine.start_program();
    machine.run_ms(2000);
    machine.cut_cable();
    machine.run_ms(2000);
    assert_eq!(machine.linked.state(), LinkState::Lost);
    assert_eq!(machine.alarms(), [605], "and nothing about late motion");
    machine.reconnect_cable();
    machine.run_ms(1000);
    assert_eq!(machine.linked.state(), LinkState::Lost, "nobody asked");
    let stood = machine.twin.pulses();
    machine.press(RESET);
    assert!(machine.linked.needs_reopening());
    machine.reconnect();
    machine.run_until(6000, |machine| machine.linked.state() == LinkState::Locked);
    machine.press(AUTO);
    machine.press(CYCLE_START);
    machine.run_ms(1000);
    assert!(machine.alarms().contains(&610) || machine.alarms().contains(&605));
    machine.press(RESET);
    machine.run_ms(1000);
    assert_eq!(machine.twin.pulses(), stood);
    assert_eq!(machine.alarms(), [0_u16; 0]);
}
