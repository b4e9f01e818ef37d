//! G32, G33, G34, G92.

use super::InterpreterBench;
use crate::command::Action;
use crate::interpreter::InterpreterStep;
use crate::units::Point;

#[test]
fn a_straight_thread_waits_for_the_index() {
    let trace = InterpreterBench::at(20.0, 3.0).trace("G32 Z-50 F2;\n");
    assert_eq!(trace[0], "1: thread X20 Z-50 Z lead 2 at 0 |");
}

#[test]
fn consecutive_threads_continue_in_phase() {
    let trace = InterpreterBench::at(20.0, 3.0)
        .trace("G32 Z-20 F2;\nX30 Z-40;\nG00 X40;\nG32 Z-50;\nM08;\nZ-60;\nG34 Z-70 R0.1;\n");
    assert_eq!(
        trace[..8],
        [
            "1: thread X20 Z-20 Z lead 2 at 0 |",
            "2: thread X30 Z-40 Z lead 2 continued |",
            "3: rapid X40 Z-40 |",
            "4: thread X40 Z-50 Z lead 2 at 0 |",
            "5: M08 |",
            "6: thread X40 Z-60 Z lead 2 at 0 |",
            "7: thread X40 Z-70 Z lead 2+0.1 continued |",
            "7: end counts false m30 false",
        ]
    );
}

#[test]
fn the_lead_is_along_the_long_axis() {
    // X counts as a radius; equal displacements select X.
    for (words, axis) in [
        ("X40 Z-20", "Z"),
        ("X40 Z-10", "X"),
        ("X40 Z-9", "X"),
        ("X40", "X"),
    ] {
        let trace = InterpreterBench::at(20.0, 0.0).trace(&format!("G32 {words} F3;"));
        assert!(
            trace[0].contains(&format!(" {axis} lead 3")),
            "{words}: {}",
            trace[0]
        );
    }
}

#[test]
fn the_run_out_leaves_the_programmed_line() {
    // K 6 before Z-50 on the line X20 Z0 -> X30 Z-50: X 20 + 10*44/50.
    let trace =
        InterpreterBench::at(20.0, 0.0).trace("G32 X30 Z-50 F2 J4 K6;\nG00 U10;\nU0 W-5;\n");
    assert_eq!(
        trace[..4],
        [
            "1: thread X28.8 Z-44 Z lead 2 at 0",
            "1: run-out X38 Z-50 Z lead 2 continued |",
            // From the programmed X30, not from X38.
            "2: rapid X40 Z-50 |",
            "3: rapid X40 Z-55 |",
        ]
    );
}

#[test]
fn run_out_words() {
    for (words, expected) in [
        // A missing K equals J.
        ("Z-50 J-5", "1: thread X20 Z-45 Z lead 2 at 0"),
        // K has no sign.
        ("Z-50 J5 K-10", "1: thread X20 Z-40 Z lead 2 at 0"),
        // A run-out longer than the thread takes up all of it.
        ("Z-50 J5 K60", "1: run-out X30 Z-50 Z lead 2 at 0 |"),
        // No run-out without J.
        ("Z-50 K10", "1: thread X20 Z-50 Z lead 2 at 0 |"),
        ("Z-50 J0 K10", "1: thread X20 Z-50 Z lead 2 at 0 |"),
        // Face thread: K is a radius, J along Z.
        ("X80 J3 K5", "1: thread X70 Z0 X lead 2 at 0"),
    ] {
        let trace = InterpreterBench::at(20.0, 0.0).trace(&format!("G32 {words} F2;"));
        assert_eq!(trace[0], expected, "{words}");
    }
    let trace = InterpreterBench::at(20.0, 0.0).trace("G32 X80 J3 K5 F2;\nG00 W1;");
    assert_eq!(trace[1], "1: run-out X80 Z3 X lead 2 continued |");
    assert_eq!(trace[2], "2: rapid X80 Z1 |");
}

#[test]
fn leads_have_a_separate_register() {
    let mut bench = InterpreterBench::at(20.0, 0.0);
    let trace =
        bench.trace("G01 Z-1 F100;\nG32 Z-50 F2;\nG01 Z-60;\nG32 Z-70;\nZ-80 I10;\nZ-90 F4 I5;\n");
    assert_eq!(
        trace[..6],
        [
            "1: line X20 Z-1 F100 |",
            "2: thread X20 Z-50 Z lead 2 at 0 |",
            "3: line X20 Z-60 F100 |",
            "4: thread X20 Z-70 Z lead 2 at 0 |",
            "5: thread X20 Z-80 Z lead 2.54 continued |",
            "6: thread X20 Z-90 Z lead 4 continued |",
        ]
    );
    assert_eq!(bench.interpreter.modal().feed, 100.0);
}

