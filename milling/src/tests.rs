//! Runs programs and compares their moves, times and alarms.

use gsk_core::program::{Program, ProgramMemory};
use proptest::prelude::*;

use crate::{MillMove, MillMoveKind, MillPreview, MillSetup, PreviewEnd, preview_while};

/// Runs a program on a setup with subprograms.
fn run_program(setup: &MillSetup, text: &str, others: &[&str]) -> (MillPreview, Vec<MillMove>) {
    let mut programs = ProgramMemory::default();
    for other in others {
        programs.store(*other).expect("subprogram");
    }
    programs.open_external(Program::new(text));
    programs.select(gsk_core::command::ProgramId::External);
    let mut moves = Vec::new();
    let preview = preview_while(setup, &programs, &mut |made| moves.push(*made), &mut |at| {
        at.motionless < 10_000
    });
    (preview, moves)
}

/// Runs a program on the mill as delivered. It must end without an alarm.
fn run_to_end(text: &str) -> (MillPreview, Vec<MillMove>) {
    let (preview, moves) = run_program(&MillSetup::default(), text, &[]);
    assert_eq!(preview.alarm, None, "{text}");
    (preview, moves)
}

/// Returns the number and line of a program's alarm.
fn alarm(text: &str) -> (u16, u32) {
    let (preview, _) = run_program(&MillSetup::default(), text, &[]);
    let alarm = preview.alarm.unwrap_or_else(|| panic!("no alarm: {text}"));
    (alarm.number, alarm.source.map_or(0, |source| source.line))
}

fn with(parameters: &[(u16, i32)]) -> MillSetup {
    let mut setup = MillSetup::default();
    for (number, value) in parameters {
        let set = setup.memory.model.set_parameter(*number, *value);
        assert_eq!(set, Ok(()));
    }
    setup
}

fn ends(moves: &[MillMove]) -> Vec<[f64; 3]> {
    moves.iter().map(|made| made.to.mm()).collect()
}

#[track_caller]
fn assert_near(found: &[[f64; 3]], expected: &[[f64; 3]]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, expected) in found.iter().zip(expected) {
        let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 0.000_6, "{found:?} {expected:?}");
    }
}

#[test]
fn three_axes_absolute_and_in_increments() {
    let (preview, moves) = run_to_end("G90 G00 X10 Y20 Z5\nG91 G01 X1.5 Z-6 F100\nG90 Y0\nM30\n");
    assert_near(
        &ends(&moves),
        &[[10., 20., 5.], [11.5, 20., -1.], [11.5, 0., -1.]],
    );
    assert_eq!((preview.end, preview.parts), (PreviewEnd::M30, 1));
    let bounds = preview.bounds.expect("box");
    assert_eq!(
        (bounds.least, bounds.greatest),
        ([0., 0., -1.], [11.5, 20., 100.])
    );
}

#[test]
fn arcs_in_three_planes_and_a_helix() {
    let (preview, moves) = run_to_end(
        "G00 X10 Y0 Z0\nG17 G03 X0 Y10 I-10 J0 F100\nG18 G02 X10 Z0 R5\nG00 X0 Y10 Z0\nG19 G03 Y0 Z10 J-10\nG17 G02 X0 Y0 I5 J0 Z-5\nM30\n",
    );
    assert_eq!(moves[1].kind, MillMoveKind::CounterClockwise);
    assert!((moves[1].length() - 15.708).abs() < 0.001);
    // In ZX, a move along X from X0 Z0 with R5 is half a circle.
    assert!((moves[2].length() - 15.708).abs() < 0.001);
    let helix = moves.last().expect("helix");
    let turn = core::f64::consts::TAU * 5.0;
    assert!((helix.length() - libm::sqrt(turn * turn + 15.0 * 15.0)).abs() < 1e-6);
    assert_near(&[helix.at(0.5)], &[[10., 0., 2.5]]);
    assert_eq!(preview.bounds.map(|it| it.greatest[0]), Some(10.0));
}

#[test]
fn arcs_that_are_none() {
    assert_eq!(alarm("G00 X0 Y0\nG02 X10 Y0 R4 F100\n"), (13, 2));
    assert_eq!(alarm("G00 X0 Y0\nG02 X10 Y0 I4.9 F100\n"), (13, 2));
    assert_eq!(alarm("G00 X0 Y0\nG02 X0 Y0 R4 F100\n"), (13, 2));
    assert_eq!(alarm("G00 X0 Y0\nG02 X5 F100\n"), (13, 2));
}

