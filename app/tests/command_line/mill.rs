//! The command line with programs of a mill.

use super::{TempFile, run_gsk};

const COVER: &[u8] = b"O0001\nT1 M06\nG54 G90 G00 X0 Y0\nG43 H1 Z5\nG01 Z-2 F100\nG03 X0 Y0 I10 F300\nG00 Z50\nM30\n";

#[test]
fn check_and_plot_accept_a_mill() {
    let program = TempFile::new("cover.nc", COVER);
    let options = [
        "--model",
        "gsk980mdi",
        "--mill-zero",
        "54=100,50,-200",
        "--mill-offset",
        "1=80,5",
    ];
    let mut arguments = vec!["check", program.path(), "--json"];
    arguments.extend(options);
    let (code, out, err) = run_gsk(&arguments);
    assert_eq!(code, 0, "{err}");
    let report: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(
        report["final"]["machine"],
        serde_json::json!([100.0, 50.0, -70.0])
    );
    assert_eq!(report["box"]["y"], serde_json::json!([-50.0, 10.0]));
    arguments[2] = "--lang=zh";
    let (_, out, _) = run_gsk(&arguments);
    assert!(out.contains("Y -50 … 10"), "{out}");
    let picture = TempFile::new("cover.svg", b"");
    let mut words = vec!["plot", program.path(), "-o", picture.path()];
    words.extend(options);
    assert_eq!(run_gsk(&words).0, 0);
    let svg = std::fs::read_to_string(picture.path()).unwrap();
    for view in [">XY<", ">XZ<", ">YZ<", ">isometric<"] {
        assert!(svg.contains(view), "{view}");
    }
}

#[test]
fn an_alarm_of_a_mill_names_its_block() {
    let program = TempFile::new("wrong.nc", b"O0001\nG00 X1\nG71 P1 Q2\nM30\n");
    let (code, out, _) = run_gsk(&["check", program.path(), "--model", "gsk980mdi"]);
    assert_eq!(code, 1);
    assert!(
        out.contains("P/S 010") && out.contains("line 3: G71 P1 Q2"),
        "{out}"
    );
}

#[test]
fn a_mill_program_cannot_be_run() {
    let program = TempFile::new("cover.nc", COVER);
    for arguments in [
        &["run", program.path(), "--model", "gsk980mdi"][..],
        &["operate", program.path(), "--model", "gsk980mdi"],
        &["--model", "gsk980mdi"],
    ] {
        let (code, _, err) = run_gsk(arguments);
        assert_eq!(code, 2, "{arguments:?} {err}");
        assert!(err.contains("checked and drawn"), "{arguments:?} {err}");
    }
    for (arguments, option) in [
        (
            &["check", program.path(), "--mill-start", "0,0,0"][..],
            "--mill-start",
        ),
        (
            &[
                "check",
                program.path(),
                "--model",
                "gsk980mdi",
                "--start",
                "1,1",
            ],
            "--start",
        ),
        (
            &[
                "check",
                program.path(),
                "--model",
                "gsk980mdi",
                "--mill-zero",
                "53=1,2,3",
            ],
            "53=1,2,3",
        ),
    ] {
        let (code, _, err) = run_gsk(arguments);
        assert!(code == 2 && err.contains(option), "{arguments:?} {err}");
    }
}

#[test]
fn mill_commands_compute_parameters() {
    let (code, out, _) = run_gsk(&["mill", "gear", "--counts", "131072", "--lead", "4"]);
    assert_eq!((code, out.trim()), (0, "015 = 4096, 016 = 125 (32.768000)"));
    let words = "mill pitch --origin 60 --interval 10 --value 60=6 --value 61=4 -- -10 10";
    let words: Vec<&str> = words.split(' ').collect();
    let (code, out, _) = run_gsk(&words);
    assert_eq!(code, 0);
    assert!(out.contains("-10006") && out.contains("10004"), "{out}");
    let words = "mill pitch --origin 0 --interval 10 --value 0=9 --value 1=7 -- -10 10";
    let words: Vec<&str> = words.split(' ').collect();
    let (code, out, _) = run_gsk(&words);
    assert_eq!(code, 0);
    assert!(out.contains("-10000") && out.contains("10007"), "{out}");
    let file = TempFile::new("negative.ren", b"axis: X\nspacing: 10\n-10 6\n");
    let words = "mill pitch --origin 0 --interval 10 --lang en --ren";
    let mut words: Vec<&str> = words.split(' ').collect();
    words.push(file.path());
    let (code, _, err) = run_gsk(&words);
    assert!(code == 2 && err.contains("lowest number"), "{err}");
}

