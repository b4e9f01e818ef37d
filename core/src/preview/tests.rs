//! Results of a preview besides the path: further alarms, cautions, the work zero.

use super::{
    Caution, CautionKind, MAX_FURTHER_ALARMS, Preview, preview_beyond_alarms, preview_explained,
};
use crate::command::{ExecutedMove, ProgramId};
use crate::interpreter::Explanation;
use crate::program::{Program, ProgramMemory};
use crate::setup::Setup;
use crate::units::Point;

fn run_preview(setup: &Setup, text: &str) -> (Preview, Vec<ExecutedMove>) {
    let mut programs = ProgramMemory::default();
    programs.open_external(Program::new(text));
    let mut moves = Vec::new();
    let preview = preview_beyond_alarms(
        setup,
        &programs,
        &mut |executed| moves.push(*executed),
        &mut |progress| progress.blocks < 100_000,
    );
    (preview, moves)
}

/// Number and line of each alarm, and the line at which the search ended early.
fn alarms_with(setup: &Setup, text: &str) -> (Vec<(u16, u32)>, Option<u32>) {
    let (preview, _) = run_preview(setup, text);
    let further = &preview.further;
    let all = preview.alarm.iter().chain(&further.alarms);
    let line =
        |source: Option<crate::command::SourcePosition>| source.map_or(0, |source| source.line);
    (
        all.map(|alarm| (alarm.number, line(alarm.source)))
            .collect(),
        further.ends_at.map(|source| source.line),
    )
}

fn alarms(text: &str) -> (Vec<(u16, u32)>, Option<u32>) {
    alarms_with(&Setup::default(), text)
}

#[test]
fn every_wrong_block_is_found() {
    let text = "M03 S500\nG54\nG00 X50 Z2 C1\nG01 Z-5 F100\nM77\nT0199\nG00 X60 Z2\nG02 X62 Z-20 R1\nM30\n";
    let expected = vec![(10, 2), (9, 3), (19, 5), (30, 6), (13, 8)];
    assert_eq!(alarms(text), (expected, None));
}

#[test]
fn all_foreign_words_of_a_block_are_reported_and_the_rest_is_checked() {
    // The text of the block, its alarm, and what its message names.
    let cases: [(&str, u16, &[&str]); 4] = [
        ("G21 G54 G00 X5", 10, &["G21", "G54"]),
        ("G53 X0 Z0 D1 M07", 9, &["D is", "G53", "M07"]),
        ("G01 X5 ,C2 G64", 6, &["','", "C is", "G64"]),
        ("T0101 M06 M01", 18, &["M"]),
    ];
    for (block, number, named) in cases {
        let text = format!("M03 S500\nG00 X50 Z2\n{block}\nG00 X60 Z2\nG55\nM30\n");
        let (preview, _) = run_preview(&Setup::default(), &text);
        let alarms = preview.alarm.iter().chain(&preview.further.alarms);
        let found: Vec<u16> = alarms.map(|it| it.number).collect();
        assert_eq!(found, [number, 10], "{block}");
        let detail = preview.alarm.and_then(|it| it.detail);
        let detail = detail.map(|it| it.text(gsk_messages::Language::En));
        let detail = detail.unwrap_or_default();
        for word in named {
            assert!(detail.contains(word), "{block}: {word} in {detail}");
        }
    }
}

#[test]
fn moves_end_at_the_first_alarm() {
    let text = "M03 S500\nG00 X50 Z2\nG54\nG01 Z-50 F100\nG00 X300 Z300\nM30\n";
    let (preview, moves) = run_preview(&Setup::default(), text);
    assert_eq!(preview.alarm.as_ref().map(|alarm| alarm.number), Some(10));
    assert_eq!((moves.len(), preview.moves), (1, 1));
    assert_eq!(preview.absolute, Point::new(25.0, 2.0));
    assert_eq!(preview.lengths.feed, 0.0);
    assert_eq!(preview.end, super::PreviewEnd::Alarm);
}

