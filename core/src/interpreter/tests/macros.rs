//! G65, variables, jumps (manual I-3.7).

use super::InterpreterBench;
use crate::interpreter::InterpreterStep;
use crate::interpreter::macros::arithmetic::{Operands, Operation, compute};
use crate::memory::{ToolOffset, Variables};

/// Runs a program that must end without an alarm, and returns the value of #200.
fn run_result(text: &str) -> i64 {
    let mut bench = InterpreterBench::new();
    bench.open(text);
    let (_, alarm) = bench.run_to_end();
    assert_eq!(alarm, None, "{text}");
    bench.variables.get(200).unwrap()
}

#[test]
fn operations_give_their_results() {
    for (block, expected) in [
        ("H01 P#200 Q-7", -7),
        ("H01 P#200", 0),
        ("H2 P#200 Q5 R-8", -3),
        ("H03 P#200 Q5 R-8", 13),
        ("H04 P#200 Q-6 R7", -42),
        ("H05 P#200 Q17 R5", 3),
        ("H05 P#200 Q-17 R5", -3),
        ("H11 P#200 Q12 R10", 14),
        ("H12 P#200 Q12 R10", 8),
        ("H13 P#200 Q12 R10", 6),
        ("H13 P#200 Q-1 R1", -2),
        ("H21 P#200 Q10", 3),
        ("H21 P#200 Q4294967295", 65535),
        ("H22 P#200 Q-9", 9),
        ("H22 P#200 Q9", 9),
        ("H23 P#200 Q17 R5", 2),
        ("H23 P#200 Q-17 R5", -2),
        ("H24 P#200 Q4660", 1234),
        ("H25 P#200 Q1234", 4660),
        ("H25 P#200 Q99999999", 0x9999_9999),
        ("H27 P#200 Q3 R4", 5),
        ("H27 P#200 Q-1 R1", 1),
        ("H31 P#200 Q1000 R30000", 500),
        ("H31 P#200 Q1000 R-30000", -500),
        ("H31 P#200 Q-1000 R450000", -1000),
        ("H31 P#200 Q1000 R45000", 707),
        ("H32 P#200 Q1000 R60000", 500),
        ("H32 P#200 Q1000 R180000", -1000),
        ("H32 P#200 Q1000 R90000", 0),
        ("H33 P#200 Q1000 R45000", 1000),
        ("H33 P#200 Q1000 R60000", 1732),
        ("H33 P#200 Q1000 R135000", -1000),
        ("H34 P#200 Q1 R1", 45_000),
        ("H34 P#200 Q1", 90_000),
        ("H34 P#200 Q-1", 270_000),
        ("H34 P#200 Q0 R-1", 180_000),
        ("H34 P#200 Q0 R1", 0),
        ("H34 P#200 Q-1 R4294967295", 359_999),
    ] {
        assert_eq!(run_result(&format!("G65 {block};")), expected, "{block}");
    }
    assert_eq!(run_result("G65 H01 P#200 Q7;\nG65 H26 P#200 Q5 R2;"), 17);
    let codes: Vec<i64> = (0..100)
        .filter(|h| Operation::from_h_code(*h).is_some())
        .collect();
    assert_eq!(
        codes,
        [
            1, 2, 3, 4, 5, 11, 12, 13, 21, 22, 23, 24, 25, 26, 27, 31, 32, 33, 34, 80, 81, 82, 83,
            84, 85, 86, 99
        ]
    );
}

#[test]
fn operands_are_variables_with_a_sign() {
    assert_eq!(
        run_result("G65 H01 P#201 Q30;\nG65 H01 P#202 Q-4;\nG65 H02 P#200 Q-#201 R-#202;"),
        -26
    );
    // A vacant variable is zero; the order of the words is free.
    assert_eq!(run_result("N5 G65 R#515 Q9 P#200 H02;"), 9);
    assert_eq!(run_result("G65 H1 P#230 Q2;\nG65 H#230 P#200 Q40 R2;"), 42);
}

