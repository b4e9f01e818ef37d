//! The command line as its users call it: output, messages, exit codes.

// Helpers panic when a file cannot be written or the program cannot be started: the test
// fails.
mod check_and_plot;
mod form;
mod ladder;
mod lessons;
mod load;
mod mill;
mod sheet_and_agent;
mod tools;

use std::path::{Path, PathBuf};
use std::process::Output;

use crate::process::executable;

fn samples_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/programs")
}

fn run_in_samples(arguments: &[&str]) -> Output {
    executable()
        .args(arguments)
        .current_dir(samples_folder())
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .output()
        .unwrap()
}

/// Runs the program. Returns exit code, standard output and standard error.
fn run_gsk(arguments: &[&str]) -> (i32, String, String) {
    let output = run_in_samples(arguments);
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (
        output.status.code().unwrap_or(-1),
        text(&output.stdout),
        text(&output.stderr),
    )
}

/// A temporary file. It is removed when it is dropped.
struct TempFile(PathBuf);

impl TempFile {
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

impl Drop for TempFile {
    fn drop(&mut self) {
        if let Some(folder) = self.0.parent() {
            let _ = std::fs::remove_dir_all(folder);
        }
    }
}

#[test]
fn run_and_check_agree_on_a_sample() {
    let report_of = |command: &str| -> serde_json::Value {
        let (code, out, _) = run_gsk(&[command, "01-stepped-shaft.CNC", "--json"]);
        assert_eq!(code, 0);
        serde_json::from_str(out.lines().last().unwrap()).unwrap()
    };
    let (run, check) = (report_of("run"), report_of("check"));
    for field in [
        "end", "blocks", "moves", "parts", "final", "modal", "t", "spindle",
    ] {
        assert_eq!(run[field], check[field], "{field}");
    }
    let time_of = |value: &serde_json::Value| value["time_s"].as_f64().unwrap();
    assert!((time_of(&run) / time_of(&check) - 1.0).abs() < 0.02);
}

#[test]
fn the_tool_in_position_is_known_before_any_t() {
    let program = TempFile::new("no-t.nc", b"G00 X10\nM30\n");
    for command in ["run", "check"] {
        let (code, out, _) = run_gsk(&[command, program.path(), "--json"]);
        assert!(
            code == 0 && out.contains("\"t\":\"0100\""),
            "{command}: {out}"
        );
    }
}

#[test]
fn an_endless_program_ends_after_one_part() {
    let fields = |command: &str| -> serde_json::Value {
        let (_, out, _) = run_gsk(&[command, "O1031.CNC", "--json"]);
        serde_json::from_str(out.lines().last().unwrap()).unwrap()
    };
    let (run, check) = (fields("run"), fields("check"));
    for field in ["end", "blocks", "moves", "parts", "final", "modal"] {
        assert_eq!(run[field], check[field], "{field}");
    }
}

#[test]
fn a_loop_of_tiny_moves_ends_at_the_limit() {
    let text = b"N1 G01 U0.001 F6000\nG01 U-0.001\nG65 H80 P1\n";
    let program = TempFile::new("tiny-moves.nc", text);
    let limit = ["--most-moves", "20000"];
    let check = ["check", program.path(), "--json"];
    let (code, out, _) = run_gsk(&[&check[..], &limit].concat());
    assert_eq!(code, 1);
    let result: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(result["end"], "limit");
    let moves = result["moves"].as_u64().unwrap();
    assert!((20_000..40_000).contains(&moves), "{moves}");
    let picture = TempFile::new("tiny-moves.svg", b"");
    let plot = ["plot", program.path(), "-o", picture.path()];
    let (code, _, err) = run_gsk(&[&plot[..], &limit].concat());
    assert_eq!(code, 1);
    assert!(err.contains("no end within the limits"), "{err}");
    assert!(std::fs::metadata(picture.path()).unwrap().len() < 10_000);
}

#[test]
fn an_alarm_names_line_and_rule_and_ends_with_1() {
    let (code, out, _) = run_gsk(&["check", "faulty/01-arc-too-small.CNC"]);
    assert_eq!(code, 1);
    assert!(
        out.contains("013 圆弧数据有错误!") && out.contains("line 8"),
        "{out}"
    );
    assert!(out.contains("radius 5.000"), "{out}");
}

#[test]
fn moves_are_one_json_object_a_line() {
    let (code, out, report) = run_gsk(&["check", "01-stepped-shaft.CNC", "--moves", "-", "--json"]);
    assert_eq!(code, 0);
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["end"], "M30", "the report stands aside");
    let lines: Vec<serde_json::Value> = out
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(lines.len(), 50);
    for field in ["line", "n", "kind", "x0", "z0", "x", "z", "t", "dt"] {
        assert!(lines[0].get(field).is_some(), "{field}");
    }
}

