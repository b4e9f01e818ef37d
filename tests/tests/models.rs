//! Checks the control models: the codes of each by the lists of their manuals, and the alarm
//! of every code that it does not have.

use std::collections::{BTreeMap, BTreeSet};

use gsk_core::model::{ControlModel, ModelId};
use gsk_core::preview::preview;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_milling::{MillSetup, preview_while};
use gsk_runner::curves::RapidRates;
use gsk_runner::machining::Machining;
use gsk_runner::report::PartReport;
use gsk_tests::case::TestCase;
use gsk_tests::execute::{PathResult, run_check, run_kernel, run_mill_check};
use gsk_tests::tree::{self, CaseFolder};
use gsk_tests::{repository, setup};
use gsk_workpiece::job::Job;
use gsk_workpiece::measure::Feature;

/// G codes by chapter and table, including those adopted from the GSK980TD.
const LATHES: [(ModelId, &[i64]); 3] = [
    (
        ModelId::Gsk980td,
        &[
            0, 1, 2, 3, 4, 28, 32, 33, 34, 40, 41, 42, 50, 65, 70, 71, 72, 73, 74, 75, 76, 90, 92,
            94, 96, 97, 98, 99,
        ],
    ),
    (
        ModelId::Ncb08,
        &[
            0, 1, 2, 3, 4, 27, 28, 32, 33, 34, 50, 65, 70, 71, 72, 73, 74, 75, 76, 90, 92, 94, 96,
            97, 98, 99,
        ],
    ),
    (
        ModelId::Hx31,
        &[
            0, 1, 2, 3, 4, 9, 20, 22, 24, 25, 26, 27, 30, 31, 33, 34, 40, 41, 42, 54, 55, 56, 57,
            71, 72, 73, 74, 75, 76, 81, 82, 83, 84, 85, 86, 87, 90, 91, 92, 96, 97, 98, 99,
        ],
    ),
];

/// The alarm of a program, if it ends with one.
fn alarm_of_program(model: ModelId, text: &str) -> Option<(u16, String)> {
    let mut setup = Setup::default();
    setup.memory.model = ControlModel::new(model);
    // The option of nose radius compensation.
    let option = setup.memory.parameters.set_bit(2, 1, true);
    assert!(option.is_ok(), "002.1");
    let mut programs = setup.memory.programs.clone();
    programs.open_external(Program::new(text));
    let preview = preview(&setup, &programs, &mut |_| {});
    preview.alarm.map(|it| (it.number, it.line_text()))
}

/// Codes are tried without other words: if they need some, the alarm is not 010.
#[test]
fn every_g_code_exists_or_is_alarm_010() {
    for (model, codes) in LATHES {
        for code in 0..100 {
            let text = format!("G{code:02};\nM30;\n");
            let unknown = alarm_of_program(model, &text).is_some_and(|(number, _)| number == 10);
            assert_eq!(unknown, !codes.contains(&code), "{model:?} G{code:02}");
        }
    }
}

#[test]
fn alarms_are_written_as_the_model_writes_them() {
    let shown = |model| {
        alarm_of_program(model, "G91;\n")
            .map(|(_, text)| text)
            .unwrap_or_default()
    };
    assert!(shown(ModelId::Gsk980td).starts_with("P/S 010: "));
    assert!(shown(ModelId::Ncb08).starts_with("E010: "));
}

/// The same contour in the words of each model has the same path.
#[test]
fn the_same_contour_is_the_same_path() {
    let contour = "G00 X40 Z2;\nG01 Z-10 F100;\nG02 X60 Z-20 R10;\nG03 U20 W-10 R10;\nG01 X100 Z-50;\nG00 X120 Z5;\nM30;\n";
    let moves = |model| {
        let mut setup = Setup::default();
        setup.memory.model = ControlModel::new(model);
        let mut programs = setup.memory.programs.clone();
        programs.open_external(Program::new(contour));
        let mut moves = Vec::new();
        let end = preview(&setup, &programs, &mut |it| {
            moves.push((it.source.line, it.kind, it.from, it.to, it.center));
        });
        assert_eq!(end.alarm, None);
        moves
    };
    for other in [ModelId::Ncb08, ModelId::Hx31] {
        assert_eq!(moves(ModelId::Gsk980td), moves(other), "{other:?}");
    }
}

