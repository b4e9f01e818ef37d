//! Calls by M, S and T codes, block skip, inch input, G28, decimal points.

use super::InterpreterBench;
use crate::program::MdiBlock;

/// Runs a program and returns its commands as short texts, without the one at the end of the
/// program.
fn trace(bench: &mut InterpreterBench, text: &str) -> Vec<String> {
    let mut lines = bench.trace(text);
    lines.retain(|line| !line.ends_with("end counts false m30 false"));
    lines
}

fn with_subprograms() -> InterpreterBench {
    let mut bench = InterpreterBench::new().with_bit(6, 5, true);
    for number in [9061, 9001, 9121, 9215, 9299] {
        let text = format!("O{number};\nG00 U-1;\nM99;");
        bench.programs.store(text).unwrap();
    }
    bench
}

#[test]
fn codes_without_a_function_call_subprograms() {
    // M61 with CM98 = 1: O9061; with CM98 = 0: alarm 019.
    assert_eq!(
        trace(&mut with_subprograms(), "M61;\nZ1;"),
        ["2: rapid X299 Z300 |", "2: rapid X299 Z1 |"]
    );
    assert_eq!(InterpreterBench::new().run_to_alarm("N1;\nM61;"), (19, 2));
    // The motion comes first. The code itself is not sent to the PLC.
    assert_eq!(
        trace(&mut with_subprograms(), "G00 X10 M1;"),
        ["1: rapid X10 Z300 |", "2: rapid X9 Z300 |"]
    );
    assert_eq!(
        trace(&mut with_subprograms(), "G98 M01;"),
        ["1: nothing |", "2: rapid X299 Z300 |"]
    );
    // Only T of two digits calls.
    assert_eq!(
        trace(&mut with_subprograms(), "T15;\nT99;\nT0101;"),
        [
            "2: rapid X299 Z300 |",
            "2: rapid X298 Z300 |",
            "3: T0101",
            "3: frame X0 Z0 offset X0.04 Z0.02 |"
        ]
    );
    assert_eq!(trace(&mut InterpreterBench::new(), "T01;")[0], "1: T0001");
    // S calls only with stepped speeds.
    let mut stepped = with_subprograms().with_bit(1, 4, false);
    assert_eq!(trace(&mut stepped, "S21;"), ["2: rapid X299 Z300 |"]);
    assert_eq!(trace(&mut stepped, "S2;")[0], "1: Step(2) |");
    assert_eq!(trace(&mut stepped, "S0302;")[0], "1: Step(2) |");
    assert_eq!(
        trace(&mut with_subprograms(), "S21;")[0],
        "1: Speed(21.0) |"
    );
    for text in ["S21;", "S10;", "S0110;"] {
        let mut without_cm98 = InterpreterBench::new().with_bit(1, 4, false);
        assert_eq!(without_cm98.run_to_alarm(text), (2, 1), "{text}");
    }
}

#[test]
fn code_calls_raise_alarms() {
    for (text, number) in [
        ("M62;", 78),
        ("T16;", 78),
        ("M61 T15;", 12),
        ("M30 T15;", 12),
    ] {
        assert_eq!(with_subprograms().run_to_alarm(text), (number, 1), "{text}");
    }
    let mut stepped = with_subprograms().with_bit(1, 4, false);
    assert_eq!(stepped.run_to_alarm("S22;"), (78, 1));
    for (text, number) in [("M61", 19), ("S21", 2), ("T15", 32)] {
        stepped.mdi(text);
        let alarm = stepped.run_to_end().1.unwrap();
        assert_eq!(alarm.number, number, "{text}");
    }
    let mut deep = InterpreterBench::new().with_bit(6, 5, true);
    deep.programs.store("O9061;\nM61;\nM99;").unwrap();
    deep.open("M61;");
    assert_eq!(deep.run_to_end().1.unwrap().number, 77);
}

#[test]
fn skipped_blocks_are_not_read() {
    let text = "/N5 G00 X1;\n/X1X2;\n/ (x) N7 X..;\nG00 Z5;";
    let mut bench = InterpreterBench::new();
    bench.block_skip = true;
    assert_eq!(trace(&mut bench, text), ["4: rapid X300 Z5 |"]);
    let mut bench = InterpreterBench::new();
    assert_eq!(bench.run_to_alarm(text), (18, 2));
}