#[test]
fn codes_that_are_not_there() {
    assert_eq!(alarm("G12\n"), (10, 1));
    assert_eq!(alarm("\nG110 X1\n"), (10, 2));
    assert_eq!(alarm("G17.1\n"), (10, 1));
    assert_eq!(alarm("M777\n"), (19, 1));
    assert_eq!(alarm("G01 X1 G28 Z0\n"), (24, 1));
    assert_eq!(alarm("A10\n"), (9, 1));
    assert_eq!(alarm("G00 X100000\n"), (43, 1));
}

#[test]
fn words_of_lathes_are_refused() {
    for word in ["U4", "V1", "W-2", "E1"] {
        assert_eq!(alarm(&format!("G01 X1 F100\n{word}\n")), (9, 2), "{word}");
        assert_eq!(alarm(&format!("G28 {word}\n")), (9, 1), "{word}");
    }
    // In a macro they are arguments.
    let sub = "O9005\nG00 X#21 Y#22 Z#23\nM99\n";
    let text = "M9005 U1 V2 W3\nG65 P9005 U4 V5 W6\nM30\n";
    let (preview, moves) = run_program(&MillSetup::default(), text, &[sub]);
    assert_eq!(preview.alarm, None);
    assert_near(&ends(&moves), &[[1., 2., 3.], [4., 5., 6.]]);
}

#[test]
fn ladder_codes_and_unused_words_are_reported() {
    let text = "M07\nM10\nM19\nM10\nG01 X1 F100 R5\nG00 Q2 X2\nG43 H1 Z5 L2\nG04 P1\nM30\n";
    let (preview, _) = run_to_end(text);
    let warnings: Vec<(u32, &str)> = (preview.cautions.iter())
        .map(|it| (it.source.line, it.slip.id()))
        .collect();
    let (ladder, word) = ("ladder-code", "word-without-effect");
    assert_eq!(
        warnings,
        [
            (1, ladder),
            (2, ladder),
            (3, ladder),
            (5, word),
            (6, word),
            (7, word)
        ]
    );
    let text = "G17 G02 X2 Y0 R1 F100\nG03 X0 I-1 J0\nG81 X1 Z-5 R1 F100 K2\nG80\nG83 Z-5 R1 Q2 P100\nG10 L12 P1 R3\nG68 X0 Y0 R10\nG69\nM98 P5 L2\nM30\n";
    let (preview, _) = run_program(&MillSetup::default(), text, &["O5\nM99\n"]);
    assert_eq!((preview.alarm, preview.cautions), (None, Vec::new()));
}

/// Appendix 2 of the manual and parameter 562: an axis without its bit is not scaled, not even
/// by P.
#[test]
fn only_axes_with_their_bit_are_scaled() {
    let text = "G00 X0 Y0 Z0\nG51 X0 Y0 Z0 P2000\nG01 X1 Y1 Z1 F100\nG50\nM30\n";
    let last = |bits: i32| {
        let (preview, moves) = run_program(&with(&[(562, bits)]), text, &[]);
        assert_eq!(preview.alarm, None);
        moves.last().map(|made| made.to.mm())
    };
    assert_eq!(last(0b111), Some([2.0, 2.0, 2.0]));
    assert_eq!(last(0b011), Some([2.0, 2.0, 1.0]));
    assert_eq!(last(0b000), Some([1.0, 1.0, 1.0]));
    // 5411 in place of P.
    let setup = with(&[(562, 0b100), (5411, 3000)]);
    let (_, moves) = run_program(&setup, &text.replace(" P2000", ""), &[]);
    assert_eq!(moves.last().map(|it| it.to.mm()), Some([1.0, 1.0, 3.0]));
}

/// Appendices 1 to 3 of the manual: ranges of G10, G51 and G68.
#[test]
fn ranges_of_the_appendices() {
    assert_eq!(alarm("G68 X0 Y0 R360.001\n"), (43, 1));
    assert_eq!(alarm("G68 X0 Y0 R-360.001\n"), (43, 1));
    run_to_end("G68 X0 Y0 R360.\nG69\nG68 X0 Y0 R-360\nG69\nM30\n");
    let each = with(&[(562, 0b1_0111)]);
    let number =
        |setup: &MillSetup, text: &str| run_program(setup, text, &[]).0.alarm.map(|it| it.number);
    assert_eq!(number(&each, "G51 X0 Y0 I9999 J-9999 K1\nM30\n"), None);
    assert_eq!(number(&each, "G51 X0 Y0 I10000 J1000\nM30\n"), Some(43));
    assert_eq!(number(&each, "G51 X0 Y0 I1000 J0\nM30\n"), Some(43));
    let fine = with(&[(562, 0b1_0111), (36, 128)]);
    assert_eq!(number(&fine, "G51 X0 Y0 I999999 J100000\nM30\n"), None);
    assert_eq!(number(&fine, "G51 X0 Y0 I1000000\nM30\n"), Some(43));
    assert_eq!(alarm("G51 P-1\n"), (43, 1));
    assert_eq!(alarm("G10 L10 P1 R1000\n"), (43, 1));
    // 99.9999 inches.
    run_to_end("G20\nG10 L10 P1 R99.9999\nM30\n");
    assert_eq!(alarm("G20 G10 L10 P1 R100\n"), (43, 1));
}