/// The same contour again, in the plane G18 of the mill. Its X are radii, and its R is also
/// written with I and K.
#[test]
fn the_same_contour_is_the_same_path_on_the_mill() {
    let lathe = "G00 X40 Z2;\nG01 Z-10 F100;\nG02 X60 Z-20 R10;\nG03 X80 Z-30 R10;\nG01 X100 Z-50;\nG00 X120 Z5;\nM30;\n";
    let mill = "G18 G00 X20 Z2\nG01 Z-10 F100\nG02 X30 Z-20 R10\nG03 X40 Z-30 I0 K-10\nG01 X50 Z-50\nG00 X60 Z5\nM30\n";
    let setup = Setup::default();
    let mut programs = setup.memory.programs.clone();
    programs.open_external(Program::new(lathe));
    let mut turned = Vec::new();
    let end = preview(&setup, &programs, &mut |it| {
        let center = it.center.map(|center| (center.x, center.z));
        turned.push((it.source.line, it.kind.name(), (it.to.x, it.to.z), center));
    });
    assert_eq!(end.alarm, None);
    programs.open_external(Program::new(mill));
    let mut milled = Vec::new();
    let end = preview_while(
        &MillSetup::default(),
        &programs,
        &mut |it| {
            let [x, _, z] = it.to.mm();
            // The first axis of G18 is Z.
            let center = it.arc.map(|arc| (arc.center.second, arc.center.first));
            milled.push((it.source.line, it.kind.name(), (x, z), center));
        },
        &mut |_| true,
    );
    assert_eq!(end.alarm, None);
    assert_eq!(turned.len(), milled.len());
    let near = |(x, z): (f64, f64), other: (f64, f64)| {
        (x - other.0).abs() < 0.001 && (z - other.1).abs() < 0.001
    };
    for (one, other) in turned.into_iter().zip(milled) {
        assert_eq!((one.0, one.1), (other.0, other.1));
        assert!(near(one.2, other.2), "{one:?} {other:?}");
        match (one.3, other.3) {
            (Some(one), Some(other)) => assert!(near(one, other), "{one:?} {other:?}"),
            (one, other) => assert_eq!(one, other),
        }
    }
}

/// Codes that the mill executes; the other known codes are alarm 010 too.
const MILL: [i64; 58] = [
    0, 1, 2, 3, 4, 9, 10, 15, 16, 17, 18, 19, 20, 21, 27, 28, 29, 30, 31, 33, 37, 40, 41, 42, 43,
    44, 49, 50, 51, 52, 53, 54, 55, 56, 57, 58, 59, 61, 64, 65, 66, 67, 68, 69, 73, 74, 76, 80, 81,
    82, 83, 84, 85, 86, 87, 88, 89, 90,
];

#[test]
fn every_g_code_of_the_mill_exists_or_is_alarm_010() {
    let beyond = [91, 92, 94, 95, 98, 99];
    for code in 0..200 {
        let mut programs = Setup::default().memory.programs;
        programs.open_external(Program::new(format!("G{code:02}\nM30\n")));
        let setup = MillSetup::default();
        let end = preview_while(&setup, &programs, &mut |_| {}, &mut |_| true);
        let unknown = end.alarm.is_some_and(|alarm| alarm.number == 10);
        let there = MILL.contains(&code) || beyond.contains(&code);
        assert_eq!(unknown, !there, "G{code:02}");
    }
}

