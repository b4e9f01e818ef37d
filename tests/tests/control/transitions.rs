//! Transitions between cuts: with 007.3 = 1 every cut ends on its end point, with 007.3 = 0 it
//! blends into the next. The time of `check` is that of `run`.

use std::fmt::Write as _;

use gsk_core::cnc::{ControlRequest, Event};
use gsk_core::command::ExecutedMove;
use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::preview::preview;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use proptest::prelude::*;

const SINGLE_BLOCK: BitAddress = BitAddress::new(Area::X, 20, 6);

/// Two legs of 40 mm at a right angle, at 3000 mm/min.
const CORNER_PROGRAM: &str = "O1;\nG98 G01 W-40 F3000;\nU80;\nG00 W1;\nM30;\n";

fn with_parameters(changes: &[(u16, i32)]) -> Setup {
    let mut setup = Setup::default();
    for (number, value) in changes {
        assert!(setup.memory.parameters.set(*number, *value).is_ok());
    }
    setup
}

struct TransitionRun {
    moves: Vec<ExecutedMove>,
    path: Vec<Point>,
    time: f64,
}

fn run_program(text: &str, setup: Setup, single_block: bool) -> TransitionRun {
    let mut simulation = Simulation::new(setup);
    let request = ControlRequest::OpenExternal(Program::new(text));
    assert_eq!(simulation.cnc.request(request), Ok(()));
    if single_block {
        for down in [false, true, false] {
            simulation.cnc.set_panel_key(SINGLE_BLOCK, down);
            for _ in 0..100 {
                simulation.tick();
            }
        }
    }
    let mut run = TransitionRun {
        moves: Vec::new(),
        path: Vec::new(),
        time: 0.0,
    };
    simulation.start_automatic();
    // The part of the program that ran before the key was released.
    let mut began = None;
    for tick in 0..3_600_000u32 {
        if simulation.cnc.run_state() == RunState::Stop {
            simulation.start_automatic();
        }
        simulation.tick();
        run.path.push(simulation.cnc.position_machine());
        for event in simulation.cnc.events() {
            match event {
                Event::MoveEnded(piece) => {
                    began.get_or_insert(piece.start_s);
                    run.time = piece.start_s + piece.duration_s;
                    run.moves.push(*piece);
                }
                Event::ProgramEnded { .. } => {
                    run.time -= began.unwrap_or(0.0);
                    return run;
                }
                Event::AlarmRaised(alarm) => panic!("{alarm:?} in tick {tick} of\n{text}"),
                _ => {}
            }
        }
    }
    panic!("no end of\n{text}");
}

/// Moves of the preview, and the time from the first to the last.
fn preview_moves(text: &str, setup: &Setup) -> (Vec<ExecutedMove>, f64) {
    let mut programs = setup.memory.programs.clone();
    programs.open_external(Program::new(text));
    programs.select(gsk_core::command::ProgramId::External);
    let mut moves = Vec::new();
    let preview = preview(setup, &programs, &mut |piece| moves.push(*piece));
    assert_eq!(preview.alarm, None, "{text}");
    let began = moves
        .first()
        .map_or(0.0, |piece: &ExecutedMove| piece.start_s);
    let ended = moves
        .last()
        .map_or(0.0, |piece| piece.start_s + piece.duration_s);
    (moves, ended - began)
}

fn nearest_distance(path: &[Point], to: Point) -> f64 {
    path.iter()
        .map(|point| (*point - to).length())
        .fold(f64::INFINITY, f64::min)
}

/// The corner in machine coordinates: runs start at X300 Z300.
const CORNER_POINT: Point = Point::new(150.0, 260.0);

#[test]
fn smz_chooses_between_exact_and_rounded_corners() {
    // 029 = 100 ms, 030 = 10 mm/min.
    let exact = run_program(CORNER_PROGRAM, with_parameters(&[(7, 0b1000)]), false);
    assert!(nearest_distance(&exact.path, CORNER_POINT) < 0.001);
    let over = run_program(CORNER_PROGRAM, with_parameters(&[(7, 0)]), false);
    // L = T (F - FL) = 4.98 mm; nearest to the corner the tool is at min √(e^-2s + (s - 1 +
    // e^-s)²) = 0.509 of it, at s = 0.88.
    let off = nearest_distance(&over.path, CORNER_POINT) / (0.1 * (3000.0 - 10.0) / 60.0);
    assert!((off - 0.509).abs() < 0.002, "{off}");
    // One approach and one deceleration less: T ln(F / FL) = 0.570 s.
    let saved = exact.time - over.time;
    assert!((saved - 0.5704).abs() < 0.01, "{saved} s");
    let ends: Vec<_> = over.moves.iter().map(|piece| piece.to).collect();
    let expected: Vec<_> = exact.moves.iter().map(|piece| piece.to).collect();
    assert_eq!(ends, expected);
}

