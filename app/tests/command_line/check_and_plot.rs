//! The output of `check` and `plot`.

use std::path::Path;

use super::{TempFile, run_gsk, samples_folder};
use crate::process::executable;

#[test]
fn all_alarms_of_a_program_are_listed() {
    let text = b"M03 S500\nG54\nG00 X50 Z2 C1\nM98 P0777\nG93\nM30\n";
    let program = TempFile::new("more.nc", text);
    let (code, out, _) = run_gsk(&["check", program.path()]);
    assert_eq!(code, 1, "{out}");
    for line in [
        "\n  P/S 010 ",
        "\n  also P/S 009 ",
        "\n  also P/S 078 ",
        "\n  the program after line 4 was not checked\n",
    ] {
        assert_eq!(out.matches(line).count(), 1, "{line} {out}");
    }
    let (code, out, _) = run_gsk(&["check", program.path(), "--json"]);
    assert_eq!(code, 1, "{out}");
    let report: serde_json::Value = serde_json::from_str(&out).unwrap();
    let alarms = report["more_alarms"].as_array().unwrap();
    let numbers: Vec<_> = alarms
        .iter()
        .map(|it| (&it["number"], &it["line"]))
        .collect();
    assert_eq!(report["alarm"]["number"], 10);
    assert_eq!(numbers, [(&9.into(), &3.into()), (&78.into(), &4.into())]);
    assert_eq!(report["unchecked_behind"], 4);
}

#[test]
fn check_reports_in_chinese_and_english() {
    let text = b"G00 X50 Z2\nG01 Z-5 F100\nG54\nG28 U0 W0\nM77\nM00\nM98 P0777\n";
    let program = TempFile::new("tongues.nc", text);
    let check = |language: &str| run_gsk(&["check", program.path(), "--lang", language]).1;
    let (english, chinese) = (check("en"), check("zh"));
    for line in [
        "P/S 010 G code cannot be used, line 3: G54\n  G54 is not a code",
        "also P/S 019 M code error, line 5: M77\n",
        "warning W02: line 2: a cut while the spindle is stopped\n",
    ] {
        assert!(english.contains(line), "{line}\n{english}");
    }
    let is_foreign = |letter: char| !letter.is_ascii() && letter != '\u{2026}';
    assert!(!english.contains(is_foreign), "{english}");
    for line in [
        "P/S 010 \u{6307}\u{4ee4}",
        "，第 3 行：G54\n  本系统没有 G54",
        "另有 P/S 019",
        "警告 W02：第 2 行：切削时主轴没有旋转\n",
        "警告 W04：第 4 行：G28 返回机械零点，未给出 --work-zero 时",
        "第 7 行之后未检查",
        "刀路范围 X 50 … 300",
    ] {
        assert!(chinese.contains(line), "{line}\n{chinese}");
    }
    // Without the options no English word remains. Codes are capital letters.
    let remainder = chinese
        .replace(program.path(), "")
        .replace("--work-zero", "")
        .replace("mm", "");
    assert!(
        !remainder.contains(|letter: char| letter.is_ascii_lowercase()),
        "{remainder}"
    );
    let report_keys = |language: &str| -> (Vec<String>, serde_json::Value) {
        let (_, out, _) = run_gsk(&["check", program.path(), "--json", "--lang", language]);
        let report: serde_json::Value = serde_json::from_str(&out).unwrap();
        let keys = report.as_object().unwrap().keys().cloned().collect();
        (keys, report["alarm"]["text"].clone())
    };
    let ((one, text), (other, chinese)) = (report_keys("en"), report_keys("zh"));
    assert_eq!(one, other);
    assert_eq!(text, "G code cannot be used");
    assert_ne!(text, chinese);
}