/// Appendix 4, 2 of the manual: which variables can be written, and their ranges.
#[test]
fn timers_and_counters_are_written() {
    let text = "#3001=0\nG04 P1000\n#1=#3001\n#3001=65535\n#2=#3001\n#3002=2.25\n#3=#3002\n#3901=7\n#3902=9\nG00 X#1 Y#3901 Z[#3902+#3*100]\n#1103=5\n#4=#1132\n#1132=6\n#5=#1101+#1102*10\nX#4 Y#5\nM30\n";
    let (_, moves) = run_to_end(text);
    assert_near(
        &ends(&moves[moves.len() - 2..]),
        &[[992.0, 7.0, 234.0], [8.0, 11.0, 234.0]],
    );
    let (_, moves) = run_to_end("#3005=16\n#1=#4006\nG21\nG00 X#1 Y#3005\nM30\n");
    assert_near(&ends(&moves), &[[20.0, 0.0, 100.0]]);
    let number = |text: &str| alarm(text).0;
    for wrong in [
        "#3001=65536",
        "#3003=4",
        "#3004=8",
        "#1132=65536",
        "#3902=-1",
    ] {
        assert_eq!(number(&format!("{wrong}\n")), 111, "{wrong}");
    }
    for read_only in [
        "#3011=1", "#3012=1", "#4001=1", "#5001=1", "#1000=1", "#1032=1",
    ] {
        assert_eq!(number(&format!("{read_only}\n")), 116, "{read_only}");
    }
}

/// Facts C1 to C3 of `tests/model-facts.tsv`: the mirror of the worked example.
#[test]
fn mirrors_about_fifty() {
    let setup = with(&[(562, 19)]);
    let sub = "O9000\nG90 G00 X60 Y60\nG01 X100 F100\nY100\nX60 Y60\nM99\n";
    let main = "G17 G90\nM98 P9000\nG51 X50 Y50 I-1000 J1000\nM98 P9000\nG51 X50 Y50 I-1000 J-1000\nM98 P9000\nG51 X50 Y50 I1000 J-1000\nM98 P9000\nG50\nM30\n";
    let (preview, moves) = run_program(&setup, main, &[sub]);
    assert_eq!(preview.alarm, None);
    let p = |x, y| [x, y, 100.0];
    assert_near(
        &ends(&moves),
        &[
            p(60., 60.),
            p(100., 60.),
            p(100., 100.),
            p(60., 60.),
            p(40., 60.),
            p(0., 60.),
            p(0., 100.),
            p(40., 60.),
            p(40., 40.),
            p(0., 40.),
            p(0., 0.),
            p(40., 40.),
            p(60., 40.),
            p(100., 40.),
            p(100., 0.),
            p(60., 40.),
        ],
    );
}

/// Facts C4 to C6 of `tests/model-facts.tsv`: scaled by half about (300,150), rotated by 45°
/// about (250,125).
#[test]
fn scaled_and_turned() {
    let (_, moves) = run_to_end(
        "G90 G00 X1 Y0\nG51 X300.0 Y150.0 P500\nG68 X200.0 Y100.0 R45.0\nG01 X400.0 Y100.0 F100\nG91 Y100.0\nX-200.0\nY-100.0\nX200.0\nG69\nG50\nM30\n",
    );
    let p = |x, y| [x, y, 100.0];
    assert_near(
        &ends(&moves[1..]),
        &[
            p(320.711, 195.711),
            p(285.355, 231.066),
            p(214.645, 160.355),
            p(250., 125.),
            p(320.711, 195.711),
        ],
    );
}

