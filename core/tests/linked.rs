#![allow(clippy::unwrap_used, clippy::panic, reason = "tests fail by panicking")]
//! The whole control with a board in place of its simulated slides, in virtual time:
//! what the kernel commands is what the board makes, and every stop is a defined one.

#[path = "bench/board.rs"]
mod board;

use board::{
    AUTO, CYCLE_START, DRY_RUN, FEED_HOLD, JOG, Machine, RESET, SINGLE_BLOCK, Z_MINUS, Z_PLUS,
};
use gsk_core::machine::link::{LinkState, Note};
use gsk_core::operation::RunState;
use gsk_twins::grbl::{State, Variant};

const SHAFT: &str = include_str!("../../assets/programs/01-stepped-shaft.CNC");
const BUSHING: &str = include_str!("../../assets/programs/02-bushing.CNC");
const PIN: &str = include_str!("../../assets/programs/03-grooved-pin.CNC");
const GROOVE: &str = include_str!("../../assets/programs/O1031.CNC");

#[test]
fn the_samples_end_on_the_pulse_of_the_kernel() {
    for variant in [Variant::Grbl, Variant::GrblHal] {
        for (main, sub) in [(SHAFT, None), (PIN, Some(GROOVE))] {
            let mut machine = Machine::referenced(variant);
            machine.load(main, sub);
            machine.start();
            machine.run_to_end(3_600_000);
            assert_eq!(machine.alarms(), [0_u16; 0]);
            let stood = machine.simulation.cnc.pulses();
            assert_eq!(
                machine.made(),
                [stood.x.0, stood.z.0],
                "{variant:?} {}",
                main.lines().next().unwrap()
            );
        }
    }
}

#[test]
fn what_the_board_cannot_do_is_refused_before_anything_moves() {
    let thread = "O5 (THREAD)\nM03 S300\nG00 X30 Z5\nG92 X20 Z-20 F2\nM30\n";
    let called = "O6\nM98 P5\nM30\n";
    for (text, sub, line) in [
        (BUSHING, None, 8),
        (thread, None, 4),
        (called, Some(thread), 4),
    ] {
        let mut machine = Machine::referenced(Variant::Grbl);
        let stood = machine.made();
        machine.load(text, sub);
        machine.start();
        machine.pass(2000);
        assert_eq!(machine.alarms(), [604], "{text}");
        let alarm = machine.simulation.cnc.alarms()[0].clone();
        assert_eq!(alarm.source.unwrap().line, line, "{alarm}");
        assert_eq!(machine.made(), stood, "nothing moves");
        assert_eq!(machine.simulation.cnc.run_state(), RunState::Reset);
    }
}

#[test]
fn without_a_reference_no_program_starts() {
    let mut machine = Machine::connected(Variant::Grbl);
    assert_eq!(machine.linked.state(), LinkState::Locked);
    machine.load(SHAFT, None);
    machine.start();
    machine.pass(1000);
    assert_eq!(machine.alarms(), [610]);
    assert_eq!(machine.made(), [0, 0]);
    assert!(machine.simulation.cnc.not_ready());
}

/// A short part: rapids, a cut, an arc, spindle and coolant.
const SHORT: &str = "O9\nN10 G50 X60 Z20\nN20 G98 G97 S500 M03\nN30 G00 X40 Z5 M08\n\
    N40 G01 Z-10 F300\nN50 G02 X50 Z-15 R5\nN60 G01 X52\nN70 G04 X0.2\n\
    N80 G00 X60 Z20\nN90 M05\nN95 M09\nN99 M30\n";

/// Numbers that look random and are the same each time.
struct Dice(u64);

impl Dice {
    fn below(&mut self, most: u32) -> u32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        ((self.0 >> 33) % u64::from(most)) as u32
    }
}

/// More rounds with `ROUNDS=200` in the environment.
fn rounds(usual: u32) -> u32 {
    let wanted = std::env::var("ROUNDS").ok();
    wanted.and_then(|text| text.parse().ok()).unwrap_or(usual)
}

#[track_caller]
fn assert_together(machine: &Machine) {
    let stood = machine.simulation.cnc.pulses();
    assert_eq!(machine.made(), [stood.x.0, stood.z.0]);
}