/// The points of the rapid moves in an SVG picture, X as a diameter. The labels of the grid
/// give the scale.
fn rapid_points(svg: &str) -> Vec<(f64, f64)> {
    let value = |text: &str, name: &str| -> f64 {
        let attribute = text.split_once(&format!(" {name}=\"")).unwrap().1;
        attribute.split('"').next().unwrap().parse().unwrap()
    };
    // A grid line: its pixel and its label. The lines along Z come first.
    let scale_of = |across: &str, along: &str| {
        let lines = svg
            .lines()
            .filter(|line| line.contains("</text>") && line.starts_with("<line"));
        let lines = lines.filter(|line| {
            value(line, &format!("{across}1")) == value(line, &format!("{across}2"))
        });
        let lines = lines
            .filter(|line| value(line, &format!("{along}1")) != value(line, &format!("{along}2")));
        let ticks: Vec<(f64, f64)> = lines
            .map(|line| {
                let label = line
                    .rsplit_once("</text>")
                    .unwrap()
                    .0
                    .rsplit_once('>')
                    .unwrap()
                    .1;
                (value(line, &format!("{across}1")), label.parse().unwrap())
            })
            .collect();
        let ((from, low), (to, high)) = (ticks[0], *ticks.last().unwrap());
        move |pixel: f64| low + (pixel - from) * (high - low) / (to - from)
    };
    let (z, x) = (scale_of("x", "y"), scale_of("y", "x"));
    let dashed = svg
        .lines()
        .filter(|line| line.starts_with("<polyline") && line.contains("dash"));
    let points = dashed.flat_map(|line| {
        let points = line.split_once("points=\"").unwrap().1;
        points.split('"').next().unwrap().split(' ')
    });
    points
        .map(|point| {
            let (at_z, at_x) = point.split_once(',').unwrap();
            (x(at_x.parse().unwrap()), z(at_z.parse().unwrap()))
        })
        .collect()
}

#[test]
fn the_machine_zero_is_drawn_at_its_position() {
    let text = b"M03 S500\nG00 X50 Z2\nG01 Z-20 F100\nG28 U0 W0\nM30\n";
    let program = TempFile::new("return.nc", text);
    let picture = TempFile::new("return.svg", b"");
    let plot = [
        "plot",
        program.path(),
        "-o",
        picture.path(),
        "--start",
        "100,50",
        "--whole",
    ];
    for (zero, end_point, warnings) in [(None, (0.0, 0.0), 1), (Some("0,-150"), (0.0, 150.0), 0)] {
        let options = zero.map_or(Vec::new(), |zero| vec!["--work-zero", zero]);
        let (code, _, err) = run_gsk(&[&plot[..], &options].concat());
        assert_eq!(code, 0, "{err}");
        assert_eq!(
            err.matches("line 4: G28 goes to the machine zero").count(),
            warnings,
            "{err}"
        );
        let svg = std::fs::read_to_string(picture.path()).unwrap();
        let points = rapid_points(&svg);
        let is_near = |(x, z): (f64, f64)| {
            move |point: &(f64, f64)| (point.0 - x).abs() < 0.5 && (point.1 - z).abs() < 0.5
        };
        assert!(is_near((100.0, 50.0))(&points[0]), "{points:?}");
        let end = points.last().unwrap();
        match zero {
            // The end is unknown: the line leads away from the part to the edge.
            None => {
                let (x, z) = (end.0 - 50.0, end.1 + 20.0);
                assert!(x > 50.0 && (z - x / 2.0).abs() < 0.5, "{points:?}");
            }
            Some(_) => assert!(is_near(end_point)(end), "{points:?}"),
        }
        let check = ["check", program.path(), "--start", "100,50", "--json"];
        let (_, out, _) = run_gsk(&[&check[..], &options].concat());
        let report: serde_json::Value = serde_json::from_str(&out).unwrap();
        let end = serde_json::json!([end_point.0, end_point.1]);
        assert_eq!(report["final"]["abs"], end);
        assert_eq!(report["final"]["machine"], serde_json::json!([0.0, 0.0]));
    }
}