/// Facts C7 and C8 of `tests/model-facts.tsv`: an arc by R under two scales.
#[test]
fn arcs_under_two_scales() {
    let setup = with(&[(562, 23)]);
    let begin = "G90 G00 X0 Y100\nG51 X0 Y0 Z0 I2000 J1000\n";
    let (preview, moves) =
        run_program(&setup, &format!("{begin}G02 X100 Y0 R100 F500\nM30\n"), &[]);
    assert_eq!(preview.alarm, None);
    let last = moves.last().expect("arc");
    assert_near(&[last.to.mm()], &[[200., 0., 100.]]);
    let arc = last.arc.expect("arc");
    assert!(((last.to.flat(arc.plane) - arc.center).length() - 200.0).abs() < 1e-6);
    let (preview, _) = run_program(&setup, &format!("{begin}G02 X100 Y0 I0 J-100 F500\n"), &[]);
    assert_eq!(preview.alarm.map(|it| it.number), Some(13));
}

/// Fact C9 of `tests/model-facts.tsv`, with the resulting offsets read from their variables.
#[test]
fn offsets_are_put_in_and_added_to() {
    let (_, moves) = run_to_end(
        "G90 G10 L12 P3 R5.0\nG91 G10 L12 P3 R-0.02\nG90 G10 L13 P3 R-0.03\nG00 X#13003 Y#12003 Z[#13003+#12003]\nM30\n",
    );
    assert_near(&ends(&moves), &[[4.98, -0.03, 4.95]]);
    assert_eq!(alarm("G10 L12 P401 R1\n"), (30, 1));
    assert_eq!(alarm("G10 L10 P1 R1000\n"), (43, 1));
    assert_eq!(alarm("G10 L2 P1 R1\n"), (43, 1));
}

#[test]
fn length_offsets_move_the_tool_or_its_coordinates() {
    let mut setup = MillSetup::default();
    setup.memory.take_offset("1=50,5,-0.5").expect("offset");
    let (preview, _) = run_program(&setup, "G90 G00 G43 H1 Z10\nM00\nM99 P9\nN9 G04\n", &[]);
    assert_eq!(preview.machine.mm(), [0., 0., 59.5]);
    let (preview, _) = run_program(&setup, "G00 Z10\nG44 H1\n", &[]);
    assert_eq!(
        (preview.machine.mm()[2], preview.work.mm()[2]),
        (-39.5, 10.0)
    );
    let (preview, _) = run_program(&setup, "G00 G43 H1 Z10\nG28 Z20\nG00 X1\n", &[]);
    assert_eq!((preview.machine.mm()[2], preview.work.mm()[2]), (0.0, 0.0));
}

#[test]
fn zeros_of_the_work() {
    let mut setup = MillSetup::default();
    for word in ["54=1,2,3", "59=10,0,0", "54.1P48=100,0,0", "0=0.5,0,0"] {
        setup.memory.take_zero(word).expect("zero");
    }
    let program = "G90 G00 X0 Y0 Z0\nG59 X0\nG54.1 P48 X0\nG54 X0\nG52 X5\nX0\nG52 X0\nG92 X100\nX0\nG53 X0\nM30\n";
    let (preview, moves) = run_program(&setup, program, &[]);
    assert_eq!(preview.alarm, None);
    let machine = moves.iter().map(|it| (it.to + it.zero).mm()[0]);
    assert_eq!(
        machine.collect::<Vec<_>>(),
        [1.5, 10.5, 100.5, 1.5, 6.5, -93.5, 0.0]
    );
    assert_eq!(alarm("G54.1 P49\n"), (43, 1));
    assert_eq!(alarm("G91 G53 X1\n"), (10, 1));
}

#[test]
fn holes_by_level_and_by_number() {
    let (_, moves) =
        run_to_end("G90 G00 X0 Y0 Z50\nG99 G81 X10 Y0 R2 Z-5 F100\nG98 X20\nG80 X0\nM30\n");
    assert_near(
        &ends(&moves[1..]),
        &[
            [10., 0., 50.],
            [10., 0., 2.],
            [10., 0., -5.],
            [10., 0., 2.],
            [20., 0., 2.],
            [20., 0., -5.],
            [20., 0., 50.],
            [0., 0., 50.],
        ],
    );
    let (_, moves) = run_to_end("G90 G00 X0 Y0 Z10\nG91 G99 G82 X5 R-8 Z-4 P500 K3 F100\nM30\n");
    let drilled: Vec<_> = moves
        .iter()
        .filter(|it| it.kind == MillMoveKind::Feed)
        .collect();
    let bottoms: Vec<_> = drilled.iter().map(|it| it.to.mm()).collect();
    assert_near(&bottoms, &[[5., 0., -2.], [10., 0., -2.], [15., 0., -2.]]);
    let dwells = moves.iter().filter(|it| it.kind == MillMoveKind::Dwell);
    assert_eq!(dwells.map(|it| it.duration_s).sum::<f64>(), 1.5);
    let (_, moves) = run_to_end("G90 G00 X0 Y0 Z10\nG81 R2 Z-5 F100 K0\nX1\nM30\n");
    assert_eq!(
        moves
            .iter()
            .filter(|it| it.kind == MillMoveKind::Feed)
            .count(),
        1
    );
}

