//! Properties over random programs.

use std::fmt::Write;

use proptest::prelude::*;

use super::{InterpreterBench, target};
use crate::command::Action;
use crate::memory::ToolOffset;

/// Formats thousandths of a millimetre as millimetres with three decimals.
fn mm(thousandths: i64) -> String {
    let sign = if thousandths < 0 { "-" } else { "" };
    let size = thousandths.abs();
    format!("{sign}{}.{:03}", size / 1000, size % 1000)
}

fn steps() -> impl Strategy<Value = Vec<(i64, i64, u8)>> {
    prop::collection::vec((-90_000_i64..90_000, -90_000_i64..90_000, 0_u8..4), 1..60)
}

/// Generates a block of a turning program: usually a straight move, sometimes a block that
/// affects the following moves.
fn any_block() -> impl Strategy<Value = String> {
    let number = || (-40_000_i64..40_000).prop_map(mm);
    let axis = move |absolute: char, increment: char| {
        prop_oneof![
            2 => Just(String::new()),
            3 => number().prop_map(move |size| format!("{absolute}{size}")),
            2 => number().prop_map(move |size| format!("{increment}{size}")),
            1 => (number(), number())
                .prop_map(move |(one, other)| format!("{absolute}{one}{increment}{other}")),
        ]
    };
    let code = prop::sample::select(vec!["", "", "", "G0", "G01", "G1", "G02", "G3"]);
    let feed = prop::sample::select(vec!["", "", "", "F80", "F0.25", "F12.5"]);
    let head = prop::sample::select(vec!["", "", "N20", "/"]);
    let arc = prop_oneof![
        6 => Just(String::new()),
        1 => (20_000_i64..60_000).prop_map(|r| format!("R{}", mm(r))),
        1 => (number(), number()).prop_map(|(i, k)| format!("I{i}K{k}")),
        1 => number().prop_map(|k| format!("K{k}")),
    ];
    let moves = (head, code, axis('X', 'U'), axis('Z', 'W'), arc, feed)
        .prop_map(|(head, code, x, z, arc, feed)| format!("{head}{code}{x}{z}{arc}{feed}"))
        // An empty block repeats a cycle; with a word in it, it does not.
        .prop_filter("no word", |text| !matches!(text.as_str(), "" | "N20" | "/"));
    let other = prop::sample::select(vec![
        "G01 X10. Z10. R1.5",
        "G01 U12. I2.",
        "G90 X10. Z-5. R0.5",
        "X8.",
        "G42",
        "G41",
        "G40",
        "T0101",
        "T0100",
        "G50 X40. Z20.",
        "G02 U4. W-4. R8.",
        "G03 U4. W-4. I1. K-6.",
        "G04 P100",
        "G92 X20. Z-9. F2.",
        "G32 W-8. F1.5",
        "M08",
    ]);
    prop_oneof![6 => moves, 1 => other.prop_map(str::to_owned)]
}