#[test]
fn a_subprogram_before_its_caller_is_not_the_main_program() {
    let text = b"O0002\nG00 X10\nM99\nO0001\nG00 X50 Z0\nM98 P0002\nM30\n";
    let program = TempFile::new("called-first.nc", text);
    let (code, out, err) = run_gsk(&["check", program.path(), "--json"]);
    assert_eq!(code, 0, "{out}");
    let result: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(
        (&result["end"], &result["moves"]),
        (&"M30".into(), &2.into())
    );
    assert!(err.contains("O0001 is run"), "{err}");
}

#[test]
fn likely_mistakes_raise_warnings() {
    let text = b"T0100\nG00 X50 Z0\nG98 G01 Z-1 F0.2\nZ-2\nM30\n";
    let program = TempFile::new("slips.nc", text);
    let (code, out, _) = run_gsk(&["check", program.path()]);
    assert_eq!(code, 0, "{out}");
    for mistake in [
        "line 3: G98 is active",
        "line 3: a cut while the spindle is stopped",
        "line 3: a tool was called, but the cut has no tool offset",
    ] {
        assert_eq!(out.matches(mistake).count(), 1, "{mistake} {out}");
    }
    let (_, out, _) = run_gsk(&["check", program.path(), "--spindle", "500"]);
    assert!(!out.contains("spindle is stopped"), "{out}");
}

#[test]
fn control_characters_of_a_name_are_escaped() {
    let program = TempFile::new("a\u{1b}[31m.nc", b"G01 X5\n");
    let (code, out, _) = run_gsk(&["check", program.path()]);
    assert_eq!(code, 1);
    assert!(
        !out.contains('\u{1b}') && out.contains("\\u001b[31m"),
        "{out}"
    );
}

#[test]
fn explain_gives_the_formula_of_a_pass() {
    let program = TempFile::new(
        "g71.nc",
        b"G00 X62 Z2\nG71 U4 R1\nG71 P10 Q20 U0.4 W0.1 F150\nN10 G00 X20\nG01 Z-20\nN20 X62\nM30\n",
    );
    let (code, out, _) = run_gsk(&["run", program.path(), "--explain"]);
    assert_eq!(code, 0, "{out}");
    assert!(
        out.contains("G71 pass 1 of 6 at 54.4: depth 4.000, left 17.000"),
        "{out}"
    );
    assert!(out.contains("X1 = 62.400 -8.000·1 = 54.400"), "{out}");
}

/// Calls `run` with these options. Returns exit code and report.
fn run_json(program: &TempFile, options: &[&str]) -> (i32, serde_json::Value) {
    let mut arguments = vec!["run", program.path(), "--json"];
    arguments.extend(options);
    let (code, out, error) = run_gsk(&arguments);
    let last = out.lines().last().unwrap_or_default();
    let report = serde_json::from_str(last);
    assert!(report.is_ok(), "{out}{error}");
    (code, report.unwrap())
}

#[test]
fn a_ladder_message_ends_a_run_and_names_the_remedy() {
    let reversal = TempFile::new("m34.nc", b"M3 S500\nM4 S500\nM30\n");
    let chuck = TempFile::new("m12.nc", b"G00 X100\nM12\nM30\n");
    let tool = TempFile::new("t5.nc", b"T0101\nG00 X100\nT0505\nM30\n");
    for (program, options, number, line, remedy) in [
        (&reversal, &[][..], 1010, 2, "M05"),
        (&chuck, &["--param", "164.0=0"], 1013, 2, "164.0 = 1"),
        (&tool, &["--param", "084=8"], 1000, 3, "084"),
    ] {
        let (code, report) = run_json(program, options);
        assert_eq!((code, &report["end"]), (1, &"alarm".into()), "{report}");
        assert_eq!(report["stops"], 0, "{report}");
        let alarm = &report["alarm"];
        assert_eq!(alarm["class"], "PLC");
        assert_eq!(
            (&alarm["number"], &alarm["line"]),
            (&number.into(), &line.into())
        );
        assert!(
            alarm["block"].is_string() && alarm["cause"].is_string(),
            "{alarm}"
        );
        assert!(
            alarm["way_out"].as_str().unwrap().contains(remedy),
            "{alarm}"
        );
    }
    let (code, out, _) = run_gsk(&["check", reversal.path()]);
    assert!(
        code == 1 && out.contains("PLC 1010") && out.contains("line 2"),
        "{out}"
    );
    let (code, out, _) = run_gsk(&["check", chuck.path(), "--param", "164.0=0"]);
    assert!(code == 1 && out.contains("PLC 1013"), "{out}");
}

