//! The output of `check --load` and `load`.

use super::{TempFile, run_gsk};
use crate::common::folder::TempFolder;

const PASS: &[u8] = b"G50 X100 Z50\nG97 G99 M03 S600\nT0101\nG00 X46 Z2\nG01 Z-30 F0.25\nG00 Z5\n\
                      X100 Z50\nM30\n";
const JOB: &[u8] =
    b"(stock: (form: Bar(diameter: 50), length: 110, overhang: 70, grade: \"42CrMo4\"),
    tools: { 1: (insert: Turning(letter: C, entering: 95, size: 12.7, nose: 0.8), tip: 3) })";

#[test]
fn a_load_is_text_json_and_csv() {
    let program = TempFile::new("pass.CNC", PASS);
    let job = TempFile::new("pass.job.ron", JOB);
    let loads = TempFile::new("loads.csv", b"");
    let (path, job) = (program.path(), job.path());
    let (code, out, error) = run_gsk(&["check", path, "--job", job, "--load"]);
    assert_eq!(code, 0, "{out}{error}");
    assert!(out.contains("load in 42CrMo4 (kc1.1 1775"), "{out}");
    assert!(
        out.contains("line 5, T01: ") && out.contains("Ra 2.44 µm"),
        "{out}"
    );
    assert!(!out.contains("no grade"), "{out}");
    let csv = loads.path();
    let (code, out, error) = run_gsk(&["check", path, "--job", job, "--load-csv", csv, "--json"]);
    assert_eq!(code, 0, "{out}{error}");
    let report: serde_json::Value = serde_json::from_str(&out).unwrap();
    let block = &report["load"]["blocks"][0];
    assert_eq!(
        (block["line"].as_u64(), block["tool"].as_u64()),
        (Some(5), Some(1))
    );
    assert_eq!(block["area_mm2"].as_f64(), Some(0.5));
    let rows = std::fs::read_to_string(csv).unwrap();
    let mut rows = rows.lines();
    assert!(rows.next().unwrap().starts_with("t,line,tool,force_n,"));
    let force: f64 = rows
        .nth(20)
        .unwrap()
        .split(',')
        .nth(3)
        .unwrap()
        .parse()
        .unwrap();
    let greatest = block["force_n"].as_f64().unwrap();
    assert!(
        (force / greatest - 1.0).abs() < 0.01,
        "{force} of {greatest}"
    );
    assert!(rows.count() > 30);
}

#[test]
fn a_load_above_the_limit_can_be_denied() {
    let program = TempFile::new("limit.CNC", PASS);
    let job = TempFile::new("limit.job.ron", JOB);
    let machine = TempFile::new("weak.ron", b"(load: (power_kw: 0.5))");
    let arguments = ["check", program.path(), "--job", job.path(), "--load"];
    let arguments = [&arguments[..], &["--machine", machine.path()]].concat();
    let (code, out, _) = run_gsk(&arguments);
    assert_eq!(code, 0, "{out}");
    assert!(out.contains("warning W21: line 5: the cut needs"), "{out}");
    let (code, _, _) = run_gsk(&[&arguments[..], &["--deny", "spindle-power"]].concat());
    assert_eq!(code, 1);
    let wrong = TempFile::new("wrong.ron", b"(load: (power_kw: -1))");
    let (code, _, error) = run_gsk(&["check", program.path(), "--machine", wrong.path()]);
    assert_eq!(code, 2);
    assert!(
        error.contains("load.power_kw: -1 must be above 0"),
        "{error}"
    );
}

