//! The control as it stands, for whoever previews a program in a thread of his own.

use std::sync::Arc;

use gsk_core::battery::Memory;
use gsk_core::cnc::Cnc;
use gsk_core::setup::Setup;
use gsk_panel::emulator::Emulator;

/// What a preview of this control starts from: its memory, its ladder and its lathe, with
/// the slides and the work zero where they are now. It shares its large parts.
pub fn setup(emulator: &Emulator) -> Setup {
    let simulation = &emulator.simulation;
    let cnc: &Cnc = &simulation.cnc;
    let machine = cnc.position_machine();
    Setup {
        // With the program that can only be run: the battery does not keep that one.
        memory: Memory {
            programs: cnc.programs().clone(),
            ..cnc.battery()
        },
        ladder: Arc::clone(cnc.plc().ladder()).into(),
        plc_retained: Some(cnc.plc().memory().retained()),
        lathe: simulation.lathe.config().clone(),
        start: Some(machine),
        // The offset in force is none of the work zero: the program calls its own.
        absolute: Some(machine - cnc.frame().zero),
        ..Setup::default()
    }
}
