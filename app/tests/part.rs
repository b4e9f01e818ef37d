//! The part on the command line: cutting, measuring, drawing, collisions.

use std::path::{Path, PathBuf};

use crate::process::executable;

fn samples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/programs")
}

/// Runs the program. Returns exit code, standard output and standard error.
fn said(arguments: &[&str]) -> (i32, String, String) {
    let output = executable()
        .args(arguments)
        .current_dir(samples())
        .output()
        .unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (
        output.status.code().unwrap_or(-1),
        text(&output.stdout),
        text(&output.stderr),
    )
}

fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text.lines().last().unwrap()).unwrap()
}

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("gsk980td-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    fn file(&self, name: &str, text: &str) -> String {
        let path = self.0.join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

const CRASH: &str =
    "O0009\nG50 X60 Z20\nM03 S500\nT0101\nG00 X40 Z2\nG01 Z-20 F100\nG00 Z-30\nM30\n";

#[test]
fn samples_are_cut_as_their_jobs_say_and_hit_nothing() {
    for sample in [
        "01-stepped-shaft",
        "02-bushing",
        "03-grooved-pin",
        "04-manual-example",
    ] {
        let program = format!("{sample}.CNC");
        let (code, out, err) = said(&["check", "--part", "--json", &program]);
        assert_eq!(code, 0, "{sample}: {out}{err}");
        let part = &json(&out)["part"];
        assert_eq!(part["job"], format!("{sample}.job.ron"));
        assert_eq!(part["collisions"].as_array().unwrap().len(), 0, "{sample}");
        let volume = |name: &str| part[name].as_f64().unwrap();
        let sum = volume("removed_mm3") + volume("left_mm3");
        assert!((sum / volume("stock_mm3") - 1.0).abs() < 1e-6, "{part}");
    }
}

#[test]
fn a_measured_shaft_has_the_diameters_of_its_program() {
    let (code, out, err) = said(&["check", "--measure", "--json", "01-stepped-shaft.CNC"]);
    assert_eq!(code, 0, "{err}");
    let report = json(&out);
    let features = report["part"]["features"].as_array().unwrap();
    let cylinders: Vec<f64> = features
        .iter()
        .filter(|feature| feature["kind"] == "cylinder")
        .map(|feature| feature["diameter"].as_f64().unwrap())
        .collect();
    assert_eq!(cylinders, [20.0, 30.0, 50.0, 54.0]);
    let (code, out, _) = said(&["check", "--measure", "--lang", "zh", "01-stepped-shaft.CNC"]);
    assert!(code == 0 && out.contains("⌀30.000"), "{out}");
}

#[test]
fn a_collision_has_its_block_and_an_exit_code_of_its_own() {
    let folder = Folder::new("crash");
    let program = folder.file("crash.CNC", CRASH);
    for command in [
        &["check", "--part", "--json"][..],
        &["run", "--part", "--json"],
        &["run", "--stop-on-collision", "--json"],
    ] {
        let (code, out, err) = said(&[command, &[&program]].concat());
        assert_eq!(code, 3, "{command:?}: {out}{err}");
        let report = json(&out);
        let collision = &report["part"]["collisions"][0];
        assert_eq!(collision["line"], 7, "{collision}");
        assert_eq!(collision["tool"], 1);
        assert!(collision["depth"].as_f64().unwrap() > 0.5);
        let stopped = command.contains(&"--stop-on-collision");
        let end = if stopped { "collision" } else { "M30" };
        assert_eq!(report["end"], end);
    }
    let (code, _, _) = said(&["run", "--json", &program]);
    assert_eq!(code, 0, "without a part nothing is hit");
}

const FACED: &str = "O0004\nT0101 M03 S500\nG00 X52 Z2\nG72 W2 R1\nG72 P10 Q20 U0.2 W0.1 F100\n\
    N10 G00 Z-12\nG01 X30 F60\nZ-6\nX20\nZ0\nN20 Z2\nG70 P10 Q20\nG00 X100 Z100\nM30\n";

#[test]
fn a_faced_part_without_a_job_is_measured_as_programmed() {
    let folder = Folder::new("faced");
    let program = folder.file("faced.CNC", FACED);
    let (code, out, err) = said(&["check", "--measure", "--json", &program]);
    assert_eq!(code, 0, "{out}{err}");
    let report = json(&out);
    let features = report["part"]["features"].as_array().unwrap();
    let face = |z: f64| {
        let is_there = |it: &&serde_json::Value| it["kind"] == "face" && it["z"] == z;
        features.iter().any(|it| is_there(&it))
    };
    assert!(face(-12.0) && face(-6.0), "{features:?}");
}

#[test]
fn the_work_zero_of_a_job_says_where_the_machine_zero_lies() {
    let folder = Folder::new("zero");
    let text = "O0005\nM03 S500\nT0101\nG00 X46 Z2\nG01 Z-20 F100\nX52\nG28 U0 W0\nM30\n";
    let program = folder.file("zero.CNC", text);
    let (code, out, _) = said(&["check", "--part", &program]);
    assert!(
        code == 0 && out.contains("not checked for collisions"),
        "{out}"
    );
    // The machine zero is inside the part: the return move cuts through it.
    let job = folder.file(
        "zero.ron",
        "(stock: (form: Bar(diameter: 50), length: 110, overhang: 70), zero: (x: 0, z: 40), \
         tools: {1: (insert: Turning(letter: C, entering: 95, size: 12.7, nose: 0.8), tip: 3)})",
    );
    let (code, _, err) = said(&["check", "--job", &job, &program]);
    assert!(
        code == 3 && err.contains("work zero is taken from the job"),
        "{err}"
    );
}

#[test]
fn section_and_picture_show_the_part() {
    let folder = Folder::new("section");
    let program = folder.file("crash.CNC", CRASH);
    let section = folder.0.join("part.csv");
    let section = section.to_str().unwrap();
    let (code, _, err) = said(&["check", "--section", section, &program]);
    assert_eq!(code, 3, "{err}");
    let text = std::fs::read_to_string(section).unwrap();
    assert!(text.starts_with("polygon,x,z\n0,"), "{text}");
    let picture = folder.0.join("part.svg");
    let picture = picture.to_str().unwrap();
    let (code, _, err) = said(&["plot", "--part", &program, "-o", picture]);
    assert_eq!(code, 3, "{err}");
    let svg = std::fs::read_to_string(picture).unwrap();
    assert!(svg.contains("<path fill=\"#dce6f0\""), "{svg}");
}

#[test]
fn a_wrong_job_is_named_with_its_line_and_its_rule() {
    let folder = Folder::new("job");
    let program = folder.file("part.CNC", CRASH);
    folder.file(
        "part.job.ron",
        "(\n  stock: (form: Bar(diameter: 40)),\n)\n",
    );
    let (code, _, err) = said(&["check", "--part", &program]);
    assert!(
        code == 2 && err.contains("part.job.ron") && err.contains("line 2"),
        "{err}"
    );
    let job = folder.file(
        "other.ron",
        "(stock: (form: Bar(diameter: 40), length: 90, overhang: 50), tools: {1: (insert: \
         Drill(diameter: 0, point: 118, reach: 50), tip: 7)})",
    );
    let (code, _, err) = said(&["check", "--job", &job, &program]);
    assert!(
        code == 2 && err.contains("T01") && err.contains("diameter"),
        "{err}"
    );
    let idle = folder.file("idle.CNC", "O0001\nG00 X10\nM30\n");
    let (code, _, err) = said(&["check", "--part", &idle]);
    assert!(code == 2 && err.contains("no stock to guess"), "{err}");
}

#[test]
fn a_solid_is_drawn_as_pixels_of_the_size_that_is_asked_for() {
    let folder = Folder::new("solid");
    let picture = folder.0.join("shaft.png");
    let picture = picture.to_str().unwrap();
    let program = "01-stepped-shaft.CNC";
    let (code, _, err) = said(&[
        "plot", "--solid", program, "-o", picture, "--size", "640x400",
    ]);
    assert_eq!(code, 0, "{err}");
    let bytes = std::fs::read(picture).unwrap();
    // The first chunk of a PNG contains width and height.
    let size = [16, 20].map(|at| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()));
    assert_eq!(size, [640, 400]);
    let lines = folder.0.join("shaft.svg");
    let lines = lines.to_str().unwrap();
    let (code, _, err) = said(&["plot", "--solid", program, "-o", lines]);
    assert!(code != 0 && err.contains("ends in .png"), "{err}");
    assert!(!Path::new(lines).exists());
}