#[test]
fn a_start_beyond_the_slide_is_relative_to_the_work_zero() {
    let program = TempFile::new("beyond.nc", b"M30\n");
    let machine =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/machines/small-flat-bed.ron");
    let options = ["--machine", machine.to_str().unwrap(), "--start", "40,2"];
    let check = ["check", program.path()];
    let (code, _, err) = run_gsk(&[&check[..], &options].concat());
    assert!(
        code == 2 && err.contains("--start: X is beyond"),
        "{code} {err}"
    );
    let zero = ["--work-zero", "-100,-150", "--json"];
    let (code, out, err) = run_gsk(&[&check[..], &options, &zero].concat());
    assert_eq!(code, 0, "{err}");
    let report: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(report["final"]["abs"], serde_json::json!([40.0, 2.0]));
    assert_eq!(
        report["final"]["machine"],
        serde_json::json!([-60.0, -148.0])
    );
}

#[test]
fn the_first_sample_runs_on_the_shipped_lathes() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let sample = root.join("assets/programs/01-stepped-shaft.CNC");
    // These are names of lathes within the program, not of files.
    for machine in ["small-flat-bed", "slant-bed", "bench-lathe"] {
        let run = [
            "run",
            sample.to_str().unwrap(),
            "--machine",
            machine,
            "--json",
        ];
        let (code, out, err) = run_gsk(&run);
        assert!(
            code == 0 && out.contains("\"end\":\"M30\""),
            "{machine}: {out} {err}"
        );
    }
    // Its motor is mounted the other way round: with 008 as delivered Z runs against its command.
    let words = ["--machine", "small-flat-bed", "--param", "8.1=1", "--json"];
    let (code, out, _) = run_gsk(&[&["run", sample.to_str().unwrap()][..], &words].concat());
    assert!(code == 1 && out.contains("207"), "{out}");
}

#[test]
fn errors_in_files_and_options_use_the_requested_language() {
    let program = TempFile::new("wide.nc", "Ｇ00 X1\nM30\n".as_bytes());
    let machine = TempFile::new("no-lathe.ron", b"(x: (ends: (5.0, -5.0)))");
    let missing = format!("{}-gone", program.path());
    for (arguments, english, chinese) in [
        (
            vec!["check", program.path()],
            "(first in line 1) are read as ASCII",
            "（最先在第 1 行）按 ASCII 读入",
        ),
        (
            vec!["check", &missing],
            "there is no such file",
            "没有该文件",
        ),
        (
            vec!["plot", program.path(), "-o", "a.gif"],
            "the name of a picture must end in .png or .svg",
            "图片的名称须以 .png 或 .svg 结尾",
        ),
        (
            vec!["check", program.path(), "--machine", machine.path()],
            "the machine file ",
            "机床文件 ",
        ),
        (
            vec!["check", program.path(), "--input", "Y1.0=1"],
            "only inputs X0.0 to X29.7 can be held",
            "只能强制输入 X0.0 至 X29.7",
        ),
    ] {
        for (language, text) in [("en", english), ("zh", chinese)] {
            let (_, _, err) = run_gsk(&[&arguments[..], &["--lang", language]].concat());
            assert!(err.contains(text), "{arguments:?} {err}");
        }
    }
}

#[test]
fn every_second_of_a_check_belongs_to_a_kind_and_a_tool() {
    let (code, out, _) = run_gsk(&["check", "01-stepped-shaft.CNC", "--json"]);
    assert_eq!(code, 0);
    let report: serde_json::Value = serde_json::from_str(&out).unwrap();
    let kinds = ["rapid", "feed", "thread", "dwell", "other"];
    let sum = |times: &serde_json::Value| -> f64 {
        kinds.iter().map(|kind| times[kind].as_f64().unwrap()).sum()
    };
    let time = report["time_s"].as_f64().unwrap();
    assert!((sum(&report["times"]) - time).abs() < 1e-4, "{out}");
    let tools = report["tool_times"].as_array().unwrap();
    assert!((tools.iter().map(sum).sum::<f64>() - time).abs() < 1e-4);
    assert_eq!(tools[0]["tool"], report["tools"][0].as_str().unwrap());

    let (_, zh, _) = run_gsk(&["check", "01-stepped-shaft.CNC", "--lang", "zh"]);
    assert!(zh.contains("  时间：快速 "), "{zh}");
    let (_, en, _) = run_gsk(&["check", "01-stepped-shaft.CNC", "--lang", "en"]);
    assert!(en.contains("  time of T0101: "), "{en}");
}

