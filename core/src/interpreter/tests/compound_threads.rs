//! G76: compound threads.

use super::InterpreterBench;

/// The G76 example of the manual: M68×6, height k 3.68, allowance d 0.2, first depth Δd 1.8,
/// least infeed Δdmin 0.1, thread angle 60°, run-out of one lead.
const EXAMPLE: &str = "G76 P011060 Q100 R200;\nG76 X60.64 Z25 P3680 Q1800 F6;\n";

fn stored_data(bench: &InterpreterBench) -> [i32; 5] {
    [57, 19, 58, 59, 60].map(|number| bench.parameters.value(number))
}

#[test]
fn the_first_block_writes_parameters() {
    let mut bench = InterpreterBench::at(80.0, 130.0);
    let trace = bench.trace("G76 P011060 Q100 R200;");
    assert_eq!(trace[0], "1: nothing |");
    assert_eq!(stored_data(&bench), [1, 10, 60, 100, 200]);
}

#[test]
fn p_has_six_digits_without_a_sign() {
    for (text, expected) in [
        ("G76 P010260", [1, 2, 60, 0, 0]),
        ("G76 P10260", [1, 2, 60, 0, 0]),
        ("G76 P260", [1, 2, 60, 0, 0]),
        ("G76 P-010260", [1, 2, 60, 0, 0]),
        ("G76 P991599", [99, 15, 99, 0, 0]),
        // Only the given words change their parameters.
        ("G76 Q50", [1, 5, 0, 50, 0]),
        // R(d): thousandths without a point, mm with one.
        ("G76 R300", [1, 5, 0, 0, 300]),
        ("G76 R0.3", [1, 5, 0, 0, 300]),
    ] {
        let mut bench = InterpreterBench::new();
        bench.trace(text);
        assert_eq!(stored_data(&bench), expected, "{text}");
    }
    assert_eq!(
        InterpreterBench::new().run_to_alarm("G76 P1000000"),
        (43, 1)
    );
    assert_eq!(InterpreterBench::new().run_to_alarm("G76 Q-1"), (62, 1));
    assert_eq!(InterpreterBench::new().run_to_alarm("G76 R-1"), (62, 1));
}

#[test]
fn the_example_of_the_manual() {
    let mut bench = InterpreterBench::at(80.0, 130.0);
    let trace = bench.trace(EXAMPLE);
    let begins: Vec<_> = trace.iter().skip(1).step_by(5).take(5).collect();
    // X 68 - 2 d, Z 130 - d tan 30°, the finishing pass B_e (d = k) too.
    assert_eq!(
        begins,
        [
            "2: rapid X64.4 Z128.96077 |",
            "2: rapid X62.908832 Z128.530306 |",
            "2: rapid X61.764618 Z128.2 |",
            "2: rapid X61.04 Z127.990821 |",
            "2: rapid X60.64 Z127.875351 |",
        ]
    );
    // The run-out is r·0.1·lead = 6 mm from Z31 on, but not beyond X_A.
    assert_eq!(
        trace[2..6],
        [
            "2: thread X64.4 Z31 Z lead 6 at 0",
            "2: run-out X76.4 Z25 Z lead 6 continued |",
            "2: rapid X80 Z25 |",
            "2: rapid X80 Z130 |",
        ]
    );
    assert_eq!(trace.len(), 1 + 5 * 5 + 1);
    assert_eq!(bench.displayed_position(), (80.0, 130.0));
}

#[test]
fn depths_have_explanations() {
    let mut bench = InterpreterBench::at(80.0, 130.0);
    bench.open(EXAMPLE);
    let mut passes: Vec<(u64, f64, String)> = Vec::new();
    while let Ok(crate::interpreter::InterpreterStep::Command(_)) = bench.next() {
        if let Some(explanation) = bench.interpreter.explain()
            && passes
                .last()
                .is_none_or(|(pass, ..)| *pass != explanation.pass)
        {
            passes.push((
                explanation.pass,
                explanation.depth,
                explanation.formula.to_string(),
            ));
        }
    }
    let depths: Vec<_> = passes
        .iter()
        .map(|(_, depth, _)| (depth * 1000.0).round() / 1000.0)
        .collect();
    assert_eq!(depths, [1.8, 2.546, 3.118, 3.48, 3.68]);
    assert_eq!(passes[1].2, "d2 = √2·1.800 = 2.546");
    assert_eq!(passes[3].2, "d4 = k - d = 3.680 - 0.200");
    assert_eq!(passes[4].2, "k = 3.680, cutting 0.200");
}

