#![allow(clippy::unwrap_used, clippy::panic, reason = "tests fail by panicking")]
//! The whole control with a board in place of its simulated slides, in virtual time:
//! what the kernel commands is what the board makes, and every stop is a defined one.

#[path = "bench/board.rs"]
mod board;

use board::Machine;
use gsk_core::machine::link::LinkState;
use gsk_core::operation::RunState;
use gsk_twins::grbl::Variant;

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
