//! The part on the command line: cutting, measuring, drawing, collisions.

use std::path::{Path, PathBuf};

use crate::process::executable;

fn samples_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/programs")
}

/// Runs the program. Returns exit code, standard output and standard error.
fn run_gsk(arguments: &[&str]) -> (i32, String, String) {
    let output = executable()
        .args(arguments)
        .current_dir(samples_folder())
        .output()
        .unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (
        output.status.code().unwrap_or(-1),
        text(&output.stdout),
        text(&output.stderr),
    )
}

fn parse_last_line(text: &str) -> serde_json::Value {
    serde_json::from_str(text.lines().last().unwrap()).unwrap()
}

struct PartFolder(PathBuf);

impl PartFolder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("gsk980td-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    fn write(&self, name: &str, text: &str) -> String {
        let path = self.0.join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    }
}

impl Drop for PartFolder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

const CRASH: &str =
    "O0009\nG50 X60 Z20\nM03 S500\nT0101\nG00 X40 Z2\nG01 Z-20 F100\nG00 Z-30\nM30\n";

#[test]
fn samples_with_jobs_have_no_collision() {
    for sample in [
        "01-stepped-shaft",
        "02-bushing",
        "03-grooved-pin",
        "04-manual-example",
    ] {
        let program = format!("{sample}.CNC");
        let (code, out, err) = run_gsk(&["check", "--part", "--json", &program]);
        assert_eq!(code, 0, "{sample}: {out}{err}");
        let part = &parse_last_line(&out)["part"];
        assert_eq!(part["job"], format!("{sample}.job.ron"));
        assert_eq!(part["collisions"].as_array().unwrap().len(), 0, "{sample}");
        let volume = |name: &str| part[name].as_f64().unwrap();
        let sum = volume("removed_mm3") + volume("left_mm3");
        assert!((sum / volume("stock_mm3") - 1.0).abs() < 1e-6, "{part}");
    }
}

#[test]
fn a_measured_shaft_has_the_diameters_of_its_program() {
    let (code, out, err) = run_gsk(&["check", "--measure", "--json", "01-stepped-shaft.CNC"]);
    assert_eq!(code, 0, "{err}");
    let report = parse_last_line(&out);
    let features = report["part"]["features"].as_array().unwrap();
    let cylinders: Vec<f64> = features
        .iter()
        .filter(|feature| feature["kind"] == "cylinder")
        .map(|feature| feature["diameter"].as_f64().unwrap())
        .collect();
    assert_eq!(cylinders, [20.0, 30.0, 50.0, 54.0]);
    let (code, out, _) = run_gsk(&["check", "--measure", "--lang", "zh", "01-stepped-shaft.CNC"]);
    assert!(code == 0 && out.contains("⌀30.000"), "{out}");
}

#[test]
fn a_collision_names_its_block_and_has_a_separate_exit_code() {
    let folder = PartFolder::new("crash");
    let program = folder.write("crash.CNC", CRASH);
    for command in [
        &["check", "--part", "--json"][..],
        &["run", "--part", "--json"],
        &["run", "--stop-on-collision", "--json"],
    ] {
        let (code, out, err) = run_gsk(&[command, &[&program]].concat());
        assert_eq!(code, 3, "{command:?}: {out}{err}");
        let report = parse_last_line(&out);
        let collision = &report["part"]["collisions"][0];
        assert_eq!(collision["line"], 7, "{collision}");
        assert_eq!(collision["tool"], 1);
        assert!(collision["depth"].as_f64().unwrap() > 0.5);
        let stops = command.contains(&"--stop-on-collision");
        let end = if stops { "collision" } else { "M30" };
        assert_eq!(report["end"], end);
    }
    let (code, _, _) = run_gsk(&["run", "--json", &program]);
    assert_eq!(code, 0, "without a part nothing is hit");
}

const FACED: &str = "O0004\nT0101 M03 S500\nG00 X52 Z2\nG72 W2 R1\nG72 P10 Q20 U0.2 W0.1 F100\n\
    N10 G00 Z-12\nG01 X30 F60\nZ-6\nX20\nZ0\nN20 Z2\nG70 P10 Q20\nG00 X100 Z100\nM30\n";

#[test]
fn a_faced_part_without_a_job_is_measured_as_programmed() {
    let folder = PartFolder::new("faced");
    let program = folder.write("faced.CNC", FACED);
    let (code, out, err) = run_gsk(&["check", "--measure", "--json", &program]);
    assert_eq!(code, 0, "{out}{err}");
    let report = parse_last_line(&out);
    let features = report["part"]["features"].as_array().unwrap();
    let has_face = |z: f64| {
        let is_at_z = |it: &&serde_json::Value| it["kind"] == "face" && it["z"] == z;
        features.iter().any(|it| is_at_z(&it))
    };
    assert!(has_face(-12.0) && has_face(-6.0), "{features:?}");
}