/// The G codes in the text of a program, without comments.
fn g_codes(text: &str) -> BTreeSet<u8> {
    let mut depth = 0_u32;
    let written: String = text
        .chars()
        .filter(|&letter| {
            depth += u32::from(letter == '(');
            let is_code = depth == 0 && letter != ' ';
            depth -= u32::from(letter == ')' && depth > 0);
            is_code || letter == '\n'
        })
        .collect();
    let codes = written.split('G').skip(1).filter_map(|rest| {
        let end = rest.find(|it: char| !it.is_ascii_digit());
        rest.get(..end.unwrap_or(rest.len()))?.parse().ok()
    });
    codes.collect()
}

#[test]
fn codes_are_found_in_programs() {
    let codes = g_codes("N10G01G054X1(G02)G[3]\nG 54.1 P1 G00");
    assert_eq!(codes.into_iter().collect::<Vec<_>>(), [0, 1, 54]);
}

/// Every code of a model is executed in one of its cases. The codes that it does not have are
/// alarm 010 in the tests of the tables above.
#[test]
fn every_g_code_of_a_model_has_a_case() {
    let mut seen: BTreeMap<&str, BTreeSet<u8>> = BTreeMap::new();
    for CaseFolder { folder, .. } in tree::list_cases().expect("cases") {
        let case = TestCase::read(&folder).expect("case.ron");
        let setup = case.setup.program_setup().expect("set-up");
        let codes = seen
            .entry(setup.memory.model.id().command_word())
            .or_default();
        for name in case.programs.iter().chain(&case.script) {
            codes.extend(g_codes(
                &std::fs::read_to_string(folder.join(name)).expect("text"),
            ));
        }
    }
    for model in [
        ModelId::Gsk980td,
        ModelId::Gsk980mdi,
        ModelId::Hx31,
        ModelId::Ncb08,
    ] {
        let codes = ControlModel::new(model).record().g.keys();
        let missing: Vec<&u8> = codes
            .filter(|code| !seen[model.command_word()].contains(code))
            .collect();
        assert!(missing.is_empty(), "{model:?}: {missing:?}");
    }
}

/// Seconds of the tools in the mill's shop program, as its case computes them.
#[test]
fn the_shop_program_of_the_mill_takes_its_time() {
    const BY_HAND: [(&str, f64); 5] = [
        ("01", 74.475),
        ("02", 84.737),
        ("03", 80.4),
        ("04", 20.4),
        ("05", 16.5),
    ];
    let folder = repository().join("tests/cases/models/gsk980mdi/shop-program-of-a-mill");
    let case = TestCase::read(&folder).expect("case.ron");
    let start = case.setup.program_setup().expect("set-up");
    let mill = case
        .setup
        .mill_setup(&start)
        .expect("set-up")
        .expect("a mill");
    let text = |name: &String| std::fs::read_to_string(folder.join(name)).expect("program");
    let texts: Vec<String> = case.programs.iter().map(text).collect();
    let programs = setup::build_memory(&texts).expect("programs");
    let seen = run_mill_check(&mill, &programs);
    let times = seen.result["tool_times"].as_array().expect("tools");
    // T0 is the tool in the spindle before the first change: it cuts nothing.
    let cutting = |time: &serde_json::Value| {
        let seconds = |kind: &str| time[kind].as_f64().expect("seconds");
        seconds("feed") + seconds("thread")
    };
    let times: Vec<_> = times.iter().filter(|time| cutting(time) > 0.0).collect();
    assert_eq!(times.len(), BY_HAND.len());
    for (time, (tool, by_hand)) in times.into_iter().zip(BY_HAND) {
        assert_eq!(time["tool"], tool);
        let seconds = cutting(time);
        assert!((seconds - by_hand).abs() < 0.002, "{tool}: {seconds}");
    }
}

