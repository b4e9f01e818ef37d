//! Nose radius compensation in the whole control: agreement with the preview, single block,
//! reset.

use crate::bench::press;
use gsk_core::cnc::Event;
use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::memory::ToolOffset;
use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::preview::preview;
use gsk_core::program::{Program, ProgramMemory};
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;

const PROFILE: &str = "T0101 F600;
G42 G00 X-2 Z2;
G01 Z0;
X20;
X30 Z-5;
M08 Z-20;
G02 X40 Z-25 R5;
G04 P10;
G01 X44;
M00;
X50 Z-28;
Z-40;
X20 Z-30;
G40 G00 X60 Z10;
M30;
";

const SINGLE_BLOCK: BitAddress = BitAddress::new(Area::X, 20, 6);
const CYCLE_START: BitAddress = BitAddress::new(Area::X, 25, 0);
const RESET: BitAddress = BitAddress::new(Area::X, 26, 0);

type CompensatedMove = (u32, MoveKind, [i64; 4]);

fn compensated_move(moved: &ExecutedMove) -> CompensatedMove {
    let round = |value: f64| (value * 1e6).round() as i64;
    let ends = [moved.from.x, moved.from.z, moved.to.x, moved.to.z];
    (moved.source.line, moved.kind, ends.map(round))
}

fn setup() -> Option<Setup> {
    let mut setup = Setup::default();
    setup.memory.parameters.set_bit(2, 1, true).ok()?;
    let nose = ToolOffset {
        r: 0.8,
        t: 3,
        ..ToolOffset::default()
    };
    setup.memory.offsets.set(1, nose).ok()?;
    Some(setup)
}

fn started() -> Simulation {
    let setup = setup();
    assert!(setup.is_some());
    crate::bench::program::started(setup.unwrap_or_default(), PROFILE)
}

/// The moves up to the next stop.
fn collect_moves(simulation: &mut Simulation, pieces: &mut Vec<CompensatedMove>) {
    for _ in 0..200_000 {
        if matches!(simulation.cnc.run_state(), RunState::Reset | RunState::Stop) {
            return;
        }
        simulation.tick();
        for event in simulation.cnc.events() {
            if let Event::MoveEnded(moved) = event
                && moved.kind != MoveKind::Dwell
                && moved.from != moved.to
            {
                pieces.push(compensated_move(moved));
            }
        }
    }
}

/// Presses cycle start until the program has ended.
fn run_through(simulation: &mut Simulation) -> Vec<CompensatedMove> {
    let mut pieces = Vec::new();
    for _ in 0..40 {
        collect_moves(simulation, &mut pieces);
        assert_eq!(simulation.cnc.alarms(), []);
        if simulation.cnc.run_state() == RunState::Reset {
            break;
        }
        // The key is released and pressed between the events of a tick: none is lost.
        for down in [true, false] {
            simulation.cnc.set_panel_key(CYCLE_START, down);
            for _ in 0..100 {
                simulation.tick();
                for event in simulation.cnc.events() {
                    if let Event::MoveEnded(moved) = event
                        && moved.kind != MoveKind::Dwell
                        && moved.from != moved.to
                    {
                        pieces.push(compensated_move(moved));
                    }
                }
            }
        }
    }
    pieces
}

fn preview_moves() -> Vec<CompensatedMove> {
    let mut programs = ProgramMemory::default();
    programs.open_external(Program::new(PROFILE));
    let mut pieces = Vec::new();
    let preview = preview(
        &setup().unwrap_or_default(),
        &programs,
        &mut |moved: &ExecutedMove| {
            if moved.kind != MoveKind::Dwell {
                pieces.push(compensated_move(moved));
            }
        },
    );
    assert_eq!(preview.alarm, None);
    pieces
}

#[test]
fn the_control_runs_what_the_preview_shows() {
    let expected = preview_moves();
    assert!(expected.len() > 12, "{expected:?}");
    assert_eq!(run_through(&mut started()), expected);
}

#[test]
fn single_block_changes_no_move() {
    let mut simulation = started();
    press(&mut simulation, SINGLE_BLOCK);
    assert_eq!(run_through(&mut simulation), preview_moves());
}

#[test]
fn reset_leaves_the_tool_in_place() {
    let mut simulation = started();
    let mut pieces = Vec::new();
    collect_moves(&mut simulation, &mut pieces);
    let machine = simulation.cnc.position_machine();
    press(&mut simulation, RESET);
    assert_eq!(simulation.cnc.run_state(), RunState::Reset);
    assert_eq!(simulation.cnc.position_machine(), machine);
    assert_eq!(simulation.cnc.position_absolute(), machine);
}

/// Under G96 along a cylinder of 40 and an arc about (60, -60). The nose centre is the tip
/// (T0), so the path of the tip is 1 mm off the programmed one.
const SURFACE_PROGRAM: &str = "T0202 F600;
M03 G96 S100;
G42 G00 X40 Z2;
G01 Z-30;
Z-60;
G02 X60 Z-70 R10;
G04 P600;
G40 G00 X80;
M30;
";

#[test]
fn the_surface_speed_follows_the_programmed_x() {
    let mut setup = setup().unwrap_or_default();
    assert!(setup.memory.parameters.set_bit(1, 4, true).is_ok());
    let nose = ToolOffset {
        r: 1.0,
        ..ToolOffset::default()
    };
    assert!(setup.memory.offsets.set(2, nose).is_ok());
    let mut simulation = crate::bench::program::started(setup, SURFACE_PROGRAM);
    let (mut straight, mut round, mut waiting) = (0, 0, 0);
    for _ in 0..60_000 {
        simulation.tick();
        let tip = simulation.cnc.position_absolute();
        let programmed = match simulation.cnc.cursor().line {
            5 => {
                straight += 1;
                assert!((tip.x - 21.0).abs() < 1e-9);
                20.0
            }
            6 if tip.z < -60.0 => {
                round += 1;
                let across = (-60.0 - tip.z) / 9.0;
                30.0 - 10.0 * (1.0 - across * across).max(0.0).sqrt()
            }
            7 => {
                waiting += 1;
                30.0
            }
            _ => continue,
        };
        let expected = 100_000.0 / (core::f64::consts::TAU * programmed);
        let commanded = simulation.cnc.spindle_commanded();
        // The speed is set before the tick's motion: it is one tick late.
        assert!((commanded - expected).abs() < 6.0, "{commanded} {expected}");
    }
    assert!(straight > 1000 && round > 1000 && waiting > 500);
    assert_eq!(simulation.cnc.alarms(), []);
}