#[test]
fn consequences_are_not_listed() {
    for text in [
        // F was in the refused block.
        "M03 S500\nG00 X50 Z2\nG01 Z-5 F100 C1\nZ-10\nX60\nM30\n",
        // The F of a thread is not a feed.
        "M03 S500\nG00 X50 Z2\nG01 Z0 F100 C1\nG92 X49 Z-9 F2\nG01 X60\nM30\n",
        // E was meant to be F.
        "M03 S500\nG00 X50 Z2\nG01 Z-5 E100\nG01 Z-10\nM30\n",
        // A feed is not a lead either.
        "M03 S500\nG00 X50 Z2\nG92 X49 Z-9 F2 C1\nG01 X60 F100\nG92 X48 Z-9\nM30\n",
        // The start of the arc was in the refused block.
        "M03 S500\nG00 X50 Z2\nG01 X20 F100 C1\nG02 X30 Z-3 R5\nM30\n",
        // The same with increments after it, and with the code of group 01.
        "M03 S500\nG00 X50 Z2\nG01 U-30 Z0 F100 C1\nU2 F100\nG03 X30 Z-5 R5\nM30\n",
        // The start of the spindle was in the refused block.
        "M03 S500 C1\nG00 X50 Z2\nG99 G01 Z-5 F0.2\nM30\n",
        "M03 S500 C1\nG00 X50 Z2\nG32 Z-5 F2\nM30\n",
    ] {
        let (found, search_end) = alarms(text);
        assert_eq!((found.len(), search_end), (1, None), "{text} {found:?}");
    }
    // Once a fact is defined again, alarms that depend on it are reported again.
    let text = "M03 S500\nG00 X50 Z2\nG01 X20 F100 C1\nG00 X20 Z0\nG02 X60 Z-3 R5\nM30\n";
    assert_eq!(alarms(text), (vec![(9, 3), (13, 5)], None));
    let text = "M03 S500 C1\nM05\nS300\nG00 X50 Z2\nG99 G01 Z-5 F0.2\nM30\n";
    assert_eq!(alarms(text), (vec![(9, 1), (11, 5)], None));
}

#[test]
fn a_missing_feed_or_spindle_is_reported_once() {
    let text = "M03 S500\nG00 X50 Z2\nG01 Z-5\nZ-10\nX60\nG54\nM30\n";
    assert_eq!(alarms(text), (vec![(11, 3), (10, 6)], None));
    let text = "G00 X50 Z2\nG99 G01 Z-5 F0.2\nZ-10\nM03 S0\nZ-12\nM30\n";
    assert_eq!(alarms(text), (vec![(11, 2), (11, 5)], None));
}

#[test]
fn the_search_ends_at_a_branch() {
    for (text, line) in [
        ("M98 P0777\nG54\nM30\n", 1),
        ("M98 P0777 C1\nG54\nM30\n", 1),
        ("G65 H01 P#999 Q1\nG54\nM30\n", 1),
        ("G65 H80 P77\nG54\nM30\n", 1),
        ("M30 C1\nG54\n", 1),
        ("M99 P77\nG54\n", 1),
        ("M#200 C1\nG54\n", 1),
        (
            "G00 X50 Z2\nG71 U1 R1\nG71 P10 Q20 F100\nN10 G00 X20 Z3\nN20 G01 Z-5\nG54\nM30\n",
            3,
        ),
        (
            "G00 X50 Z2\nG71 U1 R1\nG71 P10 Q20 F100\nN10 G00 X20\nG54\nN20 G01 Z-5\nG93\nM30\n",
            3,
        ),
    ] {
        let (found, search_end) = alarms(text);
        assert_eq!(found.len(), 1, "{text} {found:?}");
        assert_eq!(search_end, Some(found[0].1), "{text}");
        assert!(found[0].1 >= line, "{text} {found:?}");
    }
    // The search ends at an alarm in a profile that G70 executes.
    let text = "M03 S500\nG00 X50 Z2\nG70 P10 Q20\nN10 G00 X20\nG01 Z-5\nN20 X40\nG54\nM30\n";
    assert_eq!(alarms(text), (vec![(11, 5)], Some(5)));
    // G74 has no profile.
    let text = "M03 S500\nG00 X50 Z2\nG74 R1\nG74 Z-20 Q0 F50\nG54\nM30\n";
    let (found, search_end) = alarms(text);
    assert_eq!(
        (found[1..].to_vec(), search_end),
        (vec![(10, 5)], None),
        "{found:?}"
    );
}

