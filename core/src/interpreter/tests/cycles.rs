//! G90 and G94.

use super::InterpreterBench;
use crate::command::MotionCode;

#[test]
fn turning_cycle_has_four_stops() {
    let trace = InterpreterBench::at(130.0, 80.0).trace("G90 X120 Z30 R-30 F50;");
    assert_eq!(
        trace[..4],
        [
            "1: rapid X60 Z80 |",
            "1: line X120 Z30 F50 |",
            "1: line X130 Z30 F50 |",
            "1: rapid X130 Z80 |",
        ]
    );
}

#[test]
fn facing_cycle_has_four_stops() {
    let trace = InterpreterBench::at(120.0, 0.0).trace("G94 X60 Z-30 R-50 F50;");
    assert_eq!(
        trace[..4],
        [
            "1: rapid X120 Z-80 |",
            "1: line X60 Z-30 F50 |",
            "1: line X60 Z0 F50 |",
            "1: rapid X120 Z0 |",
        ]
    );
}

#[test]
fn words_are_kept_and_empty_blocks_repeat() {
    let trace = InterpreterBench::at(130.0, 5.0)
        .trace("G90 U-10 W-35 F50;\nX110;\nM08;\nN40;\n;\nF30;\nG04 P5;\nG90;\n");
    let count = |line: &str| trace.iter().filter(|text| text.starts_with(line)).count();
    assert_eq!(trace[1], "1: line X120 Z-30 F50 |");
    assert_eq!(trace[5], "2: line X110 Z-30 F50 |");
    assert_eq!(
        [
            count("3:"),
            count("4:"),
            count("5:"),
            count("6:"),
            count("7:"),
            count("8: line")
        ],
        [1, 4, 4, 1, 1, 2]
    );
}

#[test]
fn the_taper_is_kept_over_a_new_code() {
    let trace =
        InterpreterBench::at(130.0, 5.0).trace("G90 X120 Z-30 R-2 F50;\nG90 X110 Z-30;\nR-3;\n");
    assert_eq!(trace[0], "1: rapid X116 Z5 |");
    assert_eq!(trace[4], "2: rapid X106 Z5 |");
    assert_eq!(trace[8], "3: rapid X104 Z5 |");
}

#[test]
fn other_codes_clear_the_words() {
    for code in ["G00", "G01", "G50 U0", "G28"] {
        let text = format!("G90 X120 Z-30 R-2 F50;\n{code};\nG90 X110;\n");
        let trace = InterpreterBench::at(130.0, 5.0).trace(&text);
        let after: Vec<_> = trace.iter().filter(|line| line.starts_with("3:")).collect();
        assert_eq!(after[0], "3: rapid X110 Z5 |", "{code}");
    }
}

#[test]
fn reset_keeps_the_code_and_clears_the_words() {
    let mut bench = InterpreterBench::at(130.0, 5.0);
    bench.trace("G90 X120 Z-30 R-2 F50;");
    bench.reset();
    assert_eq!(bench.interpreter.modal().motion, MotionCode::TurningCycle);
    let trace = bench.trace("N10;\nX110;\n");
    assert_eq!(trace[0], "1: nothing |");
    assert_eq!(trace[2], "2: line X110 Z5 F50 |");
}

#[test]
fn taper_against_the_infeed() {
    // The drawn cases of figure 3-32.
    for text in [
        "G90 U20 W-30 R5 F9;",
        "G90 U-20 W-30 R-5 F9;",
        "G90 U20 W30 R-10 F9;",
        "G90 U-20 W30 R10 F9;",
    ] {
        assert!(
            !InterpreterBench::new()
                .trace(text)
                .concat()
                .contains("alarm"),
            "{text}"
        );
    }
    for text in [
        "G90 U20 W30 R-10.001 F9;",
        "G90 U-20 W30 R10.001 F9;",
        "G90 W-30 R1 F9;",
    ] {
        assert_eq!(
            InterpreterBench::new().run_to_alarm(text),
            (15, 1),
            "{text}"
        );
    }
    for text in [
        "G94 U20 W-30 R-5 F9;",
        "G94 U-20 W-30 R-50 F9;",
        "G94 U20 W30 R-30 F9;",
    ] {
        assert!(
            !InterpreterBench::new()
                .trace(text)
                .concat()
                .contains("alarm"),
            "{text}"
        );
    }
    for text in [
        "G94 U20 W30 R-30.001 F9;",
        "G94 U-20 W-30 R31 F9;",
        "G94 U-20 R1 F9;",
    ] {
        assert_eq!(
            InterpreterBench::new().run_to_alarm(text),
            (15, 1),
            "{text}"
        );
    }
}

#[test]
fn cycles_need_a_feed() {
    assert_eq!(
        InterpreterBench::new().run_to_alarm("G90 X120 Z30;"),
        (11, 1)
    );
}

#[test]
fn radius_programming_doubles_x_but_not_r() {
    let trace = InterpreterBench::at(130.0, 80.0)
        .with_bit(1, 2, true)
        .trace("G90 X60 Z30 R-30 F50;");
    assert_eq!(trace[0], "1: rapid X60 Z80 |");
    assert_eq!(trace[1], "1: line X120 Z30 F50 |");
}