#[test]
fn holes_in_pecks() {
    let (_, moves) = run_to_end("G90 G00 X0 Y0 Z2\nG98 G83 R2 Z-8 Q4 F100\nM30\n");
    let z: Vec<f64> = moves.iter().map(|it| it.to.mm()[2]).collect();
    // 5115: 2 mm before the last depth.
    assert_eq!(z, [2., -2., 2., 0., -6., 2., -4., -8., 2.]);
    let (_, moves) = run_to_end("G90 G00 X0 Y0 Z2\nG98 G73 R2 Z-7 Q4 F100\nM30\n");
    let z: Vec<f64> = moves.iter().map(|it| it.to.mm()[2]).collect();
    assert_eq!(z, [2., -2., 0., -6., -4., -7., 2.]);
    assert_eq!(alarm("G83 X1 R2 Z-5 F100\n"), (62, 1));
    assert_eq!(alarm("G81 X1 R2 F100\n"), (62, 1));
}

#[test]
fn rigid_taps_in_pecks() {
    let text = "G90 G00 X0 Y0 Z2\nM03 S500\nM29\nG98 G84 R2 Z-7 Q4 F500\nG80 M30\n";
    let taps = |bits| {
        let (preview, moves) = run_program(&with(&[(588, bits)]), text, &[]);
        assert_eq!(preview.alarm, None);
        let taps = moves.into_iter().filter(|it| it.kind == MillMoveKind::Tap);
        taps.map(|it| it.to.mm()[2]).collect::<Vec<_>>()
    };
    assert_eq!(taps(0), [-2., 2., -6., 2., -7., 2.]);
    assert_eq!(taps(32), [-2., 0., -6., -4., -7., 2.]);
    // Without M29, Q remains from other holes.
    let (_, moves) = run_to_end("G90 G00 X0 Y0 Z2\nG84 R2 Z-7 Q4 F500\nM30\n");
    assert_eq!(
        moves
            .iter()
            .filter(|it| it.kind == MillMoveKind::Tap)
            .count(),
        2
    );
}

#[test]
fn threads_follow_the_spindle() {
    // 20 mm with a lead of 2 are ten turns, 2 s at 300 r/min, and a stop after them.
    let text = "M03 S300\nG00 X0 Z10\nG01 Z9 F60\nG33 Z-10 X5 F1\nG33 Z-30 F2\nG01 Z-31\nM30\n";
    let (preview, moves) = run_to_end(text);
    assert_eq!(preview.alarm, None);
    let threads: Vec<_> = moves
        .iter()
        .filter(|it| it.kind == MillMoveKind::Thread)
        .collect();
    let seconds: Vec<f64> = threads.iter().map(|it| it.duration_s).collect();
    assert!((seconds[0] - 19.0 / 5.0).abs() < 1e-9, "{seconds:?}");
    assert!((seconds[1] - 2.0).abs() < 1e-9, "{seconds:?}");
    // The feed is unchanged.
    let last = moves.last().expect("a move");
    assert_eq!(last.feed, Some(gsk_core::units::Feed::PerMinute(60.0)));
    assert_eq!(alarm("M03 S300\nG33 Z-10\n"), (11, 2));
    assert_eq!(alarm("G33 Z-10 F1\n"), (94, 1));
    assert_eq!(alarm("M03 S300\nG33 Z-10 F501\n"), (43, 2));
}

#[test]
fn boring_retracts_beside_the_wall() {
    let setup = with(&[(584, 3)]);
    let (preview, moves) = run_program(
        &setup,
        "G90 G00 X0 Y0 Z20\nM03 S500\nG98 G76 X5 R2 Z-10 Q0.5 F50\nM30\n",
        &[],
    );
    assert_eq!(preview.alarm, None);
    assert_near(
        &ends(&moves[1..]),
        &[
            [5., 0., 20.],
            [5., 0., 2.],
            [5., 0., -10.],
            [5., -0.5, -10.],
            [5., -0.5, 20.],
            [5., 0., 20.],
        ],
    );
}