#[test]
fn a_renishaw_file_is_added_to_the_table_and_exported() {
    let text = b"Axis: Y\nSpacing: 10\nBacklash: 8\n-10 6\n10 4\n20 -1\n";
    let file = TempFile::new("y.ren", text);
    let out_file = TempFile::new("out.ren", b"");
    let command = "mill pitch --origin 60 --interval 10 --value 61=1 --lang en --ren";
    let mut arguments: Vec<&str> = command.split(' ').collect();
    arguments.push(file.path());
    let (code, out, err) = run_gsk(&arguments);
    assert_eq!(code, 0, "{err}");
    for row in [
        "axis Y",
        "number 60 (-010): 6",
        "number 61 (0010): 5",
        "number 62 (0020): -1",
        "034 = 8",
    ] {
        assert!(out.contains(row), "{out}");
    }
    arguments.extend(["--export", out_file.path()]);
    let (code, _, err) = run_gsk(&arguments);
    assert_eq!(code, 0, "{err}");
    let second_arguments = "mill pitch --origin 60 --interval 10 --lang en --ren";
    let mut second_arguments: Vec<&str> = second_arguments.split(' ').collect();
    second_arguments.push(out_file.path());
    assert_eq!(run_gsk(&second_arguments).1, out);
    let off_grid = TempFile::new("z.ren", b"spacing: 10\n-10 6\n15 4\n");
    let with_axis = [&arguments[..], &["--axis", "x"]].concat();
    let (code, _, err) = run_gsk(&with_axis);
    assert!(code == 2 && err.contains("for axis Y"), "{err}");
    let no_axis = TempFile::new("w.ren", b"axis: W\n10 1\n");
    *second_arguments.last_mut().unwrap() = no_axis.path();
    let (code, _, err) = run_gsk(&second_arguments);
    assert!(
        code == 2 && err.contains("W") && err.contains("X, Y, Z"),
        "{err}"
    );
    *arguments.last_mut().unwrap() = file.path();
    let (code, _, err) = run_gsk(&arguments);
    assert!(code != 0, "over what it is read from: {err}");
    second_arguments.pop();
    second_arguments.push(off_grid.path());
    let (code, _, err) = run_gsk(&second_arguments);
    assert!(code == 2 && err.contains('3'), "{err}");
}