/// Runs a G76 with two blocks for a straight outer thread from X50, and returns the depth of
/// each pass, mm (a radius), computed from X of the cuts.
fn depths(first: &str, second: &str) -> Vec<f64> {
    let mut bench = InterpreterBench::at(50.0, 10.0);
    bench.parameters.set(19, 0).unwrap();
    let trace = bench.trace(&format!("{first}\n{second}"));
    trace
        .iter()
        .filter(|line| line.contains("thread"))
        .map(|line| {
            let x = line
                .split(' ')
                .find_map(|word| word.strip_prefix('X'))
                .unwrap();
            let depth = (44.0 - x.parse::<f64>().unwrap()) / 2.0;
            (depth * 1000.0).round() / 1000.0
        })
        .collect()
}

#[test]
fn the_minimum_infeed_limits_the_depths() {
    // X40, k 2: B at X44. √n: 1, 1.414, 1.732, 2; from n = 3 on +0.4.
    assert_eq!(
        depths("G76 P010000 Q400 R0", "G76 X40 Z-20 P2000 Q1000 F2"),
        [1.0, 1.414, 1.814, 2.0, 2.0]
    );
    // Without a minimum.
    assert_eq!(
        depths("G76 P010000 Q0 R0", "G76 X40 Z-20 P2000 Q1000 F2"),
        [1.0, 1.414, 1.732, 2.0, 2.0]
    );
}

#[test]
fn limits_of_the_depths() {
    // d = k: only finishing passes, m of them.
    assert_eq!(
        depths("G76 P030000 R2000", "G76 X40 Z-20 P2000 Q1000 F2"),
        [2.0, 2.0, 2.0]
    );
    // Δd above k - d: one roughing pass.
    assert_eq!(
        depths("G76 P010000 R100", "G76 X40 Z-20 P2000 Q5000 F2"),
        [1.9, 2.0]
    );
    // m = 0 counts as 1.
    assert_eq!(
        depths("G76 P000000 R0", "G76 X40 Z-20 P2000 Q2000 F2"),
        [2.0, 2.0]
    );
}

#[test]
fn tapers_follow_the_half_angle() {
    // X_D 40, i -2: C at X36; k 1: B at X38. Slope g = 2/(-40), t = -1, s = 1:
    // x = 1/(1 + 0.05·tan 30°) = 0.971942, z = x·tan 30° = 0.561151.
    let mut bench = InterpreterBench::at(50.0, 10.0);
    let trace = bench.trace("G76 P010060 Q0 R0;\nG76 X40 Z-30 R-2 P1000 Q1000 F2;");
    assert_eq!(trace[1], "2: rapid X36.056115 Z9.438849 |");
    assert_eq!(trace[2], "2: thread X40 Z-30 Z lead 2 at 0 |");
    // The finishing pass cuts the same line from the same Z.
    assert_eq!(trace[5], "2: rapid X36.056115 Z9.438849 |");
}

#[test]
fn all_four_sides() {
    for (start, words, begin, end) in [
        ((50.0, 0.0), "X40 Z-30", "X41 Z-0.288675", "X41 Z-30"),
        ((30.0, 0.0), "X40 Z-30", "X39 Z-0.288675", "X39 Z-30"),
        ((50.0, 0.0), "X40 Z30", "X41 Z0.288675", "X41 Z30"),
        ((30.0, 0.0), "X40 Z30", "X39 Z0.288675", "X39 Z30"),
    ] {
        let mut bench = InterpreterBench::at(start.0, start.1);
        let trace = bench.trace(&format!("G76 P010060 R0;\nG76 {words} P1000 Q500 F2;"));
        assert_eq!(trace[1], format!("2: rapid {begin} |"));
        assert_eq!(trace[2], format!("2: thread {end} Z lead 2 at 0 |"));
    }
}

#[test]
fn wrong_data_raises_alarms() {
    for (text, number) in [
        ("G76 X40 Z-30 Q500 F2;", 62),
        ("G76 X40 Z-30 P1000 F2;", 62),
        ("G76 X40 Z-30 P0 Q500 F2;", 62),
        ("G76 X40 Z-30 P1000 Q0 F2;", 62),
        ("G76 X40 Z-30 P-1000 Q500 F2;", 62),
        ("G76 X40 Z-30 P1000 Q500;", 11),
        ("G76 Z-30 P1000 Q500 F2;", 62),
        ("G76 X40 P1000 Q500 F2;", 62),
        ("G76 X40 Z-30 P9999999 Q1 F2;", 62),
    ] {
        assert_eq!(
            InterpreterBench::new().run_to_alarm(text),
            (number, 1),
            "{text}"
        );
    }
    assert_eq!(
        InterpreterBench::new().run_to_alarm("G76 R1001;\nG76 X40 Z-30 P1000 Q500 F2;"),
        (62, 2)
    );
    // The infeed along the angle would end after the thread.
    assert_eq!(
        InterpreterBench::at(50.0, 0.0).run_to_alarm("G76 P010090;\nG76 X40 Z-1 P3000 Q500 F2;"),
        (62, 2)
    );
}