#[test]
fn the_tables_name_materials_values_and_sources() {
    let (code, out, _) = run_gsk(&["load", "materials"]);
    assert_eq!(code, 0);
    assert!(out.contains("C45\tP2\tkc1.1 1500\tmc 0.22\tISCAR"), "{out}");
    let (code, out, _) = run_gsk(&["load", "values", "c45", "--diameter", "40"]);
    assert_eq!(code, 0);
    assert!(
        out.contains("roughing: 150~200 m/min, 0.20~0.30 mm a turn"),
        "{out}"
    );
    assert!(out.contains("1194~1592 r/min"), "{out}");
    let (code, out, _) = run_gsk(&["load", "values", "TiAl6V4", "--lang", "zh"]);
    assert_eq!(code, 0);
    assert!(out.contains("精车：30~70 m/min"), "{out}");
    let (code, _, error) = run_gsk(&["load", "values", "wood"]);
    assert_eq!(code, 2);
    assert!(error.contains("wood is not in the table"), "{error}");
    let (code, out, _) = run_gsk(&["form", "turn", "--material", "C45", "--blocks"]);
    assert_eq!(code, 0);
    assert!(out.contains("G96 S175"), "{out}");
}

/// The pass with a feed that no nose of 0.8 mm bears, the pass itself, their jobs, and a lathe with
/// a weak spindle.
fn overload_folder(name: &str) -> TempFolder {
    let folder = TempFolder::new(name);
    let fast = String::from_utf8_lossy(PASS).replace("F0.25", "F1.2");
    let files: [(&str, &[u8]); 6] = [
        ("pass.CNC", fast.as_bytes()),
        ("pass.job.ron", JOB),
        ("slow.CNC", PASS),
        ("slow.job.ron", JOB),
        ("weak.ron", b"(load: (power_kw: 0.1))"),
        (
            "keys.txt",
            b"press AUTO\npress CS\nwait 60s\nexpect fault insert-broken on\n",
        ),
    ];
    for (file, bytes) in files {
        std::fs::write(folder.join(file), bytes).unwrap();
    }
    folder
}

#[test]
fn a_run_breaks_the_insert_or_stalls_if_it_is_requested() {
    let folder = overload_folder("run-overload");
    let run = |options: &str| {
        let (code, out, error) = folder.run(&format!("run --json {options}"));
        let report: serde_json::Value = serde_json::from_str(&out).expect(&error);
        (code, report, error)
    };
    let (code, report, _) = run("pass.CNC --part");
    assert_eq!(code, 0, "{report}");
    assert_eq!(report["part"]["overloads"], serde_json::Value::Null);
    let whole = report["part"]["removed_mm3"].as_f64().unwrap();

    let (code, report, error) = run("pass.CNC --overload");
    assert_eq!((code, report["end"].as_str()), (3, Some("M30")), "{report}");
    assert!(
        error.contains("OVERLOAD: the insert of T01 breaks"),
        "{error}"
    );
    let found = &report["part"]["overloads"];
    assert_eq!(found.as_array().map(Vec::len), Some(1), "{found}");
    assert_eq!(found[0]["line"], 5, "{found}");
    assert_eq!(found[0]["fault"], "insert-broken", "{found}");
    let removed = report["part"]["removed_mm3"].as_f64().unwrap();
    assert!(
        removed < 0.2 * whole,
        "{removed} of {whole}: it cuts no more"
    );

    let (code, report, error) = run("slow.CNC --overload --machine weak.ron");
    assert_eq!(
        (code, report["end"].as_str()),
        (3, Some("overload")),
        "{report}"
    );
    assert_eq!(report["part"]["overloads"][0]["fault"], "spindle-blocked");
    assert!(error.contains("the spindle stalls"), "{error}");
    let (code, _, _) = folder.run("run pass.CNC --overload --link COM1");
    assert_eq!(code, 2, "a real lathe");
}

#[test]
fn a_script_breaks_the_insert_if_it_is_requested() {
    let folder = overload_folder("operate-overload");
    let (code, _, error) = folder.run("operate keys.txt --program pass.CNC");
    assert!(
        code == 1 && error.contains("expect fault insert-broken on"),
        "{error}"
    );
    let (code, _, error) = folder.run("operate keys.txt --program pass.CNC --overload");
    assert_eq!(code, 0, "{error}");
    assert!(
        error.contains("OVERLOAD: the insert of T01 breaks"),
        "{error}"
    );
    assert_eq!(folder.run("operate keys.txt --overload").0, 2, "no program");
}