#[test]
fn parameters_and_keys_of_a_mill_are_listed() {
    let (code, out, _) = run_gsk(&["parameters", "--model", "gsk980mdi", "520"]);
    assert_eq!(code, 0);
    assert!(out.contains("520.7") && out.contains("NAT"), "{out}");
    assert!(
        out.lines()
            .any(|it| it.starts_with("520.0") && it.contains("no: operator switches")),
        "{out}"
    );
    let (_, out, _) = run_gsk(&["parameters", "--model", "ncb08"]);
    assert!(out.contains("041"), "{out}");
    let (code, out, _) = run_gsk(&[
        "mill",
        "keys",
        "016=01001000",
        "024=00000000",
        "--lang",
        "en",
    ]);
    assert_eq!(
        (code, out.as_str()),
        (0, "016: RST  G\n024: no key is pressed\n")
    );
    let (code, _, err) = run_gsk(&["mill", "keys", "015=00000001"]);
    assert!(code == 2 && err.contains("015"), "{err}");
    let (_, out, _) = run_gsk(&["mill", "homing", "--lang", "en"]);
    assert!(out.contains("032") && out.contains("1246"), "{out}");
    let file = TempFile::new(
        "mill.par",
        b"# of the machine\n1010=4\n40188.6=1\n31=3000\n",
    );
    let words = ["mill", "homing", "--lang", "en", "--params", file.path()];
    let (code, out, _) = run_gsk(&[&words[..], &["--param", "13.3=1"]].concat());
    assert!(code == 0 && out.lines().count() == 5, "{out}");
    assert!(
        out.contains("A: method D (188.6 = 1): moves - at 3000"),
        "{out}"
    );
    let file = TempFile::new("wrong.par", b"31=3000\n32=1\n");
    let (code, _, err) = run_gsk(&["mill", "homing", "--params", file.path(), "--lang", "en"]);
    assert!(code == 2 && err.contains("line 2"), "{err}");
    let (_, out, _) = run_gsk(&["mill", "backlash", "00001010", "--lang", "en"]);
    assert!(out.contains("10000"), "{out}");
}

#[test]
fn tables_of_the_mill_are_searched() {
    // 002:359.
    let (code, out, _) = run_gsk(&["mill", "io", "CN61", "ESP"]);
    assert_eq!(code, 0);
    let row: Vec<&str> = out.lines().last().unwrap().split_whitespace().collect();
    assert_eq!(
        row,
        ["CN61", "6", "X0.5", "ESP", "external", "emergency", "stop"]
    );
    // 002:451, in Chinese.
    let (_, out, _) = run_gsk(&["mill", "io", "X29.5", "--lang", "zh"]);
    assert!(out.contains("主轴倍率波段开关信号 1"), "{out}");
    // 002:2645.
    let (_, out, _) = run_gsk(&["mill", "diagnosis", "DECY"]);
    assert!(out.contains("000.1"), "{out}");
    // 002:2583.
    let (_, out, _) = run_gsk(&["mill", "spindle", "S9999", "MDI"]);
    assert!(out.contains("3741 3742 3743 3744"), "{out}");
    // 002:541-552.
    let (_, out, _) = run_gsk(&["mill", "reference", "188.6"]);
    assert!(out.contains("method D"), "{out}");
    let (code, _, err) = run_gsk(&["mill", "io", "X99.9"]);
    assert_eq!(code, 1);
    assert!(err.contains("X99.9"), "{err}");
    let (_, out, _) = run_gsk(&["mill", "io"]);
    assert!(out.lines().count() > 100);
}

#[test]
fn rough_milling_is_refused_as_missing_here() {
    // 002:1280-1295 names the codes and gives no format.
    for code in ["G110", "G111", "G134", "G135"] {
        let text = format!("O0001\n{code} X10 Y10 Z-5\nM30\n");
        let program = TempFile::new("rough.nc", text.as_bytes());
        let (exit, out, _) = run_gsk(&["check", program.path(), "--model", "gsk980mdi"]);
        assert_eq!(exit, 1);
        assert!(out.contains("not on this PC"), "{code}: {out}");
    }
}

#[test]
fn the_offset_memory_of_the_mill_is_chosen() {
    let text = b"O0001\nG10 P3 R5\nG43 H3 G01 Z10 F500\nM30\n";
    let program = TempFile::new("offsets.nc", text);
    let check = |memory: &str| {
        let model = ["--model", "gsk980mdi", "--mill-memory", memory];
        run_gsk(&[&["check", program.path()], &model[..]].concat())
    };
    assert_eq!(check("a").0, 0);
    let (code, out, _) = check("b");
    assert_eq!(code, 1);
    assert!(
        out.contains("P/S 043") && out.contains("--mill-memory"),
        "{out}"
    );
    let (code, _, err) = run_gsk(&["check", program.path(), "--mill-memory", "a"]);
    assert_eq!(code, 2);
    assert!(err.contains("--mill-memory"), "{err}");
}
