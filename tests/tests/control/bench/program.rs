//! A machine with a program, for tests of the whole control.

use gsk_core::cnc::ControlRequest;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;

/// A machine after power-on with an opened program.
#[track_caller]
pub fn with_program(setup: Setup, text: &str) -> Simulation {
    let mut simulation = Simulation::new(setup);
    for _ in 0..100 {
        simulation.tick();
    }
    let program = ControlRequest::OpenExternal(Program::new(text));
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
