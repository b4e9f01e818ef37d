//! The command line as its users call it: outputs, messages, exit codes.

// A file that cannot be written or a program that cannot be started ends the test.
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn samples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/programs")
}

fn gsk980td(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gsk980td"))
        .args(arguments)
        .current_dir(samples())
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .output()
        .unwrap()
}

/// Exit code, standard output, standard error.
fn said(arguments: &[&str]) -> (i32, String, String) {
    let output = gsk980td(arguments);
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (
        output.status.code().unwrap_or(-1),
        text(&output.stdout),
        text(&output.stderr),
    )
}

/// A file with this content, gone at the end of the test.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str, content: &[u8]) -> Self {
        let folder = std::env::temp_dir().join(format!("gsk980td-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join(name), content).unwrap();
        Self(folder.join(name))
    }

    fn path(&self) -> &str {
        self.0.to_str().unwrap()
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        if let Some(folder) = self.0.parent() {
            let _ = std::fs::remove_dir_all(folder);
        }
    }
}

#[test]
fn run_and_check_agree_on_a_sample() {
    let fields = |command: &str| -> serde_json::Value {
        let (code, out, _) = said(&[command, "01-stepped-shaft.CNC", "--json"]);
        assert_eq!(code, 0);
        serde_json::from_str(out.lines().last().unwrap()).unwrap()
    };
    let (run, check) = (fields("run"), fields("check"));
    for field in [
        "end", "blocks", "moves", "parts", "final", "modal", "t", "spindle",
    ] {
        assert_eq!(run[field], check[field], "{field}");
    }
    let time = |value: &serde_json::Value| value["time_s"].as_f64().unwrap();
    assert!((time(&run) / time(&check) - 1.0).abs() < 0.02);
}

#[test]
fn the_tool_in_position_is_known_before_any_t() {
    let program = Scratch::new("no-t.nc", b"G00 X10\nM30\n");
    for command in ["run", "check"] {
        let (code, out, _) = said(&[command, program.path(), "--json"]);
        assert!(
            code == 0 && out.contains("\"t\":\"0100\""),
            "{command}: {out}"
        );
    }
}

#[test]
fn an_endless_program_ends_with_its_part() {
    let fields = |command: &str| -> serde_json::Value {
        let (_, out, _) = said(&[command, "O1031.CNC", "--json"]);
        serde_json::from_str(out.lines().last().unwrap()).unwrap()
    };
    let (run, check) = (fields("run"), fields("check"));
    for field in ["end", "blocks", "moves", "parts", "final", "modal"] {
        assert_eq!(run[field], check[field], "{field}");
    }
}

#[test]
fn an_alarm_names_line_and_rule_and_ends_with_1() {
    let (code, out, _) = said(&["check", "faulty/01-arc-too-small.CNC"]);
    assert_eq!(code, 1);
    assert!(
        out.contains("013 圆弧数据有错误!") && out.contains("line 8"),
        "{out}"
    );
    assert!(out.contains("radius 5.000"), "{out}");
}

#[test]
fn moves_are_one_json_object_a_line() {
    let (code, out, _) = said(&["check", "01-stepped-shaft.CNC", "--moves", "-", "--json"]);
    assert_eq!(code, 0);
    let lines: Vec<serde_json::Value> = out
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(lines.len(), 51, "50 moves and the report");
    for field in ["line", "n", "kind", "x0", "z0", "x", "z", "t", "dt"] {
        assert!(lines[0].get(field).is_some(), "{field}");
    }
}

#[test]
fn explain_gives_the_formula_of_a_pass() {
    let program = Scratch::new(
        "g71.nc",
        b"G00 X62 Z2\nG71 U4 R1\nG71 P10 Q20 U0.4 W0.1 F150\nN10 G00 X20\nG01 Z-20\nN20 X62\nM30\n",
    );
    let (code, out, _) = said(&["run", program.path(), "--explain"]);
    assert_eq!(code, 0, "{out}");
    assert!(
        out.contains("G71 pass 1 of 6 at 54.4: depth 4.000, left 17.000"),
        "{out}"
    );
    assert!(out.contains("X1 = 62.400 -8.000·1 = 54.400"), "{out}");
}