#[test]
fn run_operate_and_the_tables_are_chinese_on_request() {
    let program = TempFile::new("speaks.nc", b"O0009\nG00 X40 Z2\nG02 X60 Z2\nM30\n");
    let (code, zh, _) = run_gsk(&["run", program.path(), "--lang", "zh"]);
    assert_eq!(code, 1, "{zh}");
    assert!(zh.contains(": 报警\n") && zh.contains("第 3 行"), "{zh}");
    assert!(zh.contains("没有指定 R，也没有指定 I、K"), "{zh}");
    let (_, en, _) = run_gsk(&["run", program.path()]);
    assert!(en.contains(": ALARM\n") && en.contains("line 3"), "{en}");

    let script = TempFile::new("speaks.txt", b"press MDI\nexpect page oft\n");
    let (code, _, zh) = run_gsk(&["operate", script.path(), "--lang", "zh"]);
    assert_eq!(code, 1, "{zh}");
    assert!(zh.contains("第 2 行") && zh.contains("页面为 "), "{zh}");
    let (_, _, en) = run_gsk(&["operate", script.path()]);
    assert!(en.contains("line 2") && en.contains("the page is "), "{en}");

    let (_, zh, _) = run_gsk(&["faults", "door-open", "--lang", "zh"]);
    let (_, en, _) = run_gsk(&["faults", "door-open"]);
    assert!(
        zh.contains("信息 1015") && en.contains("message 1015"),
        "{zh}{en}"
    );
    let (_, zh, _) = run_gsk(&["alarms", "1015", "--lang", "zh"]);
    assert!(
        zh.contains("原因") && zh.contains("自动方式时防护门打开"),
        "{zh}"
    );
}

#[test]
fn a_picture_has_its_size_its_tools_and_its_numbers() {
    let program = TempFile::new(
        "two-tools.nc",
        b"O0007\nT0101 M03 S800\nG00 X40 Z2\nN10 G01 Z-30 F100\nG00 X80 Z50\nT0202\nG00 X40 Z2\n\
          N20 G01 Z-10\nG00 X80 Z50\nM30\n",
    );
    let picture = TempFile::new("two-tools.svg", b"");
    let plot = |options: &[&str]| {
        let command = ["plot", program.path(), "-o", picture.path()];
        let (code, _, err) = run_gsk(&[&command[..], options].concat());
        (code, err, std::fs::read_to_string(picture.path()).unwrap())
    };
    let (code, err, svg) = plot(&["--size", "1600x900", "--labels", "--lang", "en"]);
    assert_eq!(code, 0, "{err}");
    for part in [
        "width=\"1600\" height=\"900\"",
        ">T0101 0:",
        ">T0202 0:",
        ">rapid<",
        ">N10<",
        ">N20<",
        ">two-tools.nc<",
        ", of that cutting 0:",
    ] {
        assert!(svg.contains(part), "{part} {svg}");
    }
    let (_, _, zh) = plot(&["--whole", "--lang", "zh"]);
    assert!(zh.contains(">快速<") && !zh.contains(">N10<"), "{zh}");
    assert_ne!(svg, zh);

    let (code, err, _) = plot(&["--size", "100x9000"]);
    assert_eq!(code, 2);
    assert!(err.contains("from 480x320 to 7680x7680"), "{err}");
}