#[test]
fn macro_alarms_are_raised() {
    for (block, number) in [
        ("H02 P#200 Q4294967295 R1", 111),
        ("H03 P#200 Q-4294967296 R1", 111),
        ("H04 P#200 Q65536 R65536", 111),
        ("H04 P#200 Q-4294967296 R-4294967296", 111),
        ("H22 P#200 Q-4294967296", 111),
        ("H25 P#200 Q100000000", 111),
        ("H26 P#200 Q1 R0", 112),
        ("H27 P#200 Q4294967295 R4294967295", 111),
        ("H33 P#201 Q1000 R89999", 0),
        ("H33 P#200 Q4000000000 R89999", 111),
        ("H01 P#200 Q4294967296", 111),
        ("H01 P#1132 Q65536", 111),
        ("H01 P#1133 Q-1", 111),
        ("H05 P#200 Q1", 112),
        ("H23 P#200 Q1 R0", 112),
        ("H33 P#200 Q1 R-90000", 112),
        ("H34 P#200", 112),
        ("H00 P#200", 114),
        ("H06 P#200", 114),
        ("H87 P10", 114),
        ("", 114),
        ("Q1 R1", 114),
        ("H01 P#199 Q1", 115),
        ("H01 P#232 Q1", 115),
        ("H01 P#200 Q#516", 115),
        ("H01 P#200 Q#1016", 115),
        ("H01 P#1134 Q1", 115),
        ("H01 P#9 Q1", 115),
        ("H01 P#9200 Q1", 115),
        ("H01 P#9199 Q1", 115),
        ("H01 P200 Q1", 115),
        ("H01 P-#200 Q1", 115),
        ("H01 Q1", 115),
        ("H01 P#1000 Q1", 116),
        ("H01 P#1032 Q1", 116),
        ("H21 P#200 Q-1", 119),
        ("H24 P#200 Q-1", 119),
        ("H24 P#200 Q10", 119),
        ("H25 P#200 Q-1", 119),
        ("P9010", 125),
        ("H01 X1", 125),
        ("H80 P10000", 128),
        ("H80 P-10000", 128),
        ("H80 P20", 128),
        ("H81 P20", 128),
        ("H81 P20 Q1", 0),
        ("H99 P15", 515),
        ("H99 P99", 599),
        ("H99 P100", 43),
        ("H99 P-1", 43),
        ("H99 P#200", 500),
    ] {
        let mut bench = InterpreterBench::new();
        let text = format!("N1;\nG65 {block};");
        if number == 0 {
            bench.open(&text);
            assert_eq!(bench.run_to_end().1, None, "{block}");
            continue;
        }
        assert_eq!(bench.run_to_alarm(&text), (number, 2), "{block}");
        assert_eq!(bench.variables, Variables::default(), "{block}");
        assert_eq!(bench.outputs, 0, "{block}");
    }
}

#[test]
fn variables_in_words() {
    let start =
        "G65 H01 P#200 Q10;\nG65 H01 P#201 Q-2500;\nG65 H01 P#202 Q150;\nG65 H1 P#203 Q1;\n";
    let trace = InterpreterBench::new().trace(&format!("{start}G#203 X#200 Z-#201 F#202;"));
    assert_eq!(trace[4], "5: line X0.01 Z2.5 F150 |");
    // #9200 is the variable whose number is in #200; #200 = 205, #205 = 500.
    let mut bench = InterpreterBench::new();
    let trace = bench
        .trace("G65 H01 P#200 Q205;\nG65 H01 P#9200 Q500;\nG00 X#9200;\nG04 X#205;\nG04 P#205;");
    assert_eq!(bench.variables.get(205), Some(500));
    assert_eq!(
        trace[2..5],
        ["3: rapid X0.5 Z300 |", "4: dwell 500 |", "5: dwell 500 |"]
    );
    for (text, number) in [
        ("G65 H01 P#230 Q120;\nM#230;", 43),
        ("N1;\nX#100;", 115),
        ("N1;\nX#9200;", 115),
        ("G65 H01 P#200 Q65;\nG#200 H01 P1;", 125),
        ("N1;\nM98 P#200;", 78),
    ] {
        assert_eq!(
            InterpreterBench::new().run_to_alarm(text),
            (number, 2),
            "{text}"
        );
    }
}