/// A square of 20 mm outside with a cutter of radius 5: the path is a square of 30 with its
/// corners.
#[test]
fn the_centre_follows_beside_the_contour() {
    let mut setup = MillSetup::default();
    setup.memory.take_offset("1=0,5").expect("offset");
    let program =
        "G90 G00 X-20 Y-20 Z0\nG41 D1 G01 X0 Y-10 F100\nY20\nX20\nY0\nX-10\nG40 X-20 Y-20\nM30\n";
    let (preview, moves) = run_program(&setup, program, &[]);
    assert_eq!(preview.alarm, None);
    let points: Vec<_> = moves[1..].iter().map(|it| it.to.mm()).collect();
    for corner in [[-5., 25., 0.], [25., 25., 0.], [25., -5., 0.]] {
        assert!(points.contains(&corner), "{corner:?} {points:?}");
    }
    assert_eq!(points.last(), Some(&[-20., -20., 0.]));
    // A groove narrower than the cutter.
    let program = "G90 G00 X0 Y-20 Z0\nG41 D1 G01 Y0 F100\nY20\nX-4\nY0\nG40 X-20\nM30\n";
    let (preview, _) = run_program(&setup, program, &[]);
    assert_eq!(preview.alarm.map(|it| it.number), Some(57));
}

#[test]
fn depth_goes_along_under_compensation() {
    let mut setup = MillSetup::default();
    setup.memory.take_offset("1=0,5").expect("offset");
    let program = "G90 G00 X-20 Y0 Z10\nG41 D1 G01 X0 F100\nZ-2\nY30\nG40 X-20\nM30\n";
    let (preview, moves) = run_program(&setup, program, &[]);
    assert_eq!(preview.alarm, None);
    let plunge = moves.iter().find(|it| it.source.line == 3).expect("plunge");
    let [from, to] = [plunge.from, plunge.to].map(|it| it.mm());
    assert_eq!((from[2], to[2]), (10.0, -2.0));
    assert_eq!((from[0], from[1]), (to[0], to[1]));
}

/// Fact C27 of `tests/model-facts.tsv` as corrected: five holes on a circle by macro B.
#[test]
fn a_bolt_circle_by_macro() {
    let circle = "O9100\n#3=#4003\nIF [#3 EQ 90] GOTO 1\n#24=#5001+#24\n#25=#5002+#25\nN1 G81 Z#26 R#18 F#9 K0\nWHILE [#11 GT 0] DO 1\n#5=#24+#4*COS[#1]\n#6=#25+#4*SIN[#1]\nG90 X#5 Y#6\n#1=#1+#2\n#11=#11-1\nEND 1\nG#3 G80\nM99\n";
    let main =
        "G90 G00 X0 Y0 Z100\nG65 P9100 X100.0 Y50.0 R30.0 Z-50.0 F500 I100.0 A0 B45.0 H5\nM30\n";
    let (preview, moves) = run_program(&MillSetup::default(), main, &[circle]);
    assert_eq!(preview.alarm, None);
    let drilled = moves.iter().filter(|it| it.kind == MillMoveKind::Feed);
    let bottoms: Vec<_> = drilled.map(|it| it.to.mm()).collect();
    let p = |x, y| [x, y, -50.0];
    assert_near(
        &bottoms,
        &[
            p(200., 50.),
            p(170.711, 120.711),
            p(100., 150.),
            p(29.289, 120.711),
            p(0., 50.),
        ],
    );
}

/// Fact C31 of `tests/model-facts.tsv`: a hole after each of four moves, and its retraction.
#[test]
fn a_modal_drill_by_macro() {
    let drill = "O9110\n#1=#4001\n#3=#4003\n#4=#4109\n#5=#5003\nG00 G90 Z#18\nG01 Z#26 F#9\nIF [#4010 EQ 98] GOTO 1\nG00 Z#18\nGOTO 2\nN1 G00 Z#5\nN2 G#1 G#3 F#4\nM99\n";
    for (code, back) in [(98, 50.0), (99, 5.0)] {
        let main = format!(
            "G92 X0 Y0 Z50.0\nG00 G90 G{code}\nG66 P9110 Z-20.0 R5.0 F500\nX20 Y20\nX50\nY50\nX70 Y80\nG67\nM30\n"
        );
        let (preview, moves) = run_program(&MillSetup::default(), &main, &[drill]);
        assert_eq!(preview.alarm, None);
        let down: Vec<_> = moves
            .iter()
            .filter(|it| it.kind == MillMoveKind::Feed)
            .collect();
        assert_eq!(down.len(), 4);
        assert!(
            down.iter()
                .all(|it| (it.from.mm()[2], it.to.mm()[2]) == (5.0, -20.0))
        );
        assert_eq!(preview.work.mm(), [70.0, 80.0, back]);
    }
}