#[test]
fn a_called_program_is_reported_once_and_a_loop_ends() {
    let mut programs = ProgramMemory::default();
    assert!(programs.store("O0002\nG54\nM99\n").is_ok());
    programs.open_external(Program::new("M98 P00030002\nM98 P00030002\nG93\nM30\n"));
    assert!(programs.select(ProgramId::External));
    let preview = preview_beyond_alarms(&Setup::default(), &programs, &mut |_| {}, &mut |_| true);
    let lines: Vec<_> = preview
        .further
        .alarms
        .iter()
        .map(|alarm| alarm.number)
        .collect();
    assert_eq!((lines, preview.further.ends_at), (vec![10], None));
    // Only the number of refused blocks ends this loop.
    let (found, search_end) = alarms("N1 G54\nG65 H80 P1\n");
    assert_eq!((found, search_end), (vec![(10, 1)], Some(1)));
}

#[test]
fn the_list_has_an_end() {
    let text = "G54\n".repeat(40) + "M30\n";
    let (preview, _) = run_preview(&Setup::default(), &text);
    assert_eq!(preview.further.alarms.len(), MAX_FURTHER_ALARMS);
    let last = MAX_FURTHER_ALARMS as u32 + 1;
    assert_eq!(
        preview.further.ends_at.map(|source| source.line),
        Some(last)
    );
}

fn with_nose() -> Setup {
    let mut setup = Setup::default();
    assert!(setup.memory.parameters.set_bit(2, 1, true).is_ok());
    let mut row = setup.memory.offsets.get(1);
    (row.r, row.t) = (0.8, 3);
    assert!(setup.memory.offsets.set(1, row).is_ok());
    setup
}

#[test]
fn a_contour_continues_without_its_compensation() {
    // An inner arc smaller than the nose, an arc that is wrong in itself, and the next
    // contour.
    let text = "T0101\nM03 S500\nG00 X50 Z2\nG42 G01 X30 Z0 F100\nZ-10\nG02 X31 Z-10.5 R0.5\n\
                G01 X60\nG02 X62 Z-30 R1\nG40 G00 X100 Z50\nG00 X50 Z2\nG42 G03 X60 Z-3 R5\n\
                G40 G00 X100 Z50\nG54\nM30\n";
    let (found, search_end) = alarms_with(&with_nose(), text);
    assert_eq!(
        (found, search_end),
        (vec![(53, 6), (13, 8), (34, 11), (10, 13)], None)
    );
}

#[test]
fn a_change_of_side_is_no_start() {
    let text = "T0101\nM03 S500\nG00 X50 Z2\nG42 G01 X30 Z0 F100\nZ-5 C1\nG01 X30 Z-5\nG41 G02 X40 Z-10 R5\n\
                G40 G00 X100 Z50\nG42 G03 X60 Z-3 R90\nM30\n";
    let (found, _) = alarms_with(&with_nose(), text);
    assert_eq!(found, [(9, 5), (34, 9)]);
}

#[test]
fn a_profile_after_its_wrong_block_is_not_reported_again() {
    let text = "M03 S500 F100\nG00 X50 Z2\nN10 G00 X20\nG01 Z-5 C1\nN20 X40\nG00 X50 Z2\n\
                G70 P10 Q20\nG54\nM30\n";
    assert_eq!(alarms(text), (vec![(9, 4)], Some(7)));
}

#[test]
fn cautions_after_an_alarm_need_certain_facts() {
    let slips = |text: &str| -> Vec<(CautionKind, u32)> {
        let (preview, _) = run_preview(&Setup::default(), text);
        let cautions = preview.cautions.iter();
        cautions
            .map(|caution| (caution.kind.clone(), caution.source.line))
            .collect()
    };
    let text = "M03 S500 C1\nG00 X50 Z2\nG98 G01 Z-5 F100\nM30\n";
    assert_eq!(slips(text), []);
    let text = "G54\nG00 X50 Z2\nG98 G01 Z-5 F100\nM30\n";
    assert_eq!(slips(text), [(CautionKind::SpindleStopped, 3)]);
}

/// A preset point: X as a diameter, and Z, mm.
type PresetPoint = (f64, f64);

/// Returns, if the program ends at another position than its G50 sets, the line of the G50, its
/// position, and the end position; otherwise `None`.
fn end_elsewhere(setup: &Setup, text: &str) -> Option<(u32, PresetPoint, PresetPoint)> {
    let (preview, _) = run_preview(setup, text);
    preview
        .cautions
        .iter()
        .find_map(|caution| match &caution.kind {
            CautionKind::EndElsewhere { set, end } => Some((caution.source.line, *set, *end)),
            _ => None,
        })
}

