//! The explanation of each pass of a cycle.

use super::InterpreterBench;
use crate::interpreter::Explanation;
use crate::interpreter::InterpreterStep;

/// Runs a program and returns the explanations of its cycles, one per pass of each block.
fn collect_explanations(mut bench: InterpreterBench, text: &str) -> Vec<Explanation> {
    let mut all: Vec<(u32, Explanation)> = Vec::new();
    bench.open(text);
    for _ in 0..1000 {
        let line = match bench.next() {
            Ok(InterpreterStep::Command(command)) => command.source.line,
            Ok(InterpreterStep::Wait | InterpreterStep::Ended) => break,
            Err(alarm) => panic!("{alarm:?}"),
        };
        let Some(explanation) = bench.interpreter.explain() else {
            continue;
        };
        let is_known = all
            .last()
            .is_some_and(|(block, last)| *block == line && last.pass == explanation.pass);
        if !is_known {
            all.push((line, explanation));
        }
    }
    all.into_iter()
        .map(|(_, explanation)| explanation)
        .collect()
}

/// Code, pass, passes, level, depth and formula of an explanation.
type PassExplanation = (u8, u64, Option<u64>, Option<f64>, f64, String);

fn explain_passes(bench: InterpreterBench, text: &str) -> Vec<PassExplanation> {
    collect_explanations(bench, text)
        .into_iter()
        .map(|explanation| {
            (
                explanation.code,
                explanation.pass,
                explanation.passes,
                explanation.level,
                explanation.depth,
                explanation.formula.to_string(),
            )
        })
        .collect()
}

#[test]
fn boxes_explain_the_begin_of_the_cut() {
    assert_eq!(
        explain_passes(
            InterpreterBench::at(60.0, 2.0),
            "G90 X50 Z-30 R-3 F200;\nX48;\nG94 X20 Z-4 R-2;\n"
        ),
        [
            (
                90,
                1,
                Some(1),
                Some(50.0),
                5.0,
                "X_B = X_C + 2·R = 50.000 -6.000 = 44.000".into()
            ),
            (
                90,
                1,
                Some(1),
                Some(48.0),
                6.0,
                "X_B = X_C + 2·R = 48.000 -6.000 = 42.000".into()
            ),
            (
                94,
                1,
                Some(1),
                Some(-4.0),
                6.0,
                "Z_B = Z_C + R = -4.000 -2.000 = -6.000".into()
            ),
        ]
    );
}

#[test]
fn threads_explain_run_out_and_start() {
    // 019 = 5: the run-out is half a lead.
    let mut passes = explain_passes(InterpreterBench::at(60.0, 5.0), "G92 X58 Z-20 F2 L2;\n");
    assert_eq!(passes.len(), 2);
    let (code, pass, starts, level, depth, formula) = passes.swap_remove(1);
    assert_eq!(
        (code, pass, starts, level, depth),
        (92, 2, Some(2), Some(58.0), 1.0)
    );
    assert_eq!(
        formula,
        "X_B = X_C + 2·R = 58.000 +0.000 = 58.000; run-out J = 1.000, K = 1.000; \
         start angle = 360°·1/2"
    );
}

#[test]
fn tapping_explains_its_travel() {
    assert_eq!(
        explain_passes(InterpreterBench::at(0.0, 5.0), "G33 Z-20 F1.5;\nG00 Z6;\n"),
        [(
            33,
            1,
            Some(1),
            None,
            25.0,
            "Z5.000 -> Z-20.000 and back, one lead per revolution".into()
        )]
    );
}

#[test]
fn finishing_names_its_profile_once() {
    let text = "G70 P10 Q20;\nM30;\nN10 G00 X20;\nG01 Z-20 F100;\nN20 X62;\n";
    let passes = explain_passes(InterpreterBench::at(62.0, 2.0), text);
    assert_eq!(
        passes,
        [(
            70,
            1,
            Some(1),
            None,
            0.0,
            "lines 3 to 5 as programmed, with their own F, S, T; then rapid to X62.000 Z2.000"
                .into()
        )]
    );
}

#[test]
fn words_and_parameters_are_named() {
    let words = |text: &str| {
        collect_explanations(InterpreterBench::at(60.0, 5.0), text)
            .first()
            .map(|explanation| explanation.words)
    };
    assert_eq!(words("G90 X50 Z-30 F200;"), Some("X(U), Z(W), R: a radius"));
    assert_eq!(words("G94 X50 Z-3 F200;"), Some("X(U), Z(W), R"));
    assert_eq!(
        words("G92 X50 Z-30 F2;"),
        Some("X(U), Z(W), R, J, K, 019, L")
    );
}