#[test]
fn a_picture_shows_dimensions_of_the_part_and_shapes_of_the_tools() {
    let picture = TempFile::new("shaft.svg", b"");
    let plot = |options: &[&str]| {
        let command = ["plot", "01-stepped-shaft.CNC", "-o", picture.path()];
        let (code, _, err) = run_gsk(&[&command[..], options].concat());
        assert_eq!(code, 0, "{err}");
        std::fs::read_to_string(picture.path()).unwrap()
    };
    let plain = plot(&["--part", "--lang", "en"]);
    assert!(
        plain.contains(">T0101 turning C 95° R0.8, 3:27.2<"),
        "{plain}"
    );
    assert!(!plain.contains(">⌀30<"));
    let svg = plot(&["--dimensions"]);
    for part in [">⌀20<", ">⌀30<", ">⌀50<", ">-72<", ">-55<", ">0<"] {
        assert!(svg.contains(part), "{part} {svg}");
    }
    let areas = |svg: &str| svg.matches("<path fill=\"#").count();
    assert!(areas(&plot(&["--tools", "--whole"])) >= areas(&plot(&["--part", "--whole"])) + 4);
}

#[test]
fn picture_options_need_a_picture() {
    let (code, _, err) = run_gsk(&["run", "01-stepped-shaft.CNC", "--labels"]);
    assert_eq!(code, 2);
    assert!(err.contains("--plot"), "{err}");
}

/// Alarms, warnings and a block of a subprogram, formatted for other programs.
#[test]
fn findings_are_formatted_for_editors_and_workflows() {
    let text = b"M98 P0002\nM03 S500\nG54\nG00 X50 Z2\nM05\nG01 Z-5 F100\nM77\nM30\n";
    let program = TempFile::new("main.nc", text);
    let sub = Path::new(program.path()).with_file_name("O0002.CNC");
    std::fs::write(&sub, "O0002\nG01 X10\nM99\n").unwrap();
    let formatted = |format| {
        let (code, out, _) =
            run_gsk(&["check", program.path(), "--lang", "en", "--format", format]);
        assert_eq!(code, 1, "{out}");
        out
    };
    let lines = formatted("github");
    let file = program.path();
    for start in [
        format!("::error file={file},title=PS011::P/S 011 "),
        format!("::error file={file},line=3,title=PS010::P/S 010 "),
        format!("::error file={file},line=7,title=PS019::P/S 019 "),
        format!("::warning file={file},line=6,title=spindle-stands::a cut while"),
    ] {
        let found = lines.lines().filter(|line| line.starts_with(&start));
        assert_eq!(found.count(), 1, "{start}\n{lines}");
    }
    // The line number is one of the subprogram's file.
    assert!(lines.contains("O0002, line 2: G01 X10"), "{lines}");

    let log: serde_json::Value = serde_json::from_str(&formatted("sarif")).unwrap();
    assert_eq!(log["version"], "2.1.0");
    let results = log["runs"][0]["results"].as_array().unwrap();
    assert_eq!(results.len(), lines.lines().count());
    let result_of = |rule: &str| results.iter().find(|it| it["ruleId"] == rule).unwrap();
    let location_of = |rule: &str| result_of(rule)["locations"][0]["physicalLocation"].clone();
    assert_eq!(location_of("PS010")["region"]["startLine"], 3);
    assert_eq!(result_of("spindle-stands")["level"], "warning");
    assert!(location_of("PS011")["region"].is_null());
    let uri = location_of("PS010")["artifactLocation"]["uri"].clone();
    assert!(uri.as_str().unwrap().starts_with("file:///"), "{uri}");
}

