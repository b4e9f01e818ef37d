//! Applies the fix of each warning and alarm, and checks the program again.

use std::collections::BTreeSet;

use gsk_core::command::ProgramId;
use gsk_core::model::ModelId;
use gsk_core::preview::Lint;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_messages::Language;
use gsk_milling::MillSetup;

use crate::text::TextDocument;
use crate::{Analysis, ProgramFinding, analyse, analyse_mill};

fn setup(text: &str) -> Setup {
    let mut setup = Setup::default();
    setup.memory.programs.open_external(Program::new(text));
    setup.memory.programs.select(ProgramId::External);
    setup
}

fn analysis(text: &str) -> Analysis {
    analyse(&setup(text), Language::En, &mut |it| it.moves < 1000)
}

fn mill_analysis(text: &str) -> Analysis {
    let setup = setup(text);
    let programs = &setup.memory.programs;
    analyse_mill(&MillSetup::default(), programs, Language::En, &mut |_| true)
}

fn codes(findings: &[ProgramFinding]) -> Vec<&str> {
    findings.iter().map(|it| it.code.as_str()).collect()
}

/// The code of a finding, a program with it, and the line (from 1) that the fix changes with
/// its new text.
type FixCase = (&'static str, &'static str, (u32, &'static str));

/// A program for each warning and alarm with a fix.
const CASES: &[FixCase] = &[
    (
        "slow-feed",
        "M03 S500 T0101\nG98 G01 X20 F0.2\nX22\nM30\n",
        (2, "G99 G01 X20 F0.2"),
    ),
    (
        "slow-feed",
        "M03 S500 T0101\nG98\nN5 G01 X20 F0.2\nM30\n",
        (3, "N5 G99 G01 X20 F0.2"),
    ),
    (
        "spindle-stands",
        "T0101 S500\nG00 X20 Z2\nN5 G01 Z-5 F100\nM30\n",
        (3, "M03"),
    ),
    (
        "no-offset",
        "M03 S500 T0200\nG00 X20 Z2\nG01 Z-5 F100\nM30\n",
        (1, "M03 S500 T0202"),
    ),
    (
        "ignored-word",
        "M98 P0118 L3\nM30\nO0118\nM99\n",
        (1, "M98 P30118"),
    ),
    (
        "ignored-word",
        "M03 S500 T0101\nG00 X40 Z2\nG90 X38 Z-20 I-5 F100\nM30\n",
        (3, "G90 X38 Z-20 R-5 F100"),
    ),
    (
        "ignored-word",
        "M03 S500 T0101\nG00 X40 Z2\nG01 Z-20 J5 F100\nM30\n",
        (3, "G01 Z-20 F100"),
    ),
    (
        "ignored-word",
        "G00 G01 X5 F100 M03 S9\nM30\n",
        (1, "G01 X5 F100 M03 S9"),
    ),
    ("after-semicolon", "O0001\n; G00 X5\nM30\n", (2, "(G00 X5)")),
    ("after-end", "O0001\nM30\n%\nnotes\nmore\n", (4, "")),
    ("colon-name", ":0012\nG00 X5\nM30\n", (1, "O0012")),
    (
        "thread-run-in",
        "M03 S1000 T0101\nG00 X22 Z1\nG92 X19 Z-20 F3\nM30\n",
        (2, "G00 X22 Z2.6"),
    ),
    (
        "thread-surface-speed",
        "M03 G96 S100 T0101\nG00 X40 Z20\nG92 X39 Z-20 F1\nX38.5\nM30\n",
        (3, "G97 S816"),
    ),
    (
        "thread-speed-changed",
        "M03 S100 T0101\nG00 X40 Z20\nG92 X39 Z-20 F1\nX38.5 S200\nX38\nM30\n",
        (4, "X38.5"),
    ),
    ("short-dwell", "G04 P5\nM30\n", (1, "G04 P5000")),
    ("010", "O0001\nG21 G00 X5\nM30\n", (2, "G00 X5")),
    ("010", "O0001\nG18 ;\nG00 X5\nM30\n", (2, "G00 X5")),
    (
        "010",
        "M03 S100\nG95 G01 X5 F0.1 T0101\nM30\n",
        (2, "G99 G01 X5 F0.1 T0101"),
    ),
    ("019", "O0001\nG00 X5\nM02\n", (3, "M30")),
    ("019", "M07\nM30\n", (1, "M08")),
    ("019", "T0101 M06\nM30\n", (1, "T0101")),
    (
        "009",
        "M03 S100 T0101\nG00 X20 Z9\nG32 Z-5 E1.5\nM30\n",
        (3, "G32 Z-5 F1.5"),
    ),
    ("006", "G00 X20,5\nM30\n", (1, "G00 X20.5")),
    (
        "009",
        "M03 S500 T0101\nG00 X62 Z2\nN9 G71 P10 Q20 U0.4 W0.1 D2000 F120\nN10 G00 X20\n\
         N20 G01 Z-5\nM30\n",
        (3, "N9 G71 U2"),
    ),
];

/// Warnings without a fix, because more than one edit may be right.
const UNFIXED: [&str; 15] = [
    "end-elsewhere",
    "insert-edge",
    "insert-feed",
    "ladder-code",
    "long-overhang",
    "size-error",
    "axis-force",
    "chuck-grip",
    "machine-zero",
    "nose-radius-zero",
    "nose-uncompensated",
    "spindle-power",
    "spindle-torque",
    "tool-life",
    "unreachable-block",
];

/// Applies the first fix of the finding with `code`; returns the text and its findings.
fn fixed(code: &str, text: &str, analyse: &dyn Fn(&str) -> Analysis) -> (TextDocument, Analysis) {
    let found = analyse(text);
    let finding = found.findings.iter().find(|it| it.code == code);
    let finding = finding.unwrap_or_else(|| panic!("{code}: {:?} in {text}", found.findings));
    let fix = finding.fixes.first();
    let fix = fix.unwrap_or_else(|| panic!("{code}: no fix in {text}: {finding:?}"));
    let mut document = TextDocument::new(text);
    document.apply_all(&fix.changes);
    let after = analyse(document.as_str());
    let before = codes(&found.findings);
    for now in codes(&after.findings) {
        assert!(
            now != code && before.contains(&now),
            "{now} in {document:?}"
        );
    }
    (document, after)
}

#[test]
fn each_fix_removes_its_warning_and_brings_no_other() {
    for (code, text, (line, wanted)) in CASES {
        let (document, _) = fixed(code, text, &analysis);
        assert_eq!(document.line(line - 1), *wanted, "{code}: {document:?}");
    }
}

#[test]
fn every_lint_has_a_fix_or_a_reason() {
    let fixed: BTreeSet<&str> = CASES.iter().map(|(code, ..)| *code).collect();
    for lint in Lint::ALL {
        let (is_fixed, is_unfixed) = (fixed.contains(lint.id()), UNFIXED.contains(&lint.id()));
        let of_a_mill = lint == Lint::MillWord;
        assert!(is_fixed ^ is_unfixed ^ of_a_mill, "{}", lint.id());
    }
}

#[test]
fn each_foreign_word_of_a_block_has_its_fix() {
    let text = "O0001\nG21 G18 G00 X5 M07\nM30\n";
    let found = analysis(text);
    let titles: Vec<&str> = (found.findings[0].fixes.iter())
        .map(|it| it.title.as_str())
        .collect();
    assert_eq!(titles, ["Delete G21", "Delete G18", "Write M08"]);
    let mut text = text.to_owned();
    for _ in 0..3 {
        let found = analysis(&text);
        let mut document = TextDocument::new(text);
        document.apply_all(&found.findings[0].fixes[0].changes);
        text = document.as_str().to_owned();
    }
    assert_eq!(text, "O0001\nG00 X5 M08\nM30\n");
    assert!(analysis(&text).findings.is_empty());
}

#[test]
fn no_fix_where_no_edit_is_certain() {
    for text in [
        "G54 G00 X5\nM30\n",
        "G20\nM30\n",
        "M03 S500 T0101\nG01 X5 A30 F100\nM30\n",
        "; see (here) G00 X5\nM30\n",
    ] {
        let found = analysis(text);
        assert!(!found.findings.is_empty(), "{text}");
        assert!(
            found.findings.iter().all(|it| it.fixes.is_empty()),
            "{found:?}"
        );
    }
}

#[test]
fn a_word_without_effect_is_deleted_on_a_mill() {
    assert!(ModelId::Gsk980mdi.is_mill());
    let text = "O0001\nG90 G00 X0 Y0 Z2 Q5\nM30\n";
    let (document, _) = fixed("word-without-effect", text, &mill_analysis);
    assert_eq!(document.line(1), "G90 G00 X0 Y0 Z2");
}
