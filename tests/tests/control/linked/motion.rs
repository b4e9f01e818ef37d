//! Operator actions while a board moves the slides.

use core::time::Duration;

use gsk_core::cnc::ControlRequest;
use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::units::Axis;
use gsk_link::LinkState;
use gsk_twins::grbl::Variant;

use super::{SHORT, assert_counts_agree};
use crate::bench::board::{BenchBoard, LinkedMachine};
use crate::bench::keys::{AUTO, CYCLE_START, FEED_HOLD, JOG, MDI, RAPID, RESET, SLOWER, Z_MINUS};

const CUT: &str = "O1\nG50 X60 Z20\nG98 G01 Z-100 F600\nM30\n";

/// Pulses of Z in a time, ms.
fn pulses_in<T: BenchBoard>(machine: &mut LinkedMachine<T>, ms: u32) -> i64 {
    let [_, from] = machine.made_pulses();
    machine.run_ms(ms);
    (machine.made_pulses()[1] - from).abs()
}

fn check_overrides<T: BenchBoard>(ready: &LinkedMachine<T>) {
    let mut machine = ready.clone();
    machine.load(CUT, None);
    machine.start_program();
    machine.run_until(5000, |machine| machine.simulation.cnc.feed_actual() > 590.0);
    machine.run_ms(500);
    // 600 mm/min are 2000 pulses/s of Z.
    let before = pulses_in(&mut machine, 500);
    assert!((985..=1015).contains(&before), "{before}");
    for _ in 0..5 {
        machine.press(SLOWER);
    }
    machine.run_ms(400);
    let after = pulses_in(&mut machine, 500);
    assert!((492..=508).contains(&after), "{after}");
    machine.press(FEED_HOLD);
    machine.run_ms(1000);
    assert_eq!(machine.alarms(), [0_u16; 0]);
    assert_counts_agree(&machine);
}

/// Feed override belongs to the control, and acts after the motion that was already sent.
#[test]
fn the_feed_override_slows_the_board_down() {
    check_overrides(&LinkedMachine::referenced(Variant::Grbl));
    check_overrides(&LinkedMachine::timed_referenced());
}

/// CINP, F212.3: 1 while the board has not made all commanded motion.
#[test]
fn the_ladder_knows_while_the_board_lags() {
    const CINP: BitAddress = BitAddress::new(Area::F, 212, 3);
    let mut machine = LinkedMachine::referenced(Variant::Grbl);
    let is_set = |machine: &mut LinkedMachine<_>| machine.simulation.cnc.plc().memory().bit(CINP);
    assert!(!is_set(&mut machine));
    machine.load(CUT, None);
    machine.start_program();
    machine.run_until(5000, |machine| machine.simulation.cnc.feed_actual() > 590.0);
    machine.run_ms(100);
    assert!(is_set(&mut machine));
    machine.run_to_end(60_000);
    machine.run_ms(100);
    assert!(!is_set(&mut machine));
}

fn check_mode_change<T: BenchBoard>(ready: &LinkedMachine<T>) {
    let mut machine = ready.clone();
    machine.load(CUT, None);
    machine.start_program();
    machine.run_until(5000, |machine| machine.simulation.cnc.feed_actual() > 590.0);
    let from = machine.made_pulses();
    machine.press(JOG);
    assert!(machine.run_until(2000, |machine| !machine.linked.has_pending_motion()));
    assert_counts_agree(&machine);
    assert_eq!(machine.linked.state(), LinkState::Ready);
    assert!(machine.made_pulses()[1] < from[1]);
    let stood = machine.made_pulses();
    machine.run_ms(1000);
    assert_eq!(machine.made_pulses(), stood);
    machine.press(AUTO);
    machine.press(CYCLE_START);
    machine.run_to_end(60_000);
    assert_eq!(machine.alarms(), [0_u16; 0]);
    assert_counts_agree(&machine);
}

#[test]
fn another_mode_in_motion_brakes_with_the_ramp() {
    check_mode_change(&LinkedMachine::referenced(Variant::Grbl));
    check_mode_change(&LinkedMachine::timed_referenced());
}

