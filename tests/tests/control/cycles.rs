//! Cycles in the whole control: feed hold, single block, agreement with the preview.

use crate::bench::program::started;
use crate::bench::{press, run_ticks};
use gsk_core::cnc::{ControlRequest, Event};
use gsk_core::command::{ExecutedMove, ProgramId};
use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::preview::preview;
use gsk_core::program::{Program, ProgramMemory};
use gsk_core::setup::Setup;
use gsk_core::simulation::{RunUntilResult, Simulation, StopCondition};

const SHAFT: &str = "G00 X100 Z5;
G71 U5 R1 F600;
G71 P1 Q4 U0.5 W0.2;
N1 G00 X60;
G01 Z-20 R2;
X70;
N4 G02 X90 Z-30 R10;
G70 P1 Q4;
G74 R0.5;
G74 X90 Z-3 P4000 Q2000 F900;
M30;
";

fn key(byte: u16, bit: u8) -> BitAddress {
    BitAddress::new(Area::X, byte, bit)
}

const FEED_HOLD: (u16, u8) = (24, 7);
const CYCLE_START: (u16, u8) = (25, 0);
const SINGLE_BLOCK: (u16, u8) = (20, 6);

type CycleMove = (u32, gsk_core::command::MoveKind, [i64; 4]);

fn cycle_move(moved: &ExecutedMove) -> CycleMove {
    let round = |value: f64| (value * 1e6).round() as i64;
    let ends = [moved.from.x, moved.from.z, moved.to.x, moved.to.z];
    (moved.source.line, moved.kind, ends.map(round))
}

/// The moves until the run ends.
fn collect_moves(simulation: &mut Simulation) -> Vec<CycleMove> {
    let mut pieces = Vec::new();
    for _ in 0..600_000 {
        if matches!(simulation.cnc.run_state(), RunState::Reset | RunState::Stop) {
            break;
        }
        simulation.tick();
        for event in simulation.cnc.events() {
            if let Event::MoveEnded(moved) = event {
                pieces.push(cycle_move(moved));
            }
        }
    }
    pieces
}

#[test]
fn the_control_cuts_what_the_preview_shows() {
    let setup = Setup::default();
    let mut programs = ProgramMemory::default();
    programs.open_external(Program::new(SHAFT));
    programs.select(ProgramId::External);
    let mut shown = Vec::new();
    let preview = preview(&setup, &programs, &mut |moved| {
        shown.push(cycle_move(moved));
    });
    assert_eq!(preview.alarm, None);
    assert_eq!(
        [51, 52, 56].map(|number| preview.parameters.value(number)),
        [5000, 1000, 500]
    );
    assert_eq!(collect_moves(&mut started(Setup::default(), SHAFT)), shown);
}

#[test]
fn feed_hold_in_a_cycle_waits_for_the_end_of_the_segment() {
    let mut simulation = started(Setup::default(), SHAFT);
    // Into the first cut of G71, X90.5 from Z5.2 to the contour.
    let cutting = |simulation: &Simulation| {
        let at = simulation.cnc.position_absolute();
        (at.x - 45.25).abs() < 1e-9 && at.z < 0.0
    };
    for _ in 0..60_000 {
        if cutting(&simulation) {
            break;
        }
        simulation.tick();
    }
    assert!(cutting(&simulation));
    press(&mut simulation, key(FEED_HOLD.0, FEED_HOLD.1));
    run_ticks(&mut simulation, 10_000);
    assert_eq!(simulation.cnc.run_state(), RunState::Hold);
    // The whole cut is done, and nothing after it. X90.5 is outside the end of the contour,
    // X90 + 0.5, so it ends at Z-30 + 0.2.
    let at = simulation.cnc.position_absolute();
    assert!(
        (at.x - 45.25).abs() < 1e-9 && (at.z + 29.8).abs() < 1e-9,
        "{at:?}"
    );
    press(&mut simulation, key(CYCLE_START.0, CYCLE_START.1));
    assert_eq!(
        simulation.run_until(StopCondition::Stopped, 600_000),
        RunUntilResult::Reached
    );
    let at = simulation.cnc.position_absolute();
    assert_eq!((at.x, at.z), (50.0, 5.0));
}

#[test]
fn single_block_stops_at_the_end_of_every_segment() {
    let mut simulation = Simulation::new(Setup::default());
    run_ticks(&mut simulation, 100);
    let text = "G00 X50 Z2 F600;\nG71 U5 R1;\nG71 P1 Q2;\nN1 G00 X30;\nN2 G01 Z-5;\n";
    let opened = simulation
        .cnc
        .request(ControlRequest::OpenExternal(Program::new(text)));
    assert_eq!(opened, Ok(()));
    press(&mut simulation, key(SINGLE_BLOCK.0, SINGLE_BLOCK.1));
    simulation.start_automatic();
    let mut stops = Vec::new();
    for _ in 0..9 {
        simulation.run_until(StopCondition::Stopped, 60_000);
        let at = simulation.cnc.position_absolute();
        stops.push((2.0 * at.x, at.z));
        press(&mut simulation, key(CYCLE_START.0, CYCLE_START.1));
    }
    assert_eq!(
        stops,
        [
            (50.0, 2.0),
            (50.0, 2.0),
            (40.0, 2.0),
            (40.0, -5.0),
            (42.0, -4.0),
            (42.0, 2.0),
            (30.0, 2.0),
            (30.0, -5.0),
            (50.0, 2.0),
        ]
    );
}