/// Fact C30 of `tests/model-facts.tsv`, for the third axis: the zero of G54.1 P48.
#[test]
fn zeros_by_their_variables() {
    let (preview, _) = run_to_end("#7943=12.5\n#2501=-3\nG54.1 P48 G00 G90 X0 Y0 Z0\nM30\n");
    assert_eq!(preview.machine.mm(), [0.0, 0.0, 12.5]);
}

/// Facts C32 and C33 of `tests/model-facts.tsv`: M codes that call programs.
#[test]
fn m_codes_call_programs() {
    let setup = with(&[(6044, 2000), (6045, 300), (6046, 100)]);
    let subs: Vec<String> = [300, 301, 302, 399]
        .iter()
        .map(|number| format!("O0{number}\nG91 G00 X{number}\nM99\n"))
        .collect();
    let subs: Vec<&str> = subs.iter().map(String::as_str).collect();
    let (preview, moves) = run_program(&setup, "M2000\nM2001\nM2002\nM2099\nM30\n", &subs);
    assert_eq!(preview.alarm, None);
    let distance = |made: &MillMove| (made.to - made.from).mm()[0];
    assert_eq!(
        moves.iter().map(distance).collect::<Vec<_>>(),
        [300., 301., 302., 399.]
    );
    let beyond = with(&[(6044, 2000), (6045, 9901), (6046, 100)]);
    let (preview, _) = run_program(&beyond, "M2000\n", &subs);
    assert_eq!(preview.alarm.map(|it| it.number), Some(19));
    let (_, moves) = run_program(
        &setup,
        "M9005 X1 Y2\nM30\n",
        &["O9005\nG00 X[#24*10] Y#25\nM99\n"],
    );
    assert_near(&ends(&moves), &[[10., 2., 100.]]);
}

/// Fact C56 of `tests/model-facts.tsv`: 520.7 selects the turn of an angle.
#[test]
fn inverse_functions_by_parameter() {
    let text = "G00 X[ASIN[-1]] Y[ATAN[-1]/[1]] Z[ATAN[0-0]/[-1]]\nM30\n";
    let (preview, _) = run_program(&MillSetup::default(), text, &[]);
    assert_eq!(preview.work.mm(), [270.0, 315.0, 180.0]);
    let (preview, _) = run_program(&with(&[(520, 128)]), text, &[]);
    assert_eq!(preview.work.mm(), [-90.0, -45.0, 180.0]);
}

#[test]
fn polar_coordinates() {
    let (_, moves) = run_to_end("G90 G00 X0 Y0\nG16 X10 Y30\nY120\nG91 Y30\nG15 G90 X0 Y0\nM30\n");
    assert_near(
        &ends(&moves[..2]),
        &[[8.660, 5.0, 100.], [-5.0, 8.660, 100.]],
    );
}

#[test]
fn inches_are_exact() {
    let text = format!("G20 G91\n{}G21 G90\nM30\n", "G00 X0.0001\n".repeat(1000));
    let (preview, _) = run_to_end(&text);
    assert_eq!(preview.work.mm()[0], 2.54);
    let (_, moves) = run_to_end("G20 G01 X1 F10\nM30\n");
    assert!((moves[0].duration_s - 6.1).abs() < 1e-9);
}

#[test]
fn times_add_up() {
    // 60 mm at 600 mm/min, the stop after it 0.1 s, and a rapid of 8000 mm/min with 0.1 s.
    let (preview, _) = run_to_end("G01 X60 F600\nG00 X0\nG04 X2.5\nG04 P500\nM30\n");
    let rapid = 60.0 / (8000.0 / 60.0) + 0.1;
    assert!((preview.time_s - (6.0 + 0.1 + rapid + 3.0)).abs() < 1e-6);
    assert!((preview.cutting_s - 6.1).abs() < 1e-6);
    // A feed per revolution.
    let (preview, _) = run_to_end("M03 S500\nG95 G01 X50 F0.2\nM30\n");
    assert!(
        (preview.cutting_s - 30.1).abs() < 1e-6,
        "{}",
        preview.cutting_s
    );
    assert_eq!(alarm("G95 G01 X50 F0.2\n"), (11, 1));
}