fn check_mdi_and_hold<T: BenchBoard>(ready: &LinkedMachine<T>) {
    let mut machine = ready.clone();
    machine.press(MDI);
    for word in ["G98", "G01", "W-5", "F300"] {
        let word = ControlRequest::AddMdiWord(word.to_owned());
        machine.simulation.cnc.request(word).unwrap();
    }
    let [_, from] = machine.made_pulses();
    machine.press(CYCLE_START);
    machine.run_ms(1500);
    assert!(machine.run_until(3000, |machine| !machine.linked.has_pending_motion()));
    assert_eq!(machine.made_pulses()[1], from - 1000, "200 pulses a mm");
    assert_counts_agree(&machine);
    assert_eq!(machine.alarms(), [0_u16; 0]);
}

#[test]
fn an_mdi_block_ends_on_the_pulse() {
    check_mdi_and_hold(&LinkedMachine::referenced(Variant::Grbl));
    check_mdi_and_hold(&LinkedMachine::timed_referenced());
}

/// While the position of the slides is unknown, they move no faster than No.033.
fn check_slow_jog<T: BenchBoard>(connected: &LinkedMachine<T>) {
    let mut machine = connected.clone();
    machine.press(JOG);
    machine.press(RAPID);
    machine.simulation.cnc.set_panel_key(Z_MINUS, true);
    machine.run_ms(2000);
    assert_eq!(machine.linked.state(), LinkState::Moving);
    let before = machine.twin.pulses()[1];
    machine.run_ms(1000);
    let rate = machine.simulation.cnc.parameters().zero_low_rate();
    let most = (rate / 60.0 * 200.0).ceil() as i64;
    let way = (machine.twin.pulses()[1] - before).abs();
    assert!((most - 10..=most + 1).contains(&way), "{way} of {most}");
    machine.simulation.cnc.set_panel_key(Z_MINUS, false);
    assert!(machine.run_until(2000, |machine| machine.linked.state() == LinkState::Locked));
    assert!(!machine.simulation.cnc.referenced_axes().get(Axis::Z));
}

#[test]
fn unknown_slides_are_jogged_slowly() {
    check_slow_jog(&LinkedMachine::connected(Variant::Grbl));
    check_slow_jog(&LinkedMachine::timed_connected());
}

/// At rest no motion is sent, and the lookahead limits the motion sent ahead.
fn check_lookahead<T: BenchBoard>(ready: &LinkedMachine<T>, most: Duration) {
    let mut machine = ready.clone();
    machine.run_ms(500);
    let before = machine.linked.traffic().segments;
    machine.run_ms(3000);
    assert_eq!(machine.linked.traffic().segments, before);
    machine.load(SHORT, None);
    machine.start_program();
    while machine.simulation.cnc.run_state() == RunState::Run {
        machine.run_one_ms();
        assert!(
            machine.linked.outstanding() <= most,
            "{:?}",
            machine.linked.outstanding()
        );
    }
}

#[test]
fn the_control_is_ahead_by_no_more_than_the_lookahead() {
    // A segment takes two periods if its first one has no pulse.
    check_lookahead(
        &LinkedMachine::referenced(Variant::Grbl),
        // Its reports come every 20 ms only.
        Duration::from_millis(150 + 10 + 20),
    );
    check_lookahead(
        &LinkedMachine::timed_referenced(),
        Duration::from_millis(140),
    );
}

/// A line board acts at once on some characters anywhere in a line. The link sends none but
/// these, whatever the operator does.
#[test]
fn only_harmless_characters_go_to_a_line_board() {
    let mut machine = LinkedMachine::referenced(Variant::Grbl);
    machine.record_path();
    machine.load(SHORT, None);
    machine.start_program();
    machine.run_ms(1500);
    machine.press(FEED_HOLD);
    machine.press(SLOWER);
    machine.press(CYCLE_START);
    machine.run_ms(500);
    machine.press(RESET);
    machine.run_ms(2000);
    machine.start_program();
    machine.run_ms(3000);
    machine.simulation.lathe.set_emergency_button(true);
    machine.run_ms(2000);
    assert!(machine.sent.len() > 2000);
    for line in machine.sent.split(|byte| *byte == b'\n') {
        let text = line.iter().filter(|byte| !b"?!\x18".contains(byte));
        let text: Vec<u8> = text.copied().collect();
        assert!(text.len() < 70);
        for byte in &text {
            let plain = byte.is_ascii_uppercase() || byte.is_ascii_digit();
            let setting = text.first() == Some(&b'$') && b"$#=".contains(byte);
            assert!(
                plain || setting || b".-".contains(byte),
                "{:?}",
                String::from_utf8_lossy(&text)
            );
        }
    }
}