#[test]
fn words_between_two_cuts_make_the_corner_exact() {
    for between in [
        "G04 X0.1;",
        "M08;",
        "G00 W0.5;\nW-0.5;",
        "T0101;",
        "G65 H01 P#200 Q#500;",
    ] {
        let text = CORNER_PROGRAM.replace("U80", &format!("{between}\nG01 U80"));
        let made = run_program(&text, with_parameters(&[(7, 0)]), false);
        let off = nearest_distance(&made.path, CORNER_POINT);
        assert!(off < 0.001, "{off} mm with {between}");
    }
    let single = run_program(CORNER_PROGRAM, with_parameters(&[(7, 0)]), true);
    assert!(nearest_distance(&single.path, CORNER_POINT) < 0.001);
}

#[test]
fn cycles_and_words_without_motion_keep_the_transition() {
    for between in ["(comment)", "G98;", "N5;"] {
        let text = CORNER_PROGRAM.replace("U80", &format!("{between}\nG01 U80"));
        let (_, checked) = preview_moves(&text, &with_parameters(&[(7, 0)]));
        let made = run_program(&text, with_parameters(&[(7, 0)]), false);
        assert!(
            (made.time - checked).abs() <= 0.005 * made.time,
            "{between}"
        );
    }
    let text = "O1;\nG00 X60 Z2;\nG98 G90 X50 Z-30 F2000;\nX40;\nG00 X100 Z50;\nM30;\n";
    let (_, checked) = preview_moves(text, &with_parameters(&[(7, 0)]));
    let made = run_program(text, with_parameters(&[(7, 0)]), false);
    assert!((made.time - checked).abs() <= 0.005 * made.time);
}

/// A call is between the cuts of two programs: check and run agree on it.
#[test]
fn calls_between_cuts_take_the_same_time_in_check_and_run() {
    let mut setup = with_parameters(&[(7, 0)]);
    let stored = setup.memory.programs.store("O2;\nG01 U20;\nW-10;\nM99;\n");
    assert!(stored.is_ok());
    let text = "O1;\nG98 G01 W-40 F3000;\nM98 P2;\nG01 W-20;\nM98 P2;\nM98 P2;\nU5;\nM30;\n";
    let (_, checked) = preview_moves(text, &setup);
    let made = run_program(text, setup, false);
    assert!(
        (made.time - checked).abs() <= 0.005 * made.time,
        "{} {checked}",
        made.time
    );
}

#[test]
fn a_hundred_short_blocks_flow() {
    let mut text = String::from("O1;\nG04 X0.3;\nG98 G01 F2400;\n");
    for step in 0..300 {
        // 0.028 mm each: 0.7 ms at the feed.
        let _ = writeln!(
            text,
            "U{} W-0.02;",
            if step % 2 == 0 { 0.04 } else { 0.038 }
        );
    }
    text.push_str("M30;\n");
    let made = run_program(&text, with_parameters(&[(7, 0)]), false);
    let (moves, checked) = preview_moves(&text, &with_parameters(&[(7, 0)]));
    assert_eq!(moves.len(), made.moves.len());
    assert!(
        (made.time - checked).abs() <= 0.003,
        "{} {checked}",
        made.time
    );
    let exact = run_program(&text, with_parameters(&[(7, 0b1000)]), false);
    // From and to 030 = 10 mm/min each time.
    assert!(exact.time > 20.0 * made.time, "{}", exact.time);
}

fn step() -> impl Strategy<Value = String> {
    prop_oneof![
        6 => (-9000i32..9000, -9000i32..9000, 50u32..6000).prop_map(|(u, w, f)| {
            format!("G01 U{} W{} F{f};", f64::from(u) / 500.0, f64::from(w) / 1000.0)
        }),
        3 => (100i32..6000, any::<bool>(), 50u32..3000).prop_map(|(r, clockwise, f)| {
            let (code, r) = (if clockwise { "G02" } else { "G03" }, f64::from(r) / 1000.0);
            format!("{code} U{} W{} R{r} F{f};", r * 2.0, -r)
        }),
        1 => (-9000i32..9000, -9000i32..9000).prop_map(|(u, w)| {
            format!("G00 U{} W{};", f64::from(u) / 500.0, f64::from(w) / 1000.0)
        }),
        1 => Just("G04 X0.05;".to_owned()),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn check_knows_the_time_of_run(
        steps in prop::collection::vec(step(), 2..14),
        time in prop_oneof![Just(0), 10i32..300],
        lowest in 1i32..600,
        exact in any::<bool>(),
    ) {
        let text = format!("O1;\nG04 X0.3;\nG98;\n{}\nM30;\n", steps.join("\n"));
        let setup = with_parameters(&[(7, if exact { 8 } else { 0 }), (29, time), (30, lowest)]);
        let (moves, checked) = preview_moves(&text, &setup);
        let made = run_program(&text, setup, false);
        prop_assert_eq!(moves.len(), made.moves.len());
        for (a, b) in moves.iter().zip(&made.moves) {
            prop_assert!((a.to - b.to).length() < 1e-6);
        }
        let tolerance = 0.005 * made.time + 0.003;
        prop_assert!((made.time - checked).abs() <= tolerance, "{} in run, {} in check\n{}", made.time, checked, text);
    }
}