#[test]
fn bad_files_are_named_and_end_with_2() {
    let empty = Scratch::new("empty.nc", b"");
    let binary = Scratch::new("binary.nc", &[0, 159, 146, 150, 0, 255, 254, 1, 2, 3]);
    for path in [empty.path(), binary.path(), "no-such-file.nc"] {
        let (code, out, error) = said(&["check", path]);
        assert_eq!(code, 2, "{path}: {out}{error}");
        assert!(
            error.contains(path) || out.contains(path),
            "{path}: {out}{error}"
        );
        assert!(!error.contains("panicked"), "{error}");
    }
}

#[test]
fn chinese_comments_are_read_in_gbk() {
    // «(车端面)» in GBK.
    let gbk = Scratch::new(
        "gbk.nc",
        b"O0001\n(\xb3\xb5\xb6\xcb\xc3\xe6)\nG00 X10\nM30\n",
    );
    assert_eq!(said(&["check", gbk.path()]).0, 0);
}

#[test]
fn unknown_parameters_and_values_out_of_range_are_refused() {
    for word in [
        "--param=999=1",
        "--param=22=999999",
        "--param=1.9=1",
        "--param=abc",
    ] {
        let (code, _, error) = said(&["check", "01-stepped-shaft.CNC", word]);
        assert_eq!(code, 2, "{word}: {error}");
        assert!(!error.is_empty() && !error.contains("panicked"), "{error}");
    }
}

#[test]
fn a_ladder_with_an_error_is_refused_by_line() {
    let ladder = Scratch::new("bad.il", b"LD X0.5\nOUT X1.0\nEND1\nEND2\n");
    let (code, out, error) = said(&["run", "01-stepped-shaft.CNC", "--ladder", ladder.path()]);
    assert_eq!(code, 2, "{out}{error}");
    assert!(
        error.contains("line 2") && error.contains("standard ladder"),
        "{error}"
    );
}

#[test]
fn a_script_is_checked_line_by_line() {
    let good = Scratch::new("good.txt", "press AUTO\nexpect mode 自动方式\n".as_bytes());
    assert_eq!(said(&["operate", good.path()]).0, 0);
    let wrong = Scratch::new("wrong.txt", "press AUTO\nexpect mode 编辑方式\n".as_bytes());
    let (code, _, error) = said(&["operate", wrong.path()]);
    assert_eq!(code, 1);
    assert!(
        error.contains("line 2") && error.contains("自动方式"),
        "{error}"
    );
    let typo = Scratch::new("typo.txt", b"press AUTTO\n");
    let (code, _, error) = said(&["operate", typo.path()]);
    assert_eq!(code, 2);
    assert!(
        error.contains("line 1") && error.contains("AUTO"),
        "{error}"
    );
}

#[test]
fn without_a_display_the_window_names_the_headless_call() {
    let (code, _, error) = said(&["--program", "01-stepped-shaft.CNC"]);
    assert_eq!(code, 2);
    assert!(
        error.contains("gsk980td run 01-stepped-shaft.CNC"),
        "{error}"
    );
    assert_eq!(error.trim().lines().count(), 1, "one sentence: {error}");
}

#[test]
fn tables_and_pages_are_printed() {
    for arguments in [
        &["keys"][..],
        &["parameters"],
        &["alarms"],
        &["signals"],
        &["faults"],
        &["screen", "--list"],
        &["screen", "pos-abs"],
    ] {
        let (code, out, error) = said(arguments);
        assert_eq!(code, 0, "{arguments:?}: {error}");
        assert!(out.lines().count() >= 15, "{arguments:?}");
    }
}
