//! Faults of G70 to G73 and of the profiles they name.

use super::InterpreterBench;

/// Runs the block `cycle` over the profile `blocks` (N1 to N9) from X50 Z2 and returns the
/// number of the alarm that the cycle raises.
fn fault(cycle: &str, blocks: &str) -> u16 {
    let data = "G71 U2 R1;\nG73 U1 W1 R2;\nG01 F100;\n";
    let text = format!("{data}{cycle} P1 Q9;\n{blocks}\nM30;\nN20 G01 X1;\n");
    let (number, line) = InterpreterBench::at(50.0, 2.0).run_to_alarm(&text);
    assert_eq!(line, 4, "{cycle} {blocks}");
    number
}

#[test]
fn profile_faults() {
    for (cycle, blocks, number) in [
        // ns.
        ("G71", "N1 X30;\nN9 G01 Z-5;", 65),
        ("G71", "N1 G02 X30 R99;\nN9 G01 Z-5;", 65),
        ("G71", "N1 G00 X30 Z-1;\nN9 G01 Z-5;", 65),
        ("G71", "N1 G00 Z-1;\nN9 G01 Z-5;", 65),
        ("G71", "N1 G00 X50;\nN9 G01 Z-5;", 65),
        ("G71", "N1 G00;\nN9 G01 Z-5;", 65),
        ("G72", "N1 G00 X30;\nN9 G01 Z-5;", 65),
        ("G72", "N1 G00 Z2;\nN9 G01 X30;", 65),
        ("G73", "N1 X30;\nN9 G01 Z-5;", 65),
        ("G73", "N1 G00 X30;\nN9 M08;", 65),
        // No motion along, motion back along, motion deeper again, arcs of more than a
        // quadrant.
        ("G71", "N1 G00 X30;\nN9 G01 X40;", 65),
        ("G71", "N1 G00 X30;\nG01 Z-5;\nZ-4;\nN9 Z-9;", 65),
        ("G71", "N1 G00 X30;\nG01 Z-5;\nX40;\nX39.999;\nN9 Z-9;", 65),
        ("G71", "N1 G00 X30;\nN9 G01 X20 Z-5;", 65),
        ("G71", "N1 G00 X30;\nN9 G03 X30 Z-10 R6;", 65),
        ("G71", "N1 G00 X30;\nN9 G03 X36 Z-9 R6;", 65),
        ("G72", "N1 G00 Z-20;\nG01 X40;\nX41;\nN9 X30;", 65),
        // Codes.
        ("G71", "N1 G00 X30;\nG90 X20 Z-5;\nN9 G01 Z-9;", 66),
        ("G71", "N1 G00 X30;\nG28 U0;\nN9 G01 Z-9;", 66),
        ("G73", "N1 G00 X30;\nG32 Z-5 F1;\nN9 G01 Z-9;", 66),
        ("G70", "N1 G00 X30;\nG50 X1;\nN9 G01 Z-9;", 66),
        ("G70", "N1 G00 X30;\nG65 H01 P#200 Q1;\nN9 G01 Z-9;", 66),
        ("G71", "N1 G00 X30;\nM98 P5;\nN9 G01 Z-9;", 64),
        ("G70", "N1 G00 X30;\nM99;\nN9 G01 Z-9;", 64),
        // The position of the profile.
        ("G71", "N1 G00 X30;\nG01 Z-9;", 63),
        ("G72", "N9 G00 X30;\nG01 Z-9;", 63),
        ("G70", "N9 G00 X30;\nN1 G01 Z-9;", 16),
        // Faults of the blocks themselves.
        ("G71", "N1 G00 X30;\nG02 X40 Z-30 R1;\nN9 G01 Z-40;", 13),
        ("G71", "N1 G00 X30;\nG01 Z-9 I1;\nN9 Z-40;", 13),
        ("G71", "N1 G00 X30;\nN9 G01 Z-9 I1;", 13),
        ("G70", "N1 G00 X30;\nN9 G01 Z-9 R1;", 13),
        ("G71", "N1 G00 X30;\nX5X6;\nN9 G01 Z-9;", 18),
    ] {
        assert_eq!(fault(cycle, blocks), number, "{cycle} {blocks}");
    }
}

#[test]
fn cycle_faults() {
    let profile = "N1 G00 X30;\nN9 G01 Z-5;\n";
    for (text, number) in [
        ("G71 P1;", 61),
        ("G70 Q9;", 61),
        ("G70;", 61),
        ("G71 P1 Q1;", 16),
        ("G71 U0;", 62),
        ("G71 U-1;", 62),
        ("G72 W-1;", 62),
        ("G71 R-1;", 62),
        ("G71 P1 Q9 F1;", 62),
        ("G72 P1 Q9 F1;", 62),
        ("G73 R0;", 62),
        ("G73 R-3;", 62),
        ("G73 P1 Q9 F1;", 62),
    ] {
        let (found, line) =
            InterpreterBench::at(50.0, 2.0).run_to_alarm(&format!("{text}\n{profile}"));
        assert_eq!((found, line), (number, 1), "{text}");
    }
    for text in ["G71 U1;\nG71 P1 Q9;\n", "G73 R2;\nG73 P1 Q9;\n"] {
        let text = format!("{text}{profile}");
        assert_eq!(
            InterpreterBench::at(50.0, 2.0).run_to_alarm(&text),
            (11, 2),
            "{text}"
        );
    }
}

#[test]
fn at_most_a_hundred_blocks() {
    let text = |blocks: usize| {
        format!(
            "G71 U9;\nG71 P1 Q9 F1;\nN1 G00 X30;\n{}N9 G01 Z-500;\n",
            "G01 W-1;\n".repeat(blocks - 2)
        )
    };
    assert_eq!(
        InterpreterBench::at(50.0, 2.0)
            .trace(&text(100))
            .last()
            .map(String::as_str),
        Some("102: end counts false m30 false")
    );
    assert_eq!(
        InterpreterBench::at(50.0, 2.0).run_to_alarm(&text(101)),
        (16, 2)
    );
}

#[test]
fn profiles_are_refused_in_mdi() {
    for (text, number) in [
        ("G71 P1 Q9 F1;", Some(67)),
        ("G70 P1 Q9;", Some(67)),
        ("G71 U2 R1;", None),
        ("G75 X20 P3000 F9;", None),
    ] {
        let mut bench = InterpreterBench::at(50.0, 2.0);
        let program = crate::program::Program::new(text);
        let (interpreter, world) = bench.split_for_run();
        interpreter.start_mdi(program, &world);
        assert_eq!(
            bench.run_to_end().1.map(|alarm| alarm.number),
            number,
            "{text}"
        );
    }
}

#[test]
fn codes_that_call_are_refused_in_a_profile() {
    for cycle in ["G70", "G71"] {
        let text = format!("G71 U2 F9;\n{cycle} P1 Q2;\nN1 G00 X30 M61;\nN2 G01 Z-5;\n");
        let mut bench = InterpreterBench::at(50.0, 2.0).with_bit(6, 5, true);
        assert_eq!(bench.run_to_alarm(&text), (64, 2), "{cycle}");
    }
}