/// The set-up of a case with these programs.
fn case_setup(case: &str, names: &[&str]) -> Setup {
    let folder = repository().join("tests/cases").join(case);
    let text = |name: &&str| std::fs::read_to_string(folder.join(name)).expect("text");
    let texts: Vec<String> = names.iter().map(text).collect();
    let case = TestCase::read(&folder).expect("case.ron");
    let mut start = case.setup.program_setup().expect("set-up");
    start.memory.programs = setup::build_memory(&texts).expect("program");
    start
}

/// Compares times by tool at feed and in threads, s, with those computed in the program. Every
/// cut takes 0.25 s more at most for its start and end, every pass of a thread a turn and its
/// ends. The preview and the control agree.
fn assert_tool_times(start: &Setup, by_hand: &[(&str, f64, f64, u8)], a_pass: f64) {
    const CUT_ALLOWANCE_S: f64 = 0.25;
    let [checked, executed] = [run_check(start), run_kernel(start)];
    for seen in [&checked, &executed] {
        assert!(seen.result["end"] == "M02" || seen.result["end"] == "M30");
        assert!(seen.result["alarm"].is_null());
    }
    let times = checked.result["tool_times"].as_array().expect("tools");
    assert_eq!(times.len(), by_hand.len(), "{times:?}");
    for (time, (tool, feed, thread, strokes)) in times.iter().zip(by_hand) {
        let strokes = f64::from(*strokes);
        assert_eq!(time["tool"], *tool);
        let seconds = |kind: &str| time[kind].as_f64().expect("seconds");
        let (seen_feed, seen_thread) = (seconds("feed"), seconds("thread"));
        let feeds = *feed - 0.001..feed + strokes * CUT_ALLOWANCE_S + 0.001;
        let threads = *thread - 0.001..thread + strokes * a_pass + 0.001;
        assert!(feeds.contains(&seen_feed), "{time}: by hand {feed}");
        assert!(threads.contains(&seen_thread), "{time}: by hand {thread}");
    }
    let whole = |seen: &PathResult| seen.result["time_s"].as_f64().expect("time");
    let (one, other) = (whole(&checked), whole(&executed));
    assert!((one / other - 1.0).abs() < 0.01, "{one} s, {other} s");
}

#[test]
fn the_shop_program_of_the_ncb08_takes_its_time() {
    let start = case_setup("models/ncb08/flanged-pin", &["main.nc", "o0002.nc"]);
    let by_hand = [
        ("0101", 18.9 + 103.5 + 46.25 + 58.478, 0.0, 1 + 10 + 7),
        ("0202", 31.2 + 30.133, 0.0, 6 + 2),
        ("0303", 0.0, 5.867, 4),
        ("0404", 34.8, 0.0, 3),
    ];
    // At 600 r/min.
    assert_tool_times(&start, &by_hand, 0.1 + 0.05);
}

#[test]
fn the_shop_program_in_macro_b_takes_its_time() {
    let programs = ["main.nc", "o9100.nc", "o9110.nc", "o9010.nc"];
    let start = case_setup("macros/macro-b/family-of-parts", &programs);
    let by_hand = [
        ("0101", 110.375 + 20.026 + 22.5, 0.0, 8 + 10 + 1),
        ("0202", 4.0 * 7.2 + 3.0 * 1.2, 0.0, 8 + 3),
        ("0303", 0.0, 8.8, 4),
    ];
    // At 300 r/min.
    assert_tool_times(&start, &by_hand, 0.2 + 0.05);
}

/// The shop program from its case, and its job.
fn shop_program() -> (Setup, Job) {
    let folder = repository().join("tests/cases/models/hx31/shop-program");
    let start = case_setup("models/hx31/shop-program", &["main.nc"]);
    let text = |name: &str| std::fs::read_to_string(folder.join(name)).expect(name);
    let job: Job = ron::from_str(&text("main.job.ron")).expect("job");
    job.check().expect("job");
    (start, job)
}