#[test]
fn lead_faults() {
    for (text, number) in [
        ("G01 F100;\nG32 Z1;", 11),
        ("\nG32 Z1 F0;", 43),
        ("\nG32 Z1 F500.001;", 43),
        ("\nG32 Z1 I0.059;", 43),
        ("\nG32 Z1 I-1;", 43),
        ("\nG32 Z1 F2 R5;", 13),
        ("\nG33 Z1;", 11),
        ("\nG92 X1 Z1;", 11),
        ("\nG33 X1 Z1 F1;", 9),
        ("\nG34 Z1 F2 R500.001;", 43),
        ("\nG34 Z1 F2 R0;", 43),
        // 300 mm at 2 - 0.01 n: after 200 revolutions and 200 mm the lead is 0.
        ("\nG34 Z0 F2 R-0.01;", 43),
        // sqrt(4 + 2*500*300) > 500.
        ("\nG34 Z0 F2 R500;", 43),
    ] {
        let text = text
            .strip_prefix('\n')
            .map_or_else(|| text.to_string(), |rest| format!("M08;\n{rest}"));
        assert_eq!(
            InterpreterBench::new().run_to_alarm(&text),
            (number, 2),
            "{text}"
        );
    }
}

#[test]
fn a_lead_can_change() {
    // Run-out after 46 mm: lead there sqrt(2² + 2*0.5*46) = sqrt(50).
    let trace = InterpreterBench::at(20.0, 0.0).trace("G34 Z-50 F2 R0.5 J2 K4;\nG00 W-1 U1;");
    assert_eq!(
        trace[..3],
        [
            "1: thread X20 Z-46 Z lead 2+0.5 at 0",
            "1: run-out X24 Z-50 Z lead 7.071068+0.5 continued |",
            "2: rapid X21 Z-51 |",
        ]
    );
    let trace = InterpreterBench::at(20.0, 0.0).trace("G34 Z-50 F4 R-0.1;");
    assert_eq!(trace[0], "1: thread X20 Z-50 Z lead 4-0.1 at 0 |");
}

#[test]
fn taps_end_where_they_begin() {
    let mut bench = InterpreterBench::at(0.0, 5.0);
    let trace = bench.trace("G33 Z-20 F1.5;\nG00 W1;");
    assert_eq!(trace[0], "1: tap X0 Z-20 lead 1.5 at 0 |");
    assert_eq!(trace[1], "2: rapid X0 Z6 |");
    let trace = InterpreterBench::at(0.0, 5.0).trace("G33 W-25 F2 L3;");
    assert_eq!(
        trace[..3],
        [
            "1: tap X0 Z-20 lead 2 at 0 |",
            "1: tap X0 Z-20 lead 2 at 120 |",
            "1: tap X0 Z-20 lead 2 at 240 |",
        ]
    );
}

#[test]
fn the_thread_cycle() {
    // A thread like that of figure 3-29 of the manual: 019 = 5, F3: J = K = 1.5.
    let trace = InterpreterBench::at(42.0, 155.0).trace("G92 X39 W-34 F3;\nX38.2;\n;\nG00 X50;");
    assert_eq!(
        trace[..12],
        [
            "1: rapid X39 Z155 |",
            "1: thread X39 Z122.5 Z lead 3 at 0",
            // 3 mm of diameter, exactly X_A.
            "1: run-out X42 Z121 Z lead 3 continued |",
            // The retract is kept for feed hold, and single block does not stop after it.
            "1: rapid X42 Z121",
            "1: rapid X42 Z155 |",
            "2: rapid X38.2 Z155 |",
            "2: thread X38.2 Z122.5 Z lead 3 at 0",
            "2: run-out X41.2 Z121 Z lead 3 continued |",
            "2: rapid X42 Z121 |",
            "2: rapid X42 Z155 |",
            "3: rapid X38.2 Z155 |",
            "3: thread X38.2 Z122.5 Z lead 3 at 0",
        ]
    );
}

