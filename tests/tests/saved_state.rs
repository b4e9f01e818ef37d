//! A machine that is saved in the middle of a program and restored continues alike, in each
//! kind of block that the control executes step by step.

use std::fmt::Write as _;

use gsk_core::setup::Setup;
use gsk_panel::emulator::Emulator;
use gsk_panel::script::{self, Script};
use gsk_tests::saved_state::restore;

/// Programs that keep something between two commands: compensation, cycles, macros, calls.
const PROGRAMS: [&str; 5] = [
    "G50 X40. Z10.;T0101;G42 G01 X30. Z2. F6000;M08 Z-5.;X20. Z-8.;G02 X10. Z-13. R5.;G40 G01 Z-20.;M30;",
    "G50 X40. Z2.;G71 U2. R0.5 F6000;G71 P1 Q2 U0.4 W0.1;N1 G00 X10.;G01 Z-5.;G03 X20. Z-10. R5.;N2 X34. Z-14.;G70 P1 Q2;M30;",
    "G50 X40. Z2.;M03 S600;G74 R0.3;G74 X30. Z-6. P2000 Q3000 F6000;G00 Z2.;G76 P020060 Q200 R0.05;G76 X36. Z-8. P900 Q400 F2.;M30;",
    "G50 X40. Z2.;G73 U3. W1. R3;G73 P1 Q2 U0.4 W0.1 F6000;N1 G00 X20.;G01 Z-5.;N2 X34. Z-9.;G90 X38. Z-6. F6000;X34. R-1.;X30.;M30;",
    "G50 X40. Z2.;M98 P20007;G65 H01 P#201 Q4;N5 G01 U-1. W-1. F6000;G65 H03 P#201 Q#201 R1;G65 H82 P5 Q#201 R0;G04 P100;M30;",
];
const SUBPROGRAM: &str = "O0007;G01 U-2. W-3. F6000;G00 U1. W1.;M99;";
/// Ticks (ms) after cycle start within which a machine is saved.
const SAVED_WITHIN: u64 = 6000;

/// A machine that executes `program` since this moment.
fn start(program: &str) -> Emulator {
    let mut setup = Setup::default();
    // Nose radius compensation is installed, and the nose is not a point.
    setup.memory.parameters.set_bit(2, 1, true).unwrap();
    let mut text = String::from("O0001;");
    write!(text, "{program}").unwrap();
    for text in [SUBPROGRAM, &text] {
        setup.memory.programs.store(text).unwrap();
    }
    let mut emulator = Emulator::new(setup);
    let keys = Script::parse("press AUTO\npress RESET\npress CS\nexpect lamp CS on").unwrap();
    let played = script::run(keys, &mut emulator, &mut |_, _| {
        Ok::<(), core::convert::Infallible>(())
    });
    assert!(played.is_ok(), "{program}: {played:?}");
    emulator
}

#[test]
fn a_machine_restored_in_a_program_continues_alike() {
    for program in PROGRAMS {
        let mut machine = start(program);
        let mut restored = restore(&machine).unwrap();
        let mut tick = 0;
        // The moments fall at other places of a block each time.
        for step in (37..).step_by(61).take_while(|it| *it < SAVED_WITHIN) {
            if tick > SAVED_WITHIN {
                break;
            }
            tick += step;
            machine.run(step);
            restored.run(step);
            assert!(
                restored == machine,
                "{program}: {tick} ms after cycle start"
            );
            restored = restore(&machine).unwrap();
            assert!(restored == machine, "{program}: saved after {tick} ms");
        }
    }
}