#[test]
fn a_program_ends_where_its_preset_begins() {
    let setup = Setup::default();
    let found = |text: &str| end_elsewhere(&setup, text);
    assert_eq!(
        found("O1\nG50 X100 Z50\nG00 X20 Z2\nX120 Z80\nM30\n"),
        Some((2, (100.0, 50.0), (120.0, 80.0)))
    );
    assert_eq!(
        found("T0101\nG50 X100\nG50 Z50\nG00 Z2\nX101.5 Z50\nM99\n"),
        Some((2, (100.0, 50.0), (101.5, 50.0)))
    );
    for text in [
        "G50 X100 Z50\nG00 X20 Z2\nX100 Z50\nM30\n",
        "G50 X100 Z50\nG00 X20 Z2\nX100.8 Z49.2\nM30\n",
        // Only one axis is set.
        "G50 X100\nG00 X20 Z2\nX100 Z80\nM30\n",
        // The tool goes to the same position first, wherever it starts.
        "G00 X300 Z300\nG50 X100 Z50\nG00 X20 Z2\nM30\n",
        "G28 U0 W0\nG50 X100 Z50\nG00 X20 Z2\nM30\n",
        // An intended shift, and a speed limit.
        "G50 U1\nG00 X20 Z2\nM30\n",
        "G50 S2000\nG00 X20 Z2\nM30\n",
        // The position of the machine zero is unknown.
        "G50 X100 Z50\nG00 X20 Z2\nG28 U0 W0\nM30\n",
    ] {
        assert_eq!(found(text), None, "{text}");
    }
}

#[test]
fn a_dropped_offset_shifts_the_next_run() {
    let text = "G50 X100 Z50\nT0101\nG00 X20 Z2\nX100 Z50\nM30\n";
    let mut setup = Setup::default();
    let mut row = setup.memory.offsets.get(1);
    (row.x, row.z) = (4.0, -10.0);
    assert!(setup.memory.offsets.set(1, row).is_ok());
    for (keeps, expected) in [
        (true, None),
        (false, Some((1, (100.0, 50.0), (104.0, 40.0)))),
    ] {
        assert!(setup.memory.parameters.set_bit(4, 3, keeps).is_ok());
        assert_eq!(end_elsewhere(&setup, text), expected, "TOC = {keeps}");
    }
}

#[test]
fn the_work_zero_determines_the_machine_zero() {
    let text = "G00 X50 Z2\nG28 U0 W0\nG28 U0\nM30\n";
    let mut setup = Setup::default();
    let slips = |preview: &Preview| -> Vec<_> {
        let cautions = preview.cautions.iter();
        cautions
            .map(|caution| (caution.kind.clone(), caution.source.line))
            .collect()
    };
    let (preview, _) = run_preview(&setup, text);
    assert_eq!(slips(&preview), [(CautionKind::MachineZero, 2)]);
    assert_eq!(preview.absolute, Point::default());
    // The work zero is at X0 Z-150 of the machine, the tool at X100 Z50 from it.
    (setup.start, setup.absolute) = (Some(Point::new(50.0, -100.0)), Some(Point::new(50.0, 50.0)));
    let (preview, moves) = run_preview(&setup, text);
    assert_eq!(slips(&preview), []);
    assert_eq!(preview.absolute, Point::new(0.0, 150.0));
    assert_eq!(preview.machine, Point::default());
    let ends: Vec<_> = moves.iter().map(|moved| (moved.from, moved.to)).collect();
    let (start, near, zero) = (
        Point::new(50.0, 50.0),
        Point::new(25.0, 2.0),
        Point::new(0.0, 150.0),
    );
    assert_eq!(ends, [(start, near), (near, zero)]);
}

#[test]
fn passes_of_a_cycle_come_with_their_explanations() {
    let mut setup = Setup::default();
    let text = "G00 X44 Z2\nG71 U3 R1\nG71 P1 Q2 F100\nN1 G00 X20\nG01 Z-20\nN2 X40\nM30\n";
    setup.memory.programs.open_external(Program::new(text));
    setup.memory.programs.select(ProgramId::External);
    let mut passes = Vec::new();
    let on_move = &mut |executed: &ExecutedMove, why: Option<&Explanation>| {
        let deep = executed.from.z == 2.0 && executed.to.z < -10.0;
        passes.extend(why.filter(|_| deep).map(|why| (executed.to.x, why.pass)));
    };
    preview_explained(&setup, &setup.memory.programs, on_move, &mut |_| true);
    assert_eq!(passes, [(19.0, 1), (16.0, 2), (13.0, 3), (10.0, 4)]);
}