#[test]
fn the_run_out_of_the_thread_cycle() {
    for (words, expected) in [
        // Not beyond X_A.
        (
            "J9 K4",
            [
                "1: thread X40 Z-26 Z lead 2 at 0",
                "1: run-out X50 Z-30 Z lead 2 continued |",
            ],
        ),
        (
            "J-2 K-4",
            [
                "1: thread X40 Z-26 Z lead 2 at 0",
                "1: run-out X44 Z-30 Z lead 2 continued |",
            ],
        ),
        (
            "J2",
            [
                "1: thread X40 Z-28 Z lead 2 at 0",
                "1: run-out X44 Z-30 Z lead 2 continued |",
            ],
        ),
        // J by 019: 1 mm.
        (
            "K3",
            [
                "1: thread X40 Z-27 Z lead 2 at 0",
                "1: run-out X42 Z-30 Z lead 2 continued |",
            ],
        ),
        (
            "J0",
            ["1: thread X40 Z-30 Z lead 2 at 0 |", "1: rapid X50 Z-30 |"],
        ),
        (
            "J2 K99",
            ["1: run-out X44 Z-30 Z lead 2 at 0 |", "1: rapid X50 Z-30 |"],
        ),
    ] {
        let trace = InterpreterBench::at(50.0, 0.0).trace(&format!("G92 X40 Z-30 F2 {words};"));
        assert_eq!(trace[1..3], expected, "{words}");
    }
}

#[test]
fn all_four_sides_of_the_thread_cycle() {
    for (words, expected) in [
        (
            "U-10 W-30 R-2",
            ["X36 Z0", "X39.333333 Z-25", "X46 Z-30", "X50 Z-30"],
        ),
        (
            "U10 W-30 R2",
            ["X64 Z0", "X60.666667 Z-25", "X54 Z-30", "X50 Z-30"],
        ),
        (
            "U-10 W30 R5",
            ["X50 Z0", "X41.666667 Z25", "X46 Z30", "X50 Z30"],
        ),
        (
            "U10 W30 R-5",
            ["X50 Z0", "X58.333333 Z25", "X54 Z30", "X50 Z30"],
        ),
    ] {
        let trace = InterpreterBench::at(50.0, 0.0).trace(&format!("G92 {words} F2 J3 K5;"));
        let ends: Vec<_> = trace
            .iter()
            .filter_map(|line| {
                let words: Vec<_> = line.split(' ').collect();
                (words[1] != "end").then(|| format!("{} {}", words[2], words[3]))
            })
            .collect();
        // No move to a B that equals A.
        let skip = usize::from(expected[0] == "X50 Z0");
        assert_eq!(ends[..4 - skip], expected[skip..], "{words}");
        assert_eq!(ends[4 - skip], "X50 Z0", "{words}");
    }
}

#[test]
fn a_multi_start_thread_keeps_its_words() {
    let trace = InterpreterBench::at(50.0, 0.0).trace("G92 X48 Z-30 F4 J0 L2;\nX47;\n");
    let threads: Vec<_> = trace
        .iter()
        .filter(|line| line.contains("thread"))
        .collect();
    assert_eq!(
        threads,
        [
            "1: thread X48 Z-30 Z lead 4 at 0 |",
            "1: thread X48 Z-30 Z lead 4 at 180 |",
            "2: thread X47 Z-30 Z lead 4 at 0 |",
            "2: thread X47 Z-30 Z lead 4 at 180 |",
        ]
    );
}

#[test]
fn other_codes_forget_the_end_of_the_thread_cycle_and_keep_its_run_out() {
    for code in ["G00", "G32", "G50 U0", "G74 R1", "G65 H01 P#200 Q1"] {
        let text = format!("G92 X40 Z-30 R-1 F2 J3 K2 L2;\n{code};\nG92 X40 Z-30;");
        let trace = InterpreterBench::at(50.0, 0.0).trace(&text);
        let last: Vec<_> = trace.iter().filter(|line| line.starts_with("3:")).collect();
        assert_eq!(last[0], "3: rapid X40 Z0 |", "{code}");
        assert_eq!(last[1], "3: thread X40 Z-28 Z lead 2 at 0", "{code}");
        assert_eq!(
            last[2], "3: run-out X46 Z-30 Z lead 2 continued |",
            "{code}"
        );
        assert!(last[6].contains("at 180"), "{code}: {}", last[6]);
    }
}