#[test]
fn the_wait_condition_is_named() {
    let chuck = TempFile::new("wait.nc", b"M12\nM30\n");
    let open = ["--input", "X1.1=0", "--input", "X1.2=0"];
    let run_with = |options: &[&str]| {
        let mut all = vec!["--limit", "20s"];
        all.extend(options);
        run_json(&chuck, &all)
    };
    let (code, report) = run_with(&[&open[..], &["--param", "168.2=1"]].concat());
    let wait_text = report["waits_for"].as_str().unwrap_or_default();
    assert!(code == 1 && report["end"] == "limit", "{report}");
    assert!(
        wait_text.contains("FIN") && wait_text.contains("M12") && wait_text.contains("chuck"),
        "{wait_text}"
    );

    let (code, report) = run_with(&["--param", "172.5=0", "--input", "X1.5=0"]);
    assert!(code == 1 && report["end"] == "refused", "{report}");
    assert!(
        report["waits_for"]
            .as_str()
            .unwrap_or_default()
            .contains("*SP"),
        "{report}"
    );
}

#[test]
fn the_example_of_the_manual_runs_as_printed() {
    let (code, out, _) = run_gsk(&["check", "04-manual-example.CNC"]);
    assert!(code == 0 && out.contains("ended normally (M30)"), "{out}");
    let chuck = TempFile::new("chuck.nc", b"M12\nM3 S300\nM5\nM13\nM3\nM30\n");
    let (code, report) = run_json(&chuck, &[]);
    assert!(code == 0 && report["end"] == "M30", "{report}");
}

#[test]
fn bad_files_are_named_and_end_with_2() {
    let empty = TempFile::new("empty.nc", b"");
    let binary = TempFile::new("binary.nc", &[0, 159, 146, 150, 0, 255, 254, 1, 2, 3]);
    for path in [empty.path(), binary.path(), "no-such-file.nc"] {
        let (code, out, error) = run_gsk(&["check", path]);
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
    let gbk = TempFile::new(
        "gbk.nc",
        b"O0001\n(\xb3\xb5\xb6\xcb\xc3\xe6)\nG00 X10\nM30\n",
    );
    assert_eq!(run_gsk(&["check", gbk.path()]).0, 0);
}

#[test]
fn unknown_parameters_and_values_out_of_range_are_refused() {
    for word in [
        "--param=999=1",
        "--param=22=999999",
        "--param=1.9=1",
        "--param=abc",
    ] {
        let (code, _, error) = run_gsk(&["check", "01-stepped-shaft.CNC", word]);
        assert_eq!(code, 2, "{word}: {error}");
        assert!(!error.is_empty() && !error.contains("panicked"), "{error}");
    }
}

#[test]
fn a_ladder_with_an_error_is_refused_by_line() {
    let ladder = TempFile::new("bad.il", b"LD X0.5\nOUT X1.0\nEND1\nEND2\n");
    let (code, out, error) = run_gsk(&["run", "01-stepped-shaft.CNC", "--ladder", ladder.path()]);
    assert_eq!(code, 2, "{out}{error}");
    assert!(
        error.contains("line 2") && error.contains("standard ladder"),
        "{error}"
    );
}

#[test]
fn a_script_is_checked_line_by_line() {
    let good = TempFile::new("good.txt", "press AUTO\nexpect mode 自动方式\n".as_bytes());
    assert_eq!(run_gsk(&["operate", good.path()]).0, 0);
    let wrong = TempFile::new("wrong.txt", "press AUTO\nexpect mode 编辑方式\n".as_bytes());
    let (code, _, error) = run_gsk(&["operate", wrong.path()]);
    assert_eq!(code, 1);
    assert!(
        error.contains("line 2") && error.contains("自动方式"),
        "{error}"
    );
    let typo = TempFile::new("typo.txt", b"press AUTTO\n");
    let (code, _, error) = run_gsk(&["operate", typo.path()]);
    assert_eq!(code, 2);
    assert!(
        error.contains("line 1") && error.contains("AUTO"),
        "{error}"
    );
}

#[test]
fn without_a_display_the_window_names_the_headless_call() {
    let (code, _, error) = run_gsk(&["--program", "01-stepped-shaft.CNC"]);
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
        let (code, out, error) = run_gsk(arguments);
        assert_eq!(code, 0, "{arguments:?}: {error}");
        assert!(out.lines().count() >= 15, "{arguments:?}");
    }
}