proptest! {
    /// A plain move does what the full evaluation of its block does. A word without effect
    /// forces the full evaluation.
    #[test]
    fn a_plain_move_is_what_its_block_is(
        blocks in prop::collection::vec(any_block(), 1..40),
        radii in any::<bool>(),
        skip in any::<bool>(),
        feed in any::<bool>(),
    ) {
        let begin = format!("G98{}\n", if feed { " F100" } else { "" });
        let run = |word: &str| {
            let mut bench = InterpreterBench::at(0.0, 0.0);
            bench.parameters.set_bit(1, 2, radii).unwrap();
            bench.parameters.set_bit(2, 1, true).unwrap();
            let tool = ToolOffset { x: 1.0, z: -0.5, r: 0.4, t: 3 };
            bench.offsets.set(1, tool).unwrap();
            bench.block_skip = skip;
            let mut text = begin.clone();
            for block in &blocks {
                writeln!(text, "{block}{word}").unwrap();
            }
            bench.open(&text);
            let (commands, alarm) = bench.run_to_end();
            (commands, alarm, bench.interpreter.modal().to_owned(), bench.interpreter.position(), bench.displayed_position())
        };
        let (plain, whole) = (run(""), run(" G98"));
        prop_assert_eq!(plain.0.len(), whole.0.len());
        for (plain, whole) in plain.0.iter().zip(&whole.0) {
            prop_assert_eq!(plain, whole);
        }
        prop_assert_eq!((plain.1, plain.2, plain.3, plain.4), (whole.1, whole.2, whole.3, whole.4));
    }

    #[test]
    fn an_incremental_program_equals_its_absolute_twin(steps in steps()) {
        let (mut absolute, mut incremental) = (String::from("F100\n"), String::from("F100\n"));
        let (mut x, mut z) = (0, 0);
        for (dx, dz, code) in steps {
            (x, z) = (x + dx, z + dz);
            let code = code % 2;
            writeln!(absolute, "G{code} X{} Z{}", mm(x), mm(z)).unwrap();
            writeln!(incremental, "G{code} U{} W{}", mm(dx), mm(dz)).unwrap();
        }
        let run = |text: &str| {
            let mut bench = InterpreterBench::at(0.0, 0.0);
            bench.open(text);
            let (commands, alarm) = bench.run_to_end();
            (commands.into_iter().map(|command| command.action).collect::<Vec<_>>(), alarm, bench.displayed_position())
        };
        prop_assert_eq!(run(&absolute), run(&incremental));
    }

    #[test]
    fn blocks_end_at_the_programmed_point(steps in steps(), big in 130_000_i64..9_999_999) {
        let mut text = String::from("F100\n");
        let mut ends = Vec::new();
        let (mut x, mut z) = (0_i64, 0_i64);
        for (dx, dz, code) in steps {
            (x, z) = (x + dx, z + dz);
            let arc = if code >= 2 { format!(" R{}", mm(big)) } else { String::new() };
            writeln!(text, "G{code} X{} Z{}{arc}", mm(x), mm(z)).unwrap();
            if code < 2 || (dx, dz) != (0, 0) {
                ends.push((x as f64 / 2000.0, z as f64 / 1000.0));
            }
        }
        let mut bench = InterpreterBench::at(0.0, 0.0);
        bench.open(&text);
        let mut at = bench.machine;
        let (commands, alarm) = bench.run_to_end();
        prop_assert_eq!(alarm, None);
        let mut reached = Vec::new();
        for command in &commands {
            if let Action::Arc { to, center, .. } = command.action {
                let (first, last) = ((at - center).length(), (to - center).length());
                prop_assert!((first - last).abs() < 1e-8 && first.is_finite());
                prop_assert!((first - big as f64 / 1000.0).abs() < 1e-8);
            }
            if let Some(to) = target(&command.action) {
                at = to;
                reached.push((to.x, to.z));
            }
        }
        prop_assert_eq!(reached, ends);
    }

    #[test]
    fn arcs_by_centre_are_never_nan(
        x in -99_000_i64..99_000, z in -99_000_i64..99_000,
        i in -99_000_i64..99_000, k in -99_000_i64..99_000,
    ) {
        let mut bench = InterpreterBench::at(0.0, 0.0);
        bench.open(&format!("G02 X{} Z{} I{} K{} F10", mm(x), mm(z), mm(i), mm(k)));
        let (commands, alarm) = bench.run_to_end();
        if let Some(alarm) = alarm {
            prop_assert_eq!(alarm.number, 13);
        } else if let Action::Arc { to, center, .. } = commands[0].action {
            prop_assert!(center.length().is_finite());
            prop_assert!(((to - center).length() - center.length()).abs() <= 0.0021);
        }
    }

    #[test]
    fn any_text_is_a_run_or_an_alarm(text in "[GMSTXZUWRIKFPNO0-9 .;/\n-]{0,120}") {
        let mut bench = InterpreterBench::at(0.0, 0.0);
        bench.open(&text);
        let (commands, _) = bench.run_to_end();
        for command in commands {
            if let Some(to) = target(&command.action) {
                prop_assert!(to.length().is_finite());
            }
        }
    }
}