#[test]
fn inch_input() {
    let mut bench = InterpreterBench::at(0.0, 0.0);
    bench.interpreter.set_inch_input(true);
    let text = "G00 X1 Z-2.00005;\nG01 W.5 F10;\nG02 U2 W-1 R1.;\nG04 X1.5;\nG50 X2;";
    assert_eq!(
        trace(&mut bench, text),
        [
            "1: rapid X25.4 Z-50.80254 |",
            "2: line X25.4 Z-38.10254 F254 |",
            "3: cw X76.2 Z-63.50254 about X76.2 Z-38.10254 F254 |",
            "4: dwell 1500 |",
            "5: frame X25.4 Z0 offset X0 Z0 program zero relative |",
        ]
    );
    // A variable counts 0.0001 inch.
    let mut bench = InterpreterBench::at(0.0, 0.0);
    bench.interpreter.set_inch_input(true);
    bench.variables.set(200, 10_000).unwrap();
    assert_eq!(
        trace(&mut bench, "G00 X#200;\nG04 X#200;\nX400;"),
        [
            "1: rapid X25.4 Z0 |",
            "2: dwell 10000 |",
            "alarm 043 line 3"
        ]
    );
    assert!(bench.interpreter.modal().inch);
    assert_eq!(InterpreterBench::new().run_to_alarm("G20;"), (10, 1));
}

#[test]
fn counts_of_cycles_are_not_converted_from_inches() {
    // Q 100 and R 50 count 0.0001 inch; P is passes, run-out and angle.
    let mut bench = InterpreterBench::at(0.0, 0.0);
    bench.interpreter.set_inch_input(true);
    trace(&mut bench, "G76 P021060 Q100 R50;");
    let stored = |bench: &InterpreterBench| {
        [57, 19, 58, 59, 60].map(|number| bench.parameters.value(number))
    };
    assert_eq!(stored(&bench), [2, 10, 60, 254, 127]);
    // R of G73 is a count, with P and Q in the block too.
    for cycle in [
        "G73 U.1 W.2 R3;\nG73 P10 Q20 U.01 F5;\n",
        "G73 U.1 W.2;\nG73 P10 Q20 R3 U.01 F5;\n",
    ] {
        let mut bench = InterpreterBench::at(100.0, 0.0);
        bench.interpreter.set_inch_input(true);
        trace(
            &mut bench,
            &format!("{cycle}N10 G00 X1;\nG01 Z-1;\nN20 X2;\n"),
        );
        let stored = [53, 54, 55].map(|number| bench.parameters.value(number));
        assert_eq!(stored, [2540, 5080, 3], "{cycle}");
    }
}

#[test]
fn reference_return_details() {
    // Without axis words the run continues with the next block.
    assert_eq!(
        trace(&mut InterpreterBench::new(), "G28;")[0],
        "1: nothing |"
    );
    // Z alone; X keeps its offset.
    let mut bench = InterpreterBench::new();
    assert_eq!(
        trace(&mut bench, "T0101;\nG28 W-10;\nG00 X10;"),
        [
            "1: T0101",
            "1: frame X0 Z0 offset X0.04 Z0.02 |",
            "2: rapid X300 Z290 |",
            "2: rapid X300 Z0",
            "2: referenced false true",
            "2: frame X0 Z0 offset X0.04 Z0 |",
            "3: rapid X10.04 Z0 |",
        ]
    );
    // On an inch machine 049 and 050 count in 0.0001 inch.
    let mut bench = InterpreterBench::new()
        .with_bit(12, 7, true)
        .with_bit(4, 0, true);
    bench.parameters.set(49, 10_000).unwrap();
    bench.parameters.set(50, -20_000).unwrap();
    trace(&mut bench, "G28 U0 W0;");
    assert_eq!(bench.displayed_position(), (25.4, -50.8));
}

#[test]
fn points_are_appended_on_the_mdi_page() {
    let bench = InterpreterBench::new()
        .with_bit(13, 3, true)
        .with_bit(13, 5, true);
    let mut mdi = MdiBlock::default();
    for word in ["G01", "X10", "F100", "Z1.5"] {
        mdi.enter(word, &bench.parameters, false).unwrap();
    }
    assert_eq!(mdi.text(), "G01 X10. F100. Z1.5");
    let mut mdi = MdiBlock::default();
    for word in ["G65", "H1", "P#200", "Q5", "R7"] {
        mdi.enter(word, &bench.parameters, false).unwrap();
    }
    assert_eq!(mdi.text(), "G65 H1 P#200 Q5 R7");
    let without_option = InterpreterBench::new().with_bit(13, 5, true);
    let refused = MdiBlock::default().enter("X10", &without_option.parameters, false);
    assert_eq!(refused.unwrap_err().number, 7);
}