/// Seconds of cuts and threads by tool, as computed in the program. Every cut takes a little
/// more for its start and end. Every thread waits for its angle: at most a turn, 0.2 s.
#[test]
fn the_shop_program_takes_its_time() {
    const TURNING: f64 = 32.7 + 112.75 + 53.75 + 38.828;
    const BY_HAND: [(&str, f64, f64); 4] = [
        ("0101", TURNING, 0.0),
        ("0202", 18.4 + 18.4, 0.0),
        ("0303", 5.625, 14.2),
        ("0404", 40.8, 0.0),
    ];
    let (start, _) = shop_program();
    let [checked, executed] = [run_check(&start), run_kernel(&start)];
    let times = checked.result["tool_times"].as_array().expect("tools");
    assert_eq!(times.len(), BY_HAND.len());
    for (time, (tool, feed, thread)) in times.iter().zip(BY_HAND) {
        assert_eq!(time["tool"], tool);
        let seconds = |kind: &str| time[kind].as_f64().expect("seconds");
        // T3 makes three short strokes out and back: most of their time is in the ends.
        let more = if tool == "0303" { 1.2 } else { feed * 0.035 };
        assert!((feed..feed + more).contains(&seconds("feed")), "{time}");
        let turns = if thread > 0.0 { 6.0 * 0.2 } else { 0.001 };
        assert!(
            (thread..thread + turns).contains(&seconds("thread")),
            "{time}"
        );
    }
    let whole = |seen: &PathResult| seen.result["time_s"].as_f64().expect("time");
    let (one, other) = (whole(&checked), whole(&executed));
    assert!((one / other - 1.0).abs() < 0.01, "{one} s, {other} s");
}

/// The remaining part has the sizes that the program names, and nothing was hit.
#[test]
fn the_shop_program_makes_its_part() {
    let (start, job) = shop_program();
    let mut machining = Machining::new(job);
    let rates = RapidRates::from_memory(&start.memory);
    let end = preview(&start, &start.memory.programs, &mut |executed| {
        machining.execute_move(executed, rates);
    });
    assert_eq!(end.alarm, None);
    let part = PartReport::new(&machining, None, true, None);
    assert_eq!(part.collisions, []);
    // From front to back: the pin, the relief, the head with its two grooves, the bar; then
    // the bore. Corners of the grooving insert have 0.1 mm.
    let cylinders: Vec<_> = part
        .features
        .iter()
        .filter_map(|it| match it {
            Feature::Cylinder { diameter, z } if diameter.0 > 0.0 => Some((diameter.0, *z)),
            _ => None,
        })
        .collect();
    let grooves = [
        (26.0, (-27.1, -29.9)),
        (34.0, (-35.1, -37.9)),
        (34.0, (-43.1, -45.9)),
    ];
    for groove in grooves {
        assert!(cylinders.contains(&groove), "{groove:?} of {cylinders:?}");
    }
    let diameters: Vec<f64> = cylinders.iter().map(|(diameter, _)| *diameter).collect();
    assert_eq!(
        diameters,
        [30.0, 26.0, 40.0, 34.0, 40.0, 34.0, 40.0, 50.0, 10.0]
    );
    let faces: Vec<f64> = part
        .features
        .iter()
        .filter_map(|it| match it {
            Feature::Face { z, .. } => Some(*z),
            _ => None,
        })
        .collect();
    assert_eq!(
        faces,
        [0.0, -27.0, -30.0, -35.0, -38.0, -43.0, -46.0, -50.0, -129.0]
    );
    // M30 x 2, and the three marks.
    let threads: Vec<_> = part
        .features
        .iter()
        .filter_map(|it| match it {
            Feature::Thread {
                pitch,
                diameters: (crest, root),
                ..
            } => Some((*pitch, crest.0, root.0)),
            _ => None,
        })
        .collect();
    assert_eq!(threads, [(2.0, 30.0, 27.4), (0.5, 40.0, 39.5)]);
}
