//! Time and keys for tests of the whole control.

pub mod board;
pub mod dice;
pub mod keys;
pub mod program;

use gsk_core::plc::address::BitAddress;
use gsk_core::simulation::Simulation;

/// Simulates a number of milliseconds.
pub fn run_ticks(simulation: &mut Simulation, count: u32) {
    for _ in 0..count {
        simulation.tick();
    }
}

/// Presses a key of the machine panel like a finger: down 100 ms, up 100 ms.
pub fn press(simulation: &mut Simulation, key: BitAddress) {
    for down in [true, false] {
        simulation.cnc.set_panel_key(key, down);
        run_ticks(simulation, 100);
    }
}