#[test]
fn holds_at_any_time_lose_no_pulse() {
    let ready = Machine::referenced(Variant::Grbl);
    let plain = {
        let mut machine = ready.clone();
        machine.load(SHORT, None);
        machine.start();
        machine.run_to_end(120_000);
        machine.made()
    };
    let mut dice = Dice(7);
    for _ in 0..rounds(6) {
        let mut machine = ready.clone();
        machine.load(SHORT, None);
        machine.start();
        for _ in 0..3 {
            machine.pass(dice.below(3000));
            machine.press(FEED_HOLD);
            assert!(machine.wait(3000, |machine| !machine.linked.is_behind()));
            assert_together(&machine);
            let stood = machine.made();
            machine.pass(500);
            assert_eq!(machine.made(), stood, "held");
            machine.press(CYCLE_START);
        }
        machine.run_to_end(120_000);
        assert_eq!(machine.alarms(), [0_u16; 0]);
        assert_eq!(machine.made(), plain);
        assert_together(&machine);
    }
}

#[test]
fn single_block_stands_between_the_blocks_and_is_checked_there() {
    let mut machine = Machine::referenced(Variant::GrblHal);
    machine.load(SHORT, None);
    machine.press(SINGLE_BLOCK);
    machine.notes.clear();
    machine.start();
    for _ in 0..30 {
        machine.wait(20_000, |machine| {
            machine.simulation.cnc.run_state() != RunState::Run && !machine.linked.is_behind()
        });
        assert_together(&machine);
        if machine.simulation.cnc.run_state() == RunState::Reset {
            break;
        }
        machine.press(CYCLE_START);
    }
    assert_eq!(machine.simulation.cnc.run_state(), RunState::Reset);
    machine.pass(100);
    let agreed = |note: &&Note| matches!(note, Note::Checked { agrees: true, .. });
    // N30, N40, N50, N60, N80 move.
    assert!(machine.notes.iter().filter(agreed).count() >= 5);
    let ended = |note: &Note| {
        matches!(
            note,
            Note::Checked {
                program: Some(_),
                ..
            }
        )
    };
    assert!(machine.notes.iter().any(ended), "{:?}", machine.notes);
}

#[test]
fn a_dry_run_ends_on_the_same_pulse() {
    let mut machine = Machine::referenced(Variant::Grbl);
    machine.load(
        "O5\nG50 X60 Z20\nM03 S300\nG00 X30 Z5\nG92 X20 Z-5 F2\nG00 X60 Z20\nM30\n",
        None,
    );
    machine.press(DRY_RUN);
    machine.start();
    machine.run_to_end(300_000);
    assert_eq!(
        machine.alarms(),
        [0_u16; 0],
        "a thread without its spindle is feed"
    );
    assert_together(&machine);
}