#[test]
fn several_programs_end_with_a_summary() {
    let summary = |options: &[&str]| run_gsk(&[&["check", "."], options].concat()).1;
    let last = |out: &str| out.lines().last().unwrap_or_default().to_owned();
    // Three faulty samples, and the four of other models, whose codes this one does not have.
    let english = last(&summary(&[]));
    assert!(
        english.contains(", 7 with an alarm, 0 with a collision, 0 not read"),
        "{english}"
    );
    let chinese = last(&summary(&["--lang", "zh"]));
    assert!(chinese.contains("7 个有报警，0 个有碰撞"), "{chinese}");
    let json = summary(&["--format", "json"]);
    assert!(json.lines().all(|line| line.starts_with('{')), "{json}");
    assert_eq!(json, summary(&["--json"]));
}

#[test]
fn output_is_chinese_on_a_chinese_system() {
    let run_in = |locale: &[(&str, &str)], arguments: &[&str]| {
        let output = executable()
            .args(arguments)
            .env_remove("LC_ALL")
            .env_remove("LC_MESSAGES")
            .env_remove("LANG")
            .envs(locale.iter().copied())
            .current_dir(samples_folder())
            .output()
            .unwrap();
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let shaft = ["check", "01-stepped-shaft.CNC"];
    let with_language = |language| [&shaft[..], &["--lang", language]].concat();
    let english = [("LC_ALL", "C"), ("LANG", "zh_CN.UTF-8")];
    let chinese = [("LANG", "zh_CN.UTF-8")];
    let [zh, en] = ["zh", "en"].map(|it| run_in(&english, &with_language(it)));
    assert_ne!(zh, en);
    assert_ne!(run_in(&english, &shaft), zh);
    assert_eq!(run_in(&chinese, &shaft), zh);
    assert_eq!(run_in(&chinese, &with_language("en")), en);
    assert_eq!(
        run_in(&[("LC_MESSAGES", "zh_TW"), ("LANG", "C")], &shaft),
        zh
    );
}

#[test]
fn help_and_errors_use_the_language_of_the_command_or_the_system() {
    let run = |line: &str, locale: &str| {
        let output = executable()
            .args(line.split(' '))
            .env("LC_ALL", locale)
            .output()
            .unwrap();
        let [out, err] = [output.stdout, output.stderr].map(|it| String::from_utf8(it).unwrap());
        (output.status.code(), out, err)
    };
    for (line, locale, chinese) in [
        ("plot", "C", false),
        ("plot --lang zh", "C", true),
        ("plot", "zh_CN.UTF-8", true),
        ("plot --lang=en", "zh_CN.UTF-8", false),
    ] {
        let texts = match chinese {
            true => [
                "用法： gsk980td plot",
                "画出切去四分之一",
                "缺少以下参数",
                "<文件>",
            ],
            false => [
                "Usage: gsk980td plot",
                "lit solid",
                "were not provided",
                "<FILE>",
            ],
        };
        let (code, out, err) = run(&format!("{line} --help"), locale);
        assert_eq!((code, &*err), (Some(0), ""));
        assert!(out.contains(texts[0]) && out.contains(texts[1]), "{out}");
        assert!(!out.contains('\u{1b}'), "{out}");
        let (code, out, err) = run(line, locale);
        assert_eq!((code, &*out), (Some(2), ""));
        assert!(err.contains(texts[2]) && err.contains(texts[3]), "{err}");
        let topic = line.replace("plot", "help plot");
        let (code, out, _) = run(&topic, locale);
        assert_eq!(code, Some(0));
        assert!(out.contains(texts[1]), "{out}");
    }
    let (code, _, err) = run("--program no-such.nc", "zh_CN.UTF-8");
    assert_eq!(code, Some(2));
    assert!(err.contains("没有该文件"), "{err}");
    let (code, _, err) = run("shaft.CNC", "zh_CN.UTF-8");
    assert_eq!(code, Some(2));
    assert!(
        err.contains("窗口用 `--program shaft.CNC` 打开程序"),
        "{err}"
    );
    let (code, out, _) = run("signals X0.2", "zh_CN.UTF-8");
    assert_eq!(code, Some(0));
    assert!(
        out.starts_with("地址") && out.contains("机床 → PLC  梯形图"),
        "{out}"
    );
}