#[test]
fn jumps_search_forward_or_backward_first() {
    let marked = |block: &str| {
        let mut bench = InterpreterBench::new();
        bench.open(&format!(
            "G65 H81 P99 Q#201 R1;\nN10 G65 H02 P#200 Q#200 R1;\nG65 H01 P#201 Q1;\nG65 {block};\n\
             N10 G65 H02 P#200 Q#200 R10;\nN99 M30;"
        ));
        let (_, alarm) = bench.run_to_end();
        assert_eq!(alarm, None);
        bench.variables.get(200).unwrap()
    };
    assert_eq!(marked("H82 P10 Q1 R1"), 11);
    assert_eq!(marked("H80 P10"), 11);
    assert_eq!(marked("H80 P99"), 1);
    // Backward, N10 before the jump comes first, so the loop never ends.
    let mut bench = InterpreterBench::new();
    bench
        .open("N10 G65 H02 P#200 Q#200 R1;\nG65 H84 P-10 Q#200 R5;\nN10 G65 H02 P#200 Q#200 R100;");
    assert_eq!(bench.run_to_end().1, None);
    assert_eq!(bench.variables.get(200), Some(105));
    // The search continues from the beginning, and last reaches the jump itself.
    assert_eq!(
        run_result("N3 G65 H02 P#200 Q#200 R1;\nG65 H84 P3 Q#200 R7;"),
        7
    );
    assert_eq!(
        run_result("G65 H01 P#205 Q-4;\nN4 G65 H02 P#200 Q#200 R1;\nG65 H84 P#205 Q#200 R3;"),
        3
    );
    // A jump stays in its program and keeps its calls.
    let mut bench = InterpreterBench::new();
    bench
        .programs
        .store("O0007;\nN10 G65 H02 P#200 Q#200 R1;\nG65 H84 P10 Q#200 R4;\nM99;")
        .unwrap();
    bench.open("M98 P7;\nN10 G65 H02 P#200 Q#200 R50;\nM30;");
    assert_eq!(bench.run_to_end().1, None);
    assert_eq!(bench.variables.get(200), Some(54));
}

#[test]
fn conditions_decide_jumps() {
    for (h, truth) in [
        (80, [true, true, true]),
        (81, [false, true, false]),
        (82, [true, false, true]),
        (83, [false, false, true]),
        (84, [true, false, false]),
        (85, [false, true, true]),
        (86, [true, true, false]),
    ] {
        for (q, expected) in (4..=6).zip(truth) {
            let taken = run_result(&format!(
                "G65 H{h} P9 Q{q} R5;\nG65 H01 P#200 Q0;\nM30;\nN9 G65 H01 P#200 Q1;"
            ));
            assert_eq!(taken == 1, expected, "H{h} Q{q}");
        }
    }
}

#[test]
fn each_call_makes_one_operation() {
    let mut bench = InterpreterBench::new();
    bench.open("N1 G65 H02 P#200 Q#200 R1;\nG65 H80 P1;");
    for turn in 1..=1000 {
        for _ in 0..2 {
            assert!(
                matches!(bench.next(), Ok(InterpreterStep::Command(command)) if command.block_end)
            );
        }
        assert_eq!(bench.variables.get(200), Some(turn));
    }
}

#[test]
fn single_block_stops_after_g65_with_sbkm_only() {
    let text = "G65 H01 P#200 Q1;\nN2;";
    assert_eq!(
        InterpreterBench::new().trace(text)[..2],
        ["1: macro", "2: nothing |"]
    );
    let trace = InterpreterBench::new().with_bit(13, 4, true).trace(text);
    assert_eq!(trace[..2], ["1: macro |", "2: nothing |"]);
}