#[test]
fn after_reset_the_control_stands_where_the_board_does() {
    let ready = Machine::referenced(Variant::Grbl);
    let mut dice = Dice(3);
    for _ in 0..rounds(8) {
        let mut machine = ready.clone();
        machine.load(SHORT, None);
        machine.start();
        machine.pass(dice.below(6000));
        machine.press(RESET);
        assert!(machine.wait(3000, |machine| machine.linked.state() == LinkState::Ready));
        assert_eq!(machine.alarms(), [0_u16; 0]);
        assert_together(&machine);
        let (stood, shown) = (machine.made(), machine.simulation.cnc.position_machine());
        machine.pass(1000);
        assert_eq!(machine.made(), stood, "nothing goes on by itself");
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
    let mut machine = Machine::with(Variant::Grbl, 300);
    machine.load(SHORT, None);
    machine.start();
    // In the rapid of N30.
    machine.wait(5000, |machine| {
        machine.simulation.cnc.feed_actual() > 3000.0
    });
    machine.press(RESET);
    machine.pass(2000);
    assert_eq!(machine.linked.state(), LinkState::Locked);
    assert!(!machine.simulation.cnc.referenced().x);
    assert_together(&machine);
    machine.press(AUTO);
    machine.press(CYCLE_START);
    assert_eq!(machine.alarms(), [610]);
}

#[test]
fn the_spindle_turns_before_the_cut_and_stops_with_reset() {
    let mut machine = Machine::referenced(Variant::Grbl);
    machine.load(SHORT, None);
    machine.start();
    machine.watch = Some(|machine| {
        let cuts = machine.simulation.cnc.modal().motion == 1 && machine.twin.state() == State::Run;
        let (way, speed, coolant) = machine.twin.outputs();
        // 500 of 9999 r/min at 10 V.
        assert!(
            !cuts || (way == 3 && coolant && speed > 0.0),
            "{way} {speed} {coolant}"
        );
    });
    machine.wait(20_000, |machine| machine.simulation.cnc.cursor().line == 6);
    machine.watch = None;
    assert_eq!(machine.twin.outputs().0, 3);
    machine.press(RESET);
    machine.pass(1000);
    assert_eq!(
        (machine.twin.outputs().0, machine.twin.outputs().2),
        (5, false)
    );
}

#[test]
fn an_emergency_stop_kills_and_the_reference_is_gone() {
    let mut machine = Machine::referenced(Variant::Grbl);
    machine.load(SHORT, None);
    machine.start();
    machine.pass(1500);
    machine.simulation.lathe.set_emergency_button(true);
    machine.pass(200);
    let stood = machine.made();
    machine.pass(1000);
    assert_eq!(machine.made(), stood);
    assert_eq!(machine.linked.state(), LinkState::Locked);
    assert!(machine.alarms().contains(&207));
    machine.simulation.lathe.set_emergency_button(false);
    machine.press(RESET);
    machine.press(CYCLE_START);
    machine.pass(1000);
    assert_eq!(machine.alarms(), [610]);
    assert_eq!(machine.made(), stood);
}

#[test]
fn a_limit_of_the_board_is_left_by_hand() {
    for variant in [Variant::Grbl, Variant::GrblHal] {
        let mut machine = Machine::connected(variant);
        machine.twin.place_switches([20.0, 2.0]);
        machine.press(JOG);
        machine.hold(Z_PLUS, 15_000);
        assert_eq!(machine.alarms(), [622], "{variant:?}");
        assert_eq!(machine.linked.state(), LinkState::Tripped);
        let stood = machine.made();
        machine.pass(1000);
        assert_eq!(machine.made(), stood);
        machine.press(RESET);
        machine.pass(500);
        machine.hold(Z_MINUS, 3000);
        machine.pass(1000);
        if variant == Variant::Grbl {
            // Letting the switch go is an edge too.
            assert!(machine.alarms().contains(&622));
            machine.press(RESET);
            machine.pass(500);
            machine.hold(Z_MINUS, 3000);
            machine.pass(1000);
        }
        assert_eq!(machine.alarms(), [0_u16; 0], "{variant:?}");
        assert!(machine.made()[1] < stood[1], "{variant:?}");
        assert!(!machine.twin.limits()[1]);
    }
}

#[test]
fn a_cable_out_or_a_reset_at_any_time_is_a_defined_stop() {
    let ready = Machine::referenced(Variant::Grbl);
    let mut dice = Dice(11);
    for round in 0..rounds(10) {
        let mut machine = ready.clone();
        machine.load(SHORT, None);
        machine.start();
        machine.pass(dice.below(5000));
        match round % 2 {
            0 => machine.cut_cable(),
            _ => machine.twin.press_reset(),
        }
        machine.pass(2500);
        assert_ne!(machine.linked.state(), LinkState::Ready, "round {round}");
        assert!(!machine.alarms().is_empty(), "round {round}");
        assert!(!machine.simulation.cnc.referenced().x);
        let stood = machine.twin.pulses();
        machine.pass(1000);
        for key in [RESET, AUTO, CYCLE_START] {
            machine.press(key);
        }
        machine.pass(1000);
        assert_eq!(machine.twin.pulses(), stood, "round {round}: it moves on");
        assert!(!machine.alarms().is_empty(), "round {round}");
    }
}

#[test]
fn a_busy_computer_is_not_noticed_or_is_alarm_612() {
    let ready = Machine::referenced(Variant::Grbl);
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
            machine.start();
            machine.pass(at);
            assert!(machine.simulation.cnc.is_moving());
            machine.pause(pause);
            if noticed {
                machine.pass(2000);
                assert_eq!(machine.alarms(), [612], "{pause} ms at {at}");
                // What was handed over was made, and the count says so.
                assert_eq!(machine.linked.state(), LinkState::Ready);
                assert_together(&machine);
            } else {
                machine.run_to_end(120_000);
                assert_eq!(machine.alarms(), [0_u16; 0], "{pause} ms at {at}");
                assert_together(&machine);
            }
        }
    }
}

/// Jog is a lease: when the computer falls silent the board stands after what it
/// holds.
#[test]
fn a_silent_computer_lets_the_axis_stand_within_the_lookahead() {
    let mut machine = Machine::referenced(Variant::Grbl);
    machine.press(JOG);
    machine.simulation.cnc.set_panel_key(Z_MINUS, true);
    machine.pass(2000);
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
