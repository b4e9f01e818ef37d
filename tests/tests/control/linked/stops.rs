//! Stops that the operator requests, or that a busy computer causes.

use gsk_link::LinkState;
use gsk_twins::grbl::Variant;

use super::{SHORT, assert_counts_agree};
use crate::bench::board::{BenchBoard, LinkedMachine};
use crate::bench::dice::{TestRandom, round_count};
use crate::bench::keys::{AUTO, CYCLE_START, FEED_HOLD, JOG, RESET, Z_MINUS};

#[test]
fn holds_at_any_time_lose_no_pulse() {
    hold_at_any_time(&LinkedMachine::referenced(Variant::Grbl));
    hold_at_any_time(&LinkedMachine::timed_referenced());
}

fn hold_at_any_time<T: BenchBoard>(ready: &LinkedMachine<T>) {
    let plain = {
        let mut machine = ready.clone();
        machine.load(SHORT, None);
        machine.start_program();
        machine.run_to_end(120_000);
        machine.made_pulses()
    };
    let mut dice = TestRandom(7);
    for _ in 0..round_count(6) {
        let mut machine = ready.clone();
        machine.load(SHORT, None);
        machine.start_program();
        for _ in 0..3 {
            machine.run_ms(dice.below(3000));
            machine.press(FEED_HOLD);
            assert!(machine.run_until(3000, |machine| !machine.linked.has_pending_motion()));
            assert_counts_agree(&machine);
            let stood = machine.made_pulses();
            machine.run_ms(500);
            assert_eq!(machine.made_pulses(), stood, "held");
            machine.press(CYCLE_START);
        }
        machine.run_to_end(120_000);
        assert_eq!(machine.alarms(), [0_u16; 0]);
        assert_eq!(machine.made_pulses(), plain);
        assert_counts_agree(&machine);
    }
}

#[test]
fn after_reset_control_and_board_have_the_same_position() {
    reset_at_any_time(&LinkedMachine::referenced(Variant::Grbl));
    reset_at_any_time(&LinkedMachine::timed_referenced());
}

fn reset_at_any_time<T: BenchBoard>(ready: &LinkedMachine<T>) {
    let mut dice = TestRandom(3);
    for _ in 0..round_count(8) {
        let mut machine = ready.clone();
        machine.load(SHORT, None);
        machine.start_program();
        machine.run_ms(dice.below(6000));
        machine.press(RESET);
        assert!(machine.run_until(3000, |machine| machine.linked.state() == LinkState::Ready));
        assert_eq!(machine.alarms(), [0_u16; 0]);
        assert_counts_agree(&machine);
        let (stood, shown) = (
            machine.made_pulses(),
            machine.simulation.cnc.position_machine(),
        );
        machine.run_ms(1000);
        assert_eq!(machine.made_pulses(), stood, "nothing goes on by itself");
        // The coordinates are those of the pulses: 400 and 200 of them in a mm.
        let [x, z] = machine.home_pulses();
        assert!(
            (shown.x - (stood[0] - x) as f64 / 400.0).abs() < 0.003,
            "{shown:?} {stood:?}"
        );
        assert!(
            (shown.z - (stood[1] - z) as f64 / 200.0).abs() < 0.006,
            "{shown:?} {stood:?}"
        );
    }
}

#[test]
fn a_fast_stop_needs_a_new_reference() {
    let mut machine = LinkedMachine::with_flush_speed(Variant::Grbl, 300);
    machine.load(SHORT, None);
    machine.start_program();
    // In the rapid of N30.
    machine.run_until(5000, |machine| {
        machine.simulation.cnc.feed_actual() > 3000.0
    });
    machine.press(RESET);
    machine.run_ms(2000);
    assert_eq!(machine.linked.state(), LinkState::Locked);
    assert!(!machine.simulation.cnc.referenced_axes().x);
    assert_counts_agree(&machine);
    machine.press(AUTO);
    machine.press(CYCLE_START);
    assert_eq!(machine.alarms(), [610]);
}

#[test]
fn an_emergency_stop_kills_and_the_reference_is_gone() {
    let mut machine = LinkedMachine::referenced(Variant::Grbl);
    machine.load(SHORT, None);
    machine.start_program();
    machine.run_ms(1500);
    machine.simulation.lathe.set_emergency_button(true);
    machine.run_ms(200);
    let stood = machine.made_pulses();
    machine.run_ms(1000);
    assert_eq!(machine.made_pulses(), stood);
    assert_eq!(machine.linked.state(), LinkState::Locked);
    assert!(machine.alarms().contains(&207));
    machine.simulation.lathe.set_emergency_button(false);
    machine.press(RESET);
    machine.press(CYCLE_START);
    machine.run_ms(1000);
    assert_eq!(machine.alarms(), [610]);
    assert_eq!(machine.made_pulses(), stood);
}

#[test]
fn a_busy_computer_is_not_noticed_or_is_alarm_612() {
    let ready = LinkedMachine::referenced(Variant::Grbl);
    for (pause, noticed) in [
        (10, false),
        (50, false),
        (90, false),
        (400, true),
        (2000, true),
    ] {
        for at in [2000, 2600] {
            let mut machine = ready.clone();
            machine.load(SHORT, None);
            machine.start_program();
            machine.run_ms(at);
            assert!(machine.simulation.cnc.is_moving());
            machine.pause_host(pause);
            if noticed {
                machine.run_ms(2000);
                assert_eq!(machine.alarms(), [612], "{pause} ms at {at}");
                // The motion sent before was made, and the count confirms it.
                assert_eq!(machine.linked.state(), LinkState::Ready);
                assert_counts_agree(&machine);
            } else {
                machine.run_to_end(120_000);
                assert_eq!(machine.alarms(), [0_u16; 0], "{pause} ms at {at}");
                assert_counts_agree(&machine);
            }
        }
    }
}

/// Jog is a lease: if the computer falls silent, the board stops after the motion it holds.
#[test]
fn a_silent_computer_stops_the_axis_within_the_lookahead() {
    let mut machine = LinkedMachine::referenced(Variant::Grbl);
    machine.press(JOG);
    machine.simulation.cnc.set_panel_key(Z_MINUS, true);
    machine.run_ms(2000);
    let before = machine.twin.now();
    let mut last = (machine.twin.pulses(), before);
    for _ in 0..1000 {
        machine.twin.advance(1_000_000);
        if machine.twin.pulses() != last.0 {
            last = (machine.twin.pulses(), machine.twin.now());
        }
    }
    let latency = (last.1 - before) / 1_000_000;
    assert!((20..=160).contains(&latency), "{latency} ms");
}