#[test]
fn signals_of_the_ladder() {
    let mut bench = InterpreterBench::new();
    bench.inputs = 0b1000_0000_0000_0101;
    bench.open(
        "G65 H01 P#200 Q#1000;\nG65 H01 P#201 Q#1001;\nG65 H01 P#202 Q#1015;\nG65 H01 P#203 Q#1032;\n\
         G65 H01 P#1100 Q1;\nG65 H01 P#1115 Q-7;\nG65 H01 P#204 Q#1132;\n\
         G65 H01 P#1133 Q4294967295;\nG65 H01 P#1100 Q0;\nG65 H01 P#205 Q#1133;",
    );
    assert_eq!(bench.run_to_end().1, None);
    let values = [200, 201, 202, 203, 204, 205].map(|number| bench.variables.get(number).unwrap());
    assert_eq!(values, [1, 0, 1, 0x8005, 0x8001, 0xFFFF_FFFF]);
    assert_eq!(bench.outputs, 0xFFFF_FFFF_8000);
    bench.open("G65 H01 P#1132 Q18;\nG65 H01 P#200 Q1104;\nG65 H01 P#9200 Q0;");
    assert_eq!(bench.run_to_end().1, None);
    assert_eq!(bench.outputs, 0xFFFF_FFFF_0002);
}

#[test]
fn signals_wait_for_earlier_commands() {
    for block in [
        "G65 H01 P#200 Q#1000",
        "G65 H81 P1 Q#1015 R0",
        "G65 H01 P#1100 Q1",
        "G00 X#1032",
        "G65 H01 P#9201 Q1",
        "X#9201",
    ] {
        let mut bench = InterpreterBench::new();
        bench.variables.set(200, 77).unwrap();
        bench.variables.set(201, 1100).unwrap();
        bench.settled = false;
        bench.open(&format!("N1 {block};"));
        assert_eq!(bench.next(), Ok(InterpreterStep::Wait), "{block}");
        assert_eq!((bench.variables.get(200), bench.outputs), (Some(77), 0));
        bench.settled = true;
        assert!(
            matches!(bench.next(), Ok(InterpreterStep::Command(_))),
            "{block}"
        );
    }
    let mut bench = InterpreterBench::new();
    bench.settled = false;
    bench.open("G65 H01 P#200 Q5;\nX#200;");
    for _ in 0..2 {
        assert!(matches!(bench.next(), Ok(InterpreterStep::Command(_))));
    }
}

#[test]
fn macros_run_from_the_mdi_page() {
    let mut bench = InterpreterBench::new();
    bench.mdi("G65 H02 P#200 Q1 R2");
    assert_eq!(bench.run_to_end().1, None);
    assert_eq!(bench.variables.get(200), Some(3));
    bench.mdi("G65 H80 P1");
    assert_eq!(bench.run_to_end().1.unwrap().number, 128);
}

#[test]
fn bar_feed_example() {
    // Manual I-3.7.3.4: the body waits for an input and switches an output.
    let mut bench = InterpreterBench::new().with_bit(6, 5, true);
    bench
        .programs
        .store("O9061;\nG65 H01 P#1104 Q1;\nN10 G65 H81 P10 Q#1005 R0;\nG65 H01 P#1104 Q0;\nM99;")
        .unwrap();
    bench.open("M61;\nM30;");
    for _ in 0..100 {
        assert!(matches!(bench.next(), Ok(InterpreterStep::Command(_))));
        assert_eq!(bench.outputs, 1 << 4);
    }
    bench.inputs = 1 << 5;
    let (commands, alarm) = bench.run_to_end();
    assert_eq!((commands.len(), alarm, bench.outputs), (3, None, 0));
}