#[test]
fn the_end_of_a_program_forgets_the_run_out() {
    let mut bench = InterpreterBench::at(50.0, 0.0);
    bench.trace("G92 X40 Z-30 F2 J3 K2 L2;\nM30;");
    let trace = bench.trace("G92 X40 Z-30;");
    let cuts: Vec<_> = trace
        .iter()
        .filter(|line| line.contains("Z lead"))
        .collect();
    assert_eq!(
        cuts,
        [
            "1: thread X40 Z-29 Z lead 2 at 0",
            "1: run-out X42 Z-30 Z lead 2 continued |",
        ]
    );
}

#[test]
fn faults_of_the_thread_cycle() {
    for text in [
        "G92 U10 W-30 R-5.001 F2;",
        "G92 U-10 W-30 R5.001 F2;",
        "G92 W-30 R1 F2;",
        "G92 U-10 F2;",
        "G92 U-10 W0 R-3 F2;",
    ] {
        assert_eq!(
            InterpreterBench::new().run_to_alarm(text),
            (15, 1),
            "{text}"
        );
    }
}

#[test]
fn without_an_infeed_only_the_thread_is_cut() {
    let trace = InterpreterBench::at(50.0, 0.0).trace("G92 W-30 F2;");
    assert_eq!(
        trace[..3],
        [
            "1: thread X50 Z-30 Z lead 2 at 0 |",
            "1: rapid X50 Z-30",
            "1: rapid X50 Z0 |"
        ]
    );
}

#[test]
fn radius_programming_leaves_run_outs_alone() {
    let trace = InterpreterBench::at(50.0, 0.0)
        .with_bit(1, 2, true)
        .trace("G92 X20 Z-30 R-1 F2 J3 K5;\nG32 X30 Z-20 J1;");
    assert_eq!(trace[0], "1: rapid X38 Z0 |");
    assert_eq!(trace[2], "1: run-out X46 Z-30 Z lead 2 continued |");
    assert_eq!(trace[6], "2: run-out X62 Z-20 Z lead 2 continued |");
}

#[test]
fn f_of_a_thread_cycle_alone_does_not_repeat_it() {
    let trace = InterpreterBench::at(50.0, 0.0).trace("G92 X40 Z-30 F2 J0;\nF3;\nX39;");
    let second: Vec<_> = trace.iter().filter(|line| line.starts_with("2:")).collect();
    assert_eq!(second, ["2: nothing |"]);
    assert!(trace.contains(&"3: thread X39 Z-30 Z lead 3 at 0 |".to_string()));
}

#[test]
fn ten_threads_an_inch() {
    let trace = InterpreterBench::at(50.0, 0.0).trace("G92 X40 Z-30 I10 J0;");
    assert_eq!(trace[1], "1: thread X40 Z-30 Z lead 2.54 at 0 |");
}

/// Starts a program whose first command must announce a thread cycle, and returns the travel
/// of each axis per spindle revolution, mm.
fn per_revolution(bench: &mut InterpreterBench, text: &str) -> Point {
    bench.open(text);
    match bench.next() {
        Ok(InterpreterStep::Command(command)) => match command.action {
            Action::ThreadCycle { per_revolution, .. } => per_revolution,
            other => panic!("{other:?}"),
        },
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_cycle_of_threads_is_checked_before_its_infeed() {
    // The cone rises by 4 mm of radius in 32 mm of Z: 0.25 mm a revolution.
    let mut bench = InterpreterBench::at(60.0, 3.0);
    bench.parameters.set(19, 0).unwrap();
    let travel = per_revolution(&mut bench, "G92 X50 Z-29 R-4 F2;\n");
    assert_eq!((travel.x, travel.z), (0.25, 2.0));
    // The run-out leaves at 45 degrees: X also travels the lead.
    bench.parameters.set(19, 5).unwrap();
    let travel = per_revolution(&mut bench, "G92 X50 Z-29 R0 F2;\n");
    assert_eq!((travel.x, travel.z), (2.0, 2.0));
}

#[test]
fn a_compound_thread_is_checked_before_its_infeed() {
    let mut bench = InterpreterBench::at(60.0, 3.0);
    bench.parameters.set(19, 0).unwrap();
    let travel = per_revolution(&mut bench, "G76 X50 Z-30 P1300 Q500 F1.5;\n");
    assert_eq!((travel.x, travel.z), (0.0, 1.5));
}