#[test]
fn the_work_zero_of_a_job_defines_the_machine_zero() {
    let folder = PartFolder::new("zero");
    let text = "O0005\nM03 S500\nT0101\nG00 X46 Z2\nG01 Z-20 F100\nX52\nG28 U0 W0\nM30\n";
    let program = folder.write("zero.CNC", text);
    let (code, out, _) = run_gsk(&["check", "--part", &program]);
    assert!(
        code == 0 && out.contains("not checked for collisions"),
        "{out}"
    );
    // The machine zero is inside the part: the return move cuts through it.
    let job = folder.write(
        "zero.ron",
        "(stock: (form: Bar(diameter: 50), length: 110, overhang: 70), zero: (x: 0, z: 40), \
         tools: {1: (insert: Turning(letter: C, entering: 95, size: 12.7, nose: 0.8), tip: 3)})",
    );
    let (code, _, err) = run_gsk(&["check", "--job", &job, &program]);
    assert!(
        code == 3 && err.contains("work zero is taken from the job"),
        "{err}"
    );
}

#[test]
fn section_and_picture_show_the_part() {
    let folder = PartFolder::new("section");
    let program = folder.write("crash.CNC", CRASH);
    let section = folder.0.join("part.csv");
    let section = section.to_str().unwrap();
    let (code, _, err) = run_gsk(&["check", "--section", section, &program]);
    assert_eq!(code, 3, "{err}");
    let text = std::fs::read_to_string(section).unwrap();
    assert!(text.starts_with("polygon,x,z\n0,"), "{text}");
    let picture = folder.0.join("part.svg");
    let picture = picture.to_str().unwrap();
    let (code, _, err) = run_gsk(&["plot", "--part", &program, "-o", picture]);
    assert_eq!(code, 3, "{err}");
    let svg = std::fs::read_to_string(picture).unwrap();
    assert!(svg.contains("<path fill=\"#dce6f0\""), "{svg}");
}

#[test]
fn an_invalid_job_is_reported_with_line_and_rule() {
    let folder = PartFolder::new("job");
    let program = folder.write("part.CNC", CRASH);
    folder.write(
        "part.job.ron",
        "(\n  stock: (form: Bar(diameter: 40)),\n)\n",
    );
    let (code, _, err) = run_gsk(&["check", "--part", &program]);
    assert!(
        code == 2 && err.contains("part.job.ron") && err.contains("line 2"),
        "{err}"
    );
    let job = folder.write(
        "other.ron",
        "(stock: (form: Bar(diameter: 40), length: 90, overhang: 50), tools: {1: (insert: \
         Drill(diameter: 0, point: 118, reach: 50), tip: 7)})",
    );
    let (code, _, err) = run_gsk(&["check", "--job", &job, &program]);
    assert!(
        code == 2 && err.contains("T01") && err.contains("diameter"),
        "{err}"
    );
    let idle = folder.write("idle.CNC", "O0001\nG00 X10\nM30\n");
    let (code, _, err) = run_gsk(&["check", "--part", &idle]);
    assert!(code == 2 && err.contains("cannot be guessed"), "{err}");
}

#[test]
fn a_solid_is_drawn_in_the_requested_size() {
    let folder = PartFolder::new("solid");
    let picture = folder.0.join("shaft.png");
    let picture = picture.to_str().unwrap();
    let program = "01-stepped-shaft.CNC";
    let (code, _, err) = run_gsk(&[
        "plot", "--solid", program, "-o", picture, "--size", "640x400",
    ]);
    assert_eq!(code, 0, "{err}");
    let bytes = std::fs::read(picture).unwrap();
    // The first chunk of a PNG contains width and height.
    let size = [16, 20].map(|at| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()));
    assert_eq!(size, [640, 400]);
    let lines = folder.0.join("shaft.svg");
    let lines = lines.to_str().unwrap();
    let (code, _, err) = run_gsk(&["plot", "--solid", program, "-o", lines]);
    assert!(code != 0 && err.contains("must end in .png"), "{err}");
    assert!(!Path::new(lines).exists());
}

#[test]
fn the_lathe_in_space_is_drawn_without_a_window_and_as_an_animation() {
    let folder = PartFolder::new("scene");
    let picture = folder.0.join("lathe.png");
    let picture = picture.to_str().unwrap();
    let program = "01-stepped-shaft.CNC";
    let still = [
        "plot", "--scene", program, "-o", picture, "--size", "480x320",
    ];
    let (code, _, err) = run_gsk(&still);
    assert_eq!(code, 0, "{err}");
    let bytes = std::fs::read(picture).unwrap();
    let size = [16, 20].map(|at| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()));
    assert_eq!(size, [480, 320]);
    let has_chunk = |bytes: &[u8], name: &[u8]| bytes.windows(4).any(|it| it == name);
    assert!(!has_chunk(&bytes, b"acTL"));
    let moving = ["--frames", "3", "--camera", "tool"];
    let (code, _, err) = run_gsk(&[&still[..], &moving[..]].concat());
    assert_eq!(code, 0, "{err}");
    let bytes = std::fs::read(picture).unwrap();
    assert!(has_chunk(&bytes, b"acTL") && has_chunk(&bytes, b"fdAT"));
    let (code, _, err) = run_gsk(&["plot", program, "-o", picture, "--frames", "3"]);
    assert!(code != 0 && err.contains("--scene"), "{err}");
}