#[test]
fn threads_dwells_and_noses_are_looked_at() {
    let lints = |setup: &Setup, text: &str| -> Vec<(&'static str, u32)> {
        let (preview, _) = run_preview(setup, text);
        let cautions = preview.cautions.iter();
        cautions
            .map(|caution| (caution.kind.lint().id(), caution.source.line))
            .collect()
    };
    // No.029 = 100 ms: 1000 r/min and a lead of 3 mm need 2.6 mm.
    let setup = Setup::default();
    let cases: [(&str, &[(&str, u32)]); 9] = [
        (
            "M03 S1000\nG00 X30 Z2.5\nG92 X29 Z-20 F3\nX28.5\nM30\n",
            &[("thread-run-in", 3)],
        ),
        (
            "M03 S1000\nG00 X30 Z2.6\nG92 X29 Z-20 F3\nX28.5\nM30\n",
            &[],
        ),
        ("M03 S500\nG00 X30 Z1.4\nG92 X29 Z-20 F3\nM30\n", &[]),
        // The face is not at Z0.
        ("M03 S1000\nG00 X30 Z52\nG92 X29 Z30 F3\nM30\n", &[]),
        (
            "G96 M03 S90\nG00 X30 Z9\nG32 Z-20 F1.5\nM30\n",
            &[("thread-surface-speed", 3)],
        ),
        (
            "M03 S600\nG00 X30 Z6\nG92 X29 Z-20 F3\nS500\nX28.5\nM30\n",
            &[("thread-speed-changed", 5)],
        ),
        (
            "M03 S600 T0100\nG00 X30 Z6\nG92 X29 Z-20 F3\nT0200\nS500\nG92 X28.5 Z-20 F3\nM30\n",
            &[],
        ),
        ("G04 P5\nG04 P0\nM30\n", &[("short-dwell", 1)]),
        ("G04 X0.009\nG04 P20\nM30\n", &[]),
    ];
    for (text, expected) in cases {
        assert_eq!(lints(&setup, text), expected, "{text}");
    }
    let mut setup = Setup::default();
    let mut row = setup.memory.offsets.get(1);
    (row.r, row.t) = (0.8, 3);
    assert!(setup.memory.offsets.set(1, row).is_ok());
    let contour = "T0101 M03 S500\nG00 X40 Z2\nG98 G01 Z-5 F100\n";
    let cases: [(&str, &[(&str, u32)]); 4] = [
        ("X50 Z-20\nG00 X60\nM30\n", &[("nose-uncompensated", 4)]),
        ("X50\nG00 X60\nM30\n", &[]),
        ("T0100\nX50 Z-20\nM30\n", &[("no-offset", 5)]),
        (
            "G00 X60 Z2\nG71 U2 R1\nG71 P10 Q20 U1 W0.1\nN10 G00 X20\nG01 Z-5\nN20 X50 Z-20\n\
             G42 G00 X70 Z3\nG70 P10 Q20\nG40 G00 X60\nM30\n",
            &[],
        ),
    ];
    for (text, expected) in cases {
        assert_eq!(
            lints(&setup, &format!("{contour}{text}")),
            expected,
            "{text}"
        );
    }
}

#[test]
fn compensation_without_a_radius_is_reported_where_radii_are_known() {
    let lines = |setup: &Setup, text: &str| -> Vec<u32> {
        let (preview, _) = run_preview(setup, text);
        let of_kind = |caution: &&Caution| caution.kind == CautionKind::NoseRadiusZero(42);
        let found = preview.cautions.iter().filter(of_kind);
        found.map(|caution| caution.source.line).collect()
    };
    let contour =
        "M03 S500\nG00 X50 Z2\nG42 G98 G01 X30 Z0 F100\nZ-10\nX60\nG40 G00 X100 Z50\nM30\n";
    let program = |tool: &str| format!("{tool}\n{contour}");
    assert!(lines(&with_nose(), &program("T0101")).is_empty());
    assert_eq!(lines(&with_nose(), &program("T0202")), [4]);
    let mut unknown = Setup::default();
    assert!(unknown.memory.parameters.set_bit(2, 1, true).is_ok());
    assert!(lines(&unknown, &program("T0202")).is_empty());
}
