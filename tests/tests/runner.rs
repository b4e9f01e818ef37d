//! Tests the case runner itself: it detects differences, verifies known failures and rewrites
//! expectations only on request.

use std::fs;
use std::path::PathBuf;

use gsk_tests::{case_dir, run_case, tree};

/// A case in a temporary folder, removed at the end.
struct TemporaryCase(PathBuf);

impl TemporaryCase {
    fn new(name: &str, files: &[(&str, &str)]) -> Self {
        let path = std::env::temp_dir().join(format!("gsk980td-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).expect("folder");
        for (file, text) in files {
            fs::write(path.join(file), text).expect(file);
        }
        Self(path)
    }
}

impl Drop for TemporaryCase {
    fn drop(&mut self) {
        // A failure leaves a few bytes in the temporary folder.
        let _ = fs::remove_dir_all(&self.0);
    }
}

const PART: (&str, &str) = ("part.nc", "O1;\nG00 X100 Z50;\nM30;\n");
const CASE: (&str, &str) = ("case.ron", "(programs: [\"part.nc\"])");

#[test]
fn a_wrong_move_is_detected_on_both_paths() {
    let wrong = (
        "moves.ndjson",
        "{\"line\":2,\"kind\":\"rapid\",\"x\":100.01,\"z\":50}\n",
    );
    let folder = TemporaryCase::new("wrong", &[PART, CASE, wrong]);
    let failure = run_case(&folder.0, false).expect_err("a difference");
    assert!(failure.contains("check: move 1.x"), "{failure}");
    assert!(failure.contains("run: move 1.x"), "{failure}");
}

#[test]
fn a_missing_move_is_seen() {
    let folder = TemporaryCase::new("missing", &[PART, CASE, ("moves.ndjson", "")]);
    let failure = run_case(&folder.0, false).expect_err("a difference");
    assert!(failure.contains("0 moves expected, 1 seen"), "{failure}");
}

#[test]
fn a_wrong_result_is_seen() {
    let wrong = ("result.json", "{\"end\":\"M30\",\"alarm\":{\"number\":11}}");
    let folder = TemporaryCase::new("result", &[PART, CASE, wrong]);
    let failure = run_case(&folder.0, false).expect_err("a difference");
    assert!(failure.contains("check.alarm"), "{failure}");
}

#[test]
fn a_case_without_expectation_fails() {
    let folder = TemporaryCase::new("nothing", &[PART, CASE]);
    assert!(run_case(&folder.0, false).is_err());
}

#[test]
fn a_failed_expect_shows_its_line_and_the_screen() {
    let case = ("case.ron", "(script: \"operate.txt\")");
    let script = ("operate.txt", "press AUTO\nexpect mode 手动方式\n");
    let folder = TemporaryCase::new("script", &[case, script]);
    let failure = run_case(&folder.0, false).expect_err("a difference");
    assert!(failure.contains("line 2"), "{failure}");
    assert!(failure.contains("自动方式"), "{failure}");
}

#[test]
fn a_wrong_screen_is_seen() {
    let case = ("case.ron", "(script: \"operate.txt\")");
    let script = ("operate.txt", "press AUTO\n");
    let folder = TemporaryCase::new("screen", &[case, script, ("screen.txt", "程序\n")]);
    let failure = run_case(&folder.0, false).expect_err("a difference");
    assert!(failure.contains("R0  expected |程序"), "{failure}");
}

#[test]
fn a_known_failure_passes_until_it_is_fixed() {
    let known = (
        "case.ron",
        "(programs: [\"part.nc\"], known_failure: \"why\")",
    );
    let wrong = ("result.json", "{\"end\":\"M99\"}");
    let folder = TemporaryCase::new("known", &[PART, known, wrong]);
    assert_eq!(run_case(&folder.0, false), Ok(()));
    fs::write(folder.0.join("result.json"), "{\"end\":\"M30\"}").expect("result");
    let failure = run_case(&folder.0, false).expect_err("it passes now");
    assert!(failure.contains("passes now"), "{failure}");
}

#[test]
fn an_update_rewrites_named_fields_only() {
    let wrong = ("moves.ndjson", "{\"line\":2,\"x\":1}\n");
    let folder = TemporaryCase::new("update", &[PART, CASE, wrong]);
    run_case(&folder.0, true).expect("update");
    let text = fs::read_to_string(folder.0.join("moves.ndjson")).expect("moves");
    assert_eq!(text, "{\"line\":2,\"x\":100.0}\n");
    assert_eq!(run_case(&folder.0, false), Ok(()));
}

#[test]
fn an_unreadable_case_is_reported() {
    let folder = TemporaryCase::new("unreadable", &[("case.ron", "(program: [])")]);
    let failure = run_case(&folder.0, false).expect_err("no case");
    assert!(failure.starts_with("case.ron:"), "{failure}");
}

#[test]
fn the_cases_are_in_their_folders_and_no_two_share_a_name() {
    let cases = tree::list_cases().expect("the folders of tests/cases");
    let last = cases.last().expect("cases");
    assert_eq!(case_dir(&last.name).as_ref(), Some(&last.folder));
    assert_eq!(case_dir("no-such-case"), None);
}

#[test]
fn a_folder_at_the_wrong_depth_or_without_a_case_is_named() {
    let folder = TemporaryCase::new("tree", &[]);
    for path in ["cycles/G71/deep/deeper", "cycles/shallow", "threads/G32/a"] {
        fs::create_dir_all(folder.0.join(path)).expect("folder");
        fs::write(folder.0.join(path).join("case.ron"), "").expect("case");
    }
    for path in ["cycles/G72", "cycles/G73/no-case", "motion/G01/a"] {
        fs::create_dir_all(folder.0.join(path)).expect("folder");
    }
    fs::write(folder.0.join("motion/G01/a/case.ron"), "").expect("case");
    let faults = tree::list_cases_in(&folder.0).expect_err("faults");
    let seen: Vec<&str> = faults.lines().collect();
    let depth = "a case lies in cases/<subject>/<code>/<case>/ and nowhere else";
    let nothing = "the folder holds neither a case.ron nor folders";
    assert_eq!(
        seen,
        [
            format!("cases/cycles/G71/deep/deeper: {depth}"),
            format!("cases/cycles/G72: {nothing}"),
            format!("cases/cycles/G73/no-case: {nothing}"),
            format!("cases/cycles/shallow: {depth}"),
            "a: is the name of several cases: motion/G01/a, threads/G32/a".to_owned(),
        ]
    );
}