#[test]
fn help_knows_commands_and_symbols() {
    for (question, answer) in [
        (&["help", "022"][..], "Range: 6..15000 mm/min"),
        (
            &["help", "alarm", "31"],
            "Remedy: select or load the program first",
        ),
        (&["help", "g71", "--lang", "zh"], "粗车循环"),
        (&["help", "key", "cs"], "Contact: X25.0"),
        (&["help", "coolant"], "X23.4"),
        (&["help", "check"], "Usage: gsk980td check"),
        (&["help"], "Usage: gsk980td"),
    ] {
        let (code, out, error) = run_gsk(question);
        assert_eq!(code, 0, "{question:?}: {error}");
        assert!(out.contains(answer), "{question:?}: {out}");
    }
    let (code, _, error) = run_gsk(&["help", "xyzzy"]);
    assert_eq!(code, 2);
    assert!(error.contains("no help about \"xyzzy\""), "{error}");
}

/// A data directory that contains a parameter and a program.
fn create_data_directory(name: &str) -> TempFile {
    let script = "press EDIT\npress PRG\ntype O7\npress EOB\ntype G0X17\npress EOB\n";
    let script = TempFile::new(&format!("{name}.txt"), script.as_bytes());
    let data = TempFile::new(name, b"");
    std::fs::remove_file(&data.0).unwrap();
    let (code, _, err) = run_gsk(&["operate", script.path(), "--data", data.path()]);
    assert_eq!(code, 0, "{err}");
    let lines: Vec<&str> = err.lines().collect();
    assert!(
        matches!(lines[..], [done] if done.contains("all 6 lines done")),
        "{err}"
    );
    data
}

#[test]
fn one_unwritable_file_does_not_lose_the_others() {
    let data = create_data_directory("each-for-itself");
    std::fs::remove_dir(data.0.join("transfer")).unwrap();
    std::fs::write(data.0.join("transfer"), "a file in the way").unwrap();
    let script = "press EDIT\npress PRG\ntype O8\npress EOB\npress OUT\nwait 1s\n";
    let script = TempFile::new("in-the-way.txt", script.as_bytes());
    let arguments = ["operate", script.path(), "--data", data.path()];
    let (code, _, err) = run_gsk(&arguments);
    assert_eq!(code, 2, "{err}");
    assert!(err.contains("transfer cannot be written"), "{err}");
    assert!(data.0.join("programs/O0008.CNC").is_file());
    // A file that cannot be opened is reported before the script starts.
    std::fs::remove_file(data.0.join("programs/O0008.CNC")).unwrap();
    let record = data.0.join("missing/record.txt");
    let (code, _, err) =
        run_gsk(&[&arguments[..], &["--record", record.to_str().unwrap()]].concat());
    assert_eq!(code, 2);
    assert!(err.contains("record.txt cannot be written"), "{err}");
    assert!(!data.0.join("programs/O0008.CNC").exists());
}

#[test]
fn a_reading_command_changes_nothing_and_damage_is_reported_once() {
    let data = create_data_directory("read-only");
    let program = data.0.join("programs/O0007.CNC");
    std::fs::write(&program, "O0007;\nG0X71;\n%\n").unwrap();
    let check = ["check", "01-stepped-shaft.CNC", "--data", data.path()];
    for _ in 0..2 {
        let (code, _, err) = run_gsk(&check);
        assert_eq!(code, 0, "{err}");
        assert!(err.contains("O0007.CNC is damaged"), "{err}");
    }
    let script = TempFile::new("power-on.txt", b"wait 1s\nexpect alarm 69\n");
    let operate = ["operate", script.path(), "--data", data.path()];
    let (code, _, err) = run_gsk(&operate);
    assert_eq!(code, 0, "{err}");
    assert!(err.contains("last good copy is used"), "{err}");
    assert!(std::fs::read_to_string(&program).unwrap().contains("G0X17"));
    let (code, _, err) = run_gsk(&operate);
    assert_eq!(code, 1, "told again: {err}");
}

#[test]
fn the_log_goes_to_standard_error_on_request() {
    let program = TempFile::new("log.nc", b"O1;\nG00 X100 Z50;\nM30;\n");
    let path = program.path();
    let (code, out, without_log) = run_gsk(&["check", path]);
    let (logged_code, logged_out, log) = run_gsk(&["check", path, "--log", "info"]);
    assert_eq!((code, &out), (logged_code, &logged_out));
    assert!(!without_log.contains("started"), "{without_log}");
    assert!(log.contains("started version="), "{log}");
    assert!(log.trim_end().ends_with("ended"), "{log}");
    let (code, _, error) = run_gsk(&["check", path, "--log", "loud"]);
    assert_eq!(code, 2);
    assert!(error.contains("`loud` is not a log level"), "{error}");
}