#[test]
fn macros_run_under_nose_compensation() {
    // A waiting loop lets the move before it finish and continues when its signal arrives.
    let mut bench = InterpreterBench::new().with_bit(2, 1, true);
    let nose = ToolOffset {
        r: 0.8,
        t: 3,
        ..ToolOffset::default()
    };
    bench.offsets.set(1, nose).unwrap();
    bench.open(
        "T0101;\nG00 G42 X50 Z2;\nG01 Z-20 F100;\nG65 H01 P#200 Q60000;\nN5 G65 H81 P5 Q#1000 R0;\n\
         X#200;\nG00 G40 X80;\nM30;",
    );
    for _ in 0..200 {
        assert!(matches!(bench.next(), Ok(InterpreterStep::Command(_))));
    }
    assert_eq!(bench.variables.get(200), Some(60_000));
    bench.inputs = 1;
    let (commands, alarm) = bench.run_to_end();
    assert_eq!(alarm, None);
    assert!(commands.len() < 12, "{}", commands.len());
    assert_eq!(bench.machine.diameter().0, 80.0);
}

#[test]
fn a_remembered_jump_is_checked_in_another_text() {
    let mut bench = InterpreterBench::new();
    bench.open("N1 G65 H02 P#200 Q#200 R1;\nG65 H84 P1 Q#200 R3;");
    assert_eq!(bench.run_to_end().1, None);
    bench.open("N2 G65 H02 P#200 Q#200 R1;\nG65 H84 P1 Q#200 R30;\nN1 M30;");
    let (commands, alarm) = bench.run_to_end();
    assert_eq!((commands.len(), alarm), (3, None));
    assert_eq!(bench.variables.get(200), Some(4));
}

mod random {
    use proptest::prelude::*;

    use super::*;

    fn operand() -> impl Strategy<Value = i64> {
        let edges = vec![
            Variables::LEAST,
            Variables::LEAST + 1,
            -90_000,
            -1,
            0,
            1,
            90_000,
            Variables::GREATEST,
        ];
        prop_oneof![
            prop::sample::select(edges),
            Variables::LEAST..=Variables::GREATEST,
            -1000_i64..1000,
        ]
    }

    proptest! {
        #[test]
        fn operations_never_overflow(
            h in 0_i64..100, i in operand(), j in operand(), k in operand(),
        ) {
            let operands = Operands { i, j, k };
            match Operation::from_h_code(h) {
                Some(Operation::Value(function)) => match compute(function, operands) {
                    Ok(value) => {
                        prop_assert!((Variables::LEAST..=Variables::GREATEST).contains(&value));
                    }
                    Err(fault) => prop_assert!(matches!(fault.alarm_number(), 111 | 112 | 119)),
                },
                Some(Operation::Jump(condition)) => {
                    condition(j, k);
                }
                Some(Operation::Alarm) | None => {}
            }
        }

        #[test]
        fn any_macro_text_is_a_run_or_an_alarm(
            text in "(G65 ?H(0?[1-5]|1[1-3]|2[1-7]|3[1-4]|8[0-6]|99) ?P-?#?(200|9200|1100|1|2) ?Q-?#?[0-9]{1,9} ?R-?#?(20[0-9]|[0-9]{1,4});?\n|N[1-3];\n|X#200;\n){1,12}",
            seed in operand(),
        ) {
            let mut bench = InterpreterBench::new();
            let _ = bench.variables.set(200, seed);
            bench.open(&text);
            for _ in 0..200 {
                if !matches!(bench.next(), Ok(InterpreterStep::Command(_))) {
                    break;
                }
            }
        }

        #[test]
        fn division_and_remainder_belong_together(j in operand(), k in operand()) {
            prop_assume!(k != 0 && !(j == Variables::LEAST && k == -1));
            let compute = |h| match Operation::from_h_code(h) {
                Some(Operation::Value(function)) => compute(function, Operands { i: 0, j, k }).unwrap(),
                _ => unreachable!(),
            };
            prop_assert_eq!(compute(5) * k + compute(23), j);
        }
    }
}
