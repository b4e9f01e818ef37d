//! Manual motion during a program (manual III-5.1.5, I-3.2.6).

use crate::bench::{press, run_ticks};
use gsk_core::cnc::ControlRequest;
use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::{RunUntilResult, Simulation, StopCondition};
use gsk_core::units::Point;

const MINUTE: u64 = 60_000;

const fn key(byte: u16, bit: u8) -> BitAddress {
    BitAddress::new(Area::X, byte, bit)
}

const AUTO: BitAddress = key(20, 1);
const JOG: BitAddress = key(20, 5);
const HOLD: BitAddress = key(24, 7);
const START: BitAddress = key(25, 0);
const X_DOWN: BitAddress = key(23, 1);

/// A running program; M functions take `m_time` ms.
fn started(text: &str, m_time: i32) -> Simulation {
    let mut setup = Setup::default();
    assert!(setup.memory.parameters.set(80, m_time).is_ok());
    let mut simulation = Simulation::new(setup);
    run_ticks(&mut simulation, 100);
    let opened = simulation
        .cnc
        .request(ControlRequest::OpenExternal(Program::new(text)));
    assert_eq!(opened, Ok(()));
    simulation.start_automatic();
    simulation
}

/// Jogs X for a time and returns to AUTO. Returns the distance.
fn jog_x(simulation: &mut Simulation, time: u32) -> Point {
    let before = simulation.cnc.position_machine();
    press(simulation, JOG);
    simulation.cnc.set_panel_key(X_DOWN, true);
    run_ticks(simulation, time);
    simulation.cnc.set_panel_key(X_DOWN, false);
    run_ticks(simulation, 1000);
    press(simulation, AUTO);
    let moved = simulation.cnc.position_machine() - before;
    assert!(moved.x > 0.1 && moved.z == 0.0, "{moved:?}");
    moved
}

fn run_to_end(simulation: &mut Simulation) {
    press(simulation, START);
    assert_eq!(
        simulation.run_until(StopCondition::Stopped, 10 * MINUTE),
        RunUntilResult::Reached
    );
    assert!(simulation.cnc.alarms().is_empty());
}

#[track_caller]
fn assert_stopped_at(simulation: &Simulation, x: f64, z: f64) {
    let at = simulation.cnc.position_absolute();
    let near = (at.x - x).abs() < 1e-6 && (at.z - z).abs() < 1e-6;
    assert!(near, "at radius {} Z{}, not {x} Z{z}", at.x, at.z);
}

const ROUGHING: &str = "O0001\nG00 X50 Z5\nG71 U2 R1\nG71 P10 Q20 U0 W0 F2000\nN10 G00 X30\n\
    N20 G01 Z-40\nM00\nG00 X60 Z10\nM30\n";

#[test]
fn the_rest_of_a_cycle_is_shifted_by_the_manual_motion() {
    let mut simulation = started(ROUGHING, 500);
    // At radius 25 Z5 the cycle begins; its first cut is along Z at radius 23.
    for _ in 0..MINUTE {
        simulation.tick();
        if simulation.cnc.position_absolute().z < 0.0 {
            break;
        }
    }
    press(&mut simulation, HOLD);
    run_ticks(&mut simulation, 3000);
    assert_eq!(simulation.cnc.run_state(), RunState::Hold);
    let moved = jog_x(&mut simulation, 1000);
    run_to_end(&mut simulation);
    // The cycle ends at its start point, shifted; the next block goes to its programmed point.
    assert_stopped_at(&simulation, 25.0 + moved.x, 5.0);
    run_to_end(&mut simulation);
    assert_stopped_at(&simulation, 30.0, 10.0);
}

#[test]
fn without_manual_motion_a_stopped_cycle_continues_in_place() {
    let mut simulation = started(ROUGHING, 500);
    run_ticks(&mut simulation, 5000);
    press(&mut simulation, HOLD);
    run_ticks(&mut simulation, 3000);
    run_to_end(&mut simulation);
    assert_stopped_at(&simulation, 25.0, 5.0);
}

#[test]
fn a_held_block_finishes_shifted_and_the_next_block_reaches_its_point() {
    let mut simulation = started("O0001\nG98 G01 Z280 F600\nM00\nG01 X290 Z270\nM30\n", 500);
    run_ticks(&mut simulation, 1000);
    press(&mut simulation, HOLD);
    run_ticks(&mut simulation, 1000);
    assert_eq!(simulation.cnc.run_state(), RunState::Hold);
    let moved = jog_x(&mut simulation, 2000);
    run_to_end(&mut simulation);
    assert_stopped_at(&simulation, 150.0 + moved.x, 280.0);
    run_to_end(&mut simulation);
    assert_stopped_at(&simulation, 145.0, 270.0);
}

/// A block without motion is held, and ends meanwhile. No part of it remains.
#[test]
fn hold_acts_again_after_jogging_in_a_held_m_block() {
    let mut simulation = started("O0001\nM03 S500\nG98 G01 Z200 F600\nG01 Z300\nM30\n", 5000);
    run_ticks(&mut simulation, 300);
    press(&mut simulation, HOLD);
    jog_x(&mut simulation, 1000);
    assert_eq!(simulation.cnc.run_state(), RunState::Hold);
    run_ticks(&mut simulation, 5000);
    assert_eq!(simulation.cnc.run_state(), RunState::Stop);
    press(&mut simulation, START);
    for _ in 0..3000 {
        simulation.tick();
        if simulation.cnc.position_absolute().z < 290.0 {
            break;
        }
    }
    press(&mut simulation, HOLD);
    run_ticks(&mut simulation, 1000);
    assert_eq!(simulation.cnc.run_state(), RunState::Hold);
    let held = simulation.cnc.position_absolute();
    run_ticks(&mut simulation, 1000);
    assert_eq!(simulation.cnc.position_absolute(), held);
    assert!(held.z > 250.0, "{held:?}");
    run_to_end(&mut simulation);
}
