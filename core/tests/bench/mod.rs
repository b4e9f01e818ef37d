//! Time and keys for tests of the whole control.

use gsk_core::cnc::Request;
use gsk_core::plc::address::BitAddress;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;

/// A machine that has come up, with an opened program.
#[track_caller]
pub fn with_program(setup: Setup, text: &str) -> Simulation {
    let mut simulation = Simulation::new(setup);
    ticks(&mut simulation, 100);
    let program = Request::OpenExternal(Program::new(text));
    assert_eq!(simulation.cnc.request(program), Ok(()));
    simulation
}

/// The same with the program started.
#[track_caller]
pub fn started(setup: Setup, text: &str) -> Simulation {
    let mut simulation = with_program(setup, text);
    simulation.start_automatic();
    simulation
}

/// Lets so many milliseconds pass.
pub fn ticks(simulation: &mut Simulation, count: u32) {
    for _ in 0..count {
        simulation.tick();
    }
}

/// Presses a key of the machine panel as a finger does: down 100 ms, up 100 ms.
pub fn press(simulation: &mut Simulation, key: BitAddress) {
    for down in [true, false] {
        simulation.cnc.set_panel_key(key, down);
        ticks(simulation, 100);
    }
}
