//! Runs programs and compares their moves, times and alarms.

mod holes;
mod macros;
mod offset_memory;
mod spindle_and_backlash;
mod transforms;
mod units_and_start_up;

use gsk_core::program::{Program, ProgramMemory};
use proptest::prelude::*;

use crate::{MillMove, MillMoveKind, MillPreview, MillSetup, PreviewEnd, preview_while};

/// Runs a program on a mill whose memory has the subprograms `others`; returns the preview and its
/// moves.
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

/// Runs a program and returns number and line of its alarm.
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
        .map(|it| (it.source.line, it.slip.lint().id()))
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