#[test]
fn returns_and_further_points() {
    let setup = with(&[(11241, 50_000), (31240, 200_000)]);
    let (preview, moves) = run_program(
        &setup,
        "G90 G00 X10 Y10 Z10\nG91 G28 Z5\nG30 P2 X0\nG90 G29 X3 Z4\nG27 X0\nM30\n",
        &[],
    );
    assert_eq!(preview.alarm, None);
    let machine: Vec<_> = moves.iter().map(|it| (it.to + it.zero).mm()).collect();
    assert_near(
        &machine,
        &[
            [10., 10., 10.],
            [10., 10., 15.],
            [10., 10., 200.],
            [50., 10., 200.],
            [10., 10., 15.],
            [3., 10., 4.],
            [0., 10., 4.],
        ],
    );
    let (_, moves) = run_to_end("G90 G00 X5\nG0 G91 G28 Z0 X0\nM30\n");
    assert_near(&ends(&moves), &[[5., 0., 100.], [0., 0., 0.]]);
    assert_eq!(alarm("G27 X5\n"), (90, 1));
    assert_eq!(alarm("G51 P500\nG28 X0\n"), (10, 2));
}

#[test]
fn what_scaling_and_rotation_refuse() {
    assert_eq!(alarm("G51 X0 Y0 P500 F100\n"), (12, 1));
    assert_eq!(alarm("G51 X0 I2000\n"), (12, 1));
    assert_eq!(alarm("G51 X0 P0\n"), (43, 1));
    assert_eq!(alarm("G51 X0 P1.5\n"), (7, 1));
    assert_eq!(alarm("G68 X0 Y0 R10\nG18\n"), (10, 2));
    assert_eq!(alarm("G68 X0 Y0 R10\nG92 X0\n"), (10, 2));
}

#[test]
fn a_rotation_starts_at_the_tool_with_an_increment() {
    let (_, moves) = run_to_end("G90 G00 X10 Y0\nG68 X0 Y0 R90\nG91 X5\nG69 X1\nM30\n");
    assert_near(&ends(&moves[1..]), &[[10., 5., 100.], [11., 5., 100.]]);
}

#[test]
fn more_alarms_are_listed() {
    let text = "G00 X1\nG12\nX2\nM777\nX3 X4\nG02 X9 R1\nM30\n";
    let (preview, _) = run_program(&MillSetup::default(), text, &[]);
    assert_eq!(preview.alarm.map(|it| it.number), Some(10));
    let further: Vec<u16> = preview.further.iter().map(|it| it.number).collect();
    assert_eq!(further, [19, 18]);
}

#[test]
fn endless_programs_are_given_up() {
    let (preview, _) = run_program(&MillSetup::default(), "N1 GOTO 1\n", &[]);
    assert_eq!(preview.end, PreviewEnd::Limit);
    let (preview, _) = run_program(&MillSetup::default(), "G91 G00 X1\nM99\n", &[]);
    assert_eq!(preview.end, PreviewEnd::M99);
}

fn block() -> impl Strategy<Value = String> {
    let codes = "G0 G1 G2 G3 G4 G9 G10 G15 G16 G17 G18 G19 G20 G21 G27 G28 G29 G30 G31 G37 G40 G41 G42 G43 G44 G49 G50 G51 G52 G53 G54 G54.1 G59 G61 G64 G68 G69 G73 G74 G76 G80 G81 G83 G84 G87 G90 G91 G92 G94 G95 G98 G99 M3 M5 M6 M98 M99 M30";
    let codes: Vec<&str> = codes.split(' ').collect();
    let letters: Vec<char> = "XYZIJKRPQLDHFSTK".chars().collect();
    let code = prop::sample::select(codes).prop_map(str::to_owned);
    let word = (prop::sample::select(letters), -2000..2000_i32, 0..3_u8).prop_map(
        |(letter, value, form)| match form {
            0 => format!("{letter}{}", value / 100),
            1 => format!("{letter}{}.{}", value / 100, value.abs() % 100),
            _ => format!("{letter}[{value}/7]"),
        },
    );
    let part = prop_oneof![code, word];
    prop::collection::vec(part, 1..6).prop_map(|parts| parts.join(" "))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// No program panics, and every move starts at the end of the one before.
    #[test]
    fn moves_join_whatever_is_written(blocks in prop::collection::vec(block(), 1..30)) {
        let mut setup = with(&[(562, 23)]);
        setup.memory.take_offset("1=10,2").expect("offset");
        let text = blocks.join("\n");
        let (preview, moves) = run_program(&setup, &text, &["O0001\nG91 G01 X1 Y2\nM99\n"]);
        prop_assert!(preview.time_s.is_finite());
        for pair in moves.windows(2) {
            let end = pair[0].to + pair[0].zero;
            let begin = pair[1].from + pair[1].zero;
            // A length offset that comes into force in between shifts only Z.
            let [x, y, _] = (end - begin).mm();
            prop_assert!(x.abs() < 1e-9 && y.abs() < 1e-9, "{:?} {:?}", pair[0], pair[1]);
        }
    }
}
