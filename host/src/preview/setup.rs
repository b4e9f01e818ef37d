//! Makes the setup for a preview of the current control in another thread.

use std::sync::Arc;

use gsk_core::battery::BatteryMemory;
use gsk_core::cnc::Cnc;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;

/// Returns a setup for previews with the memory, ladder and lathe of `simulation` and the
/// current positions of slides and work zero. Large parts of it are shared, not copied.
pub fn make_preview_setup(simulation: &Simulation) -> Setup {
    let cnc: &Cnc = &simulation.cnc;
    let machine = cnc.position_machine();
    Setup {
        // Including the program that can only be run: the battery does not keep it.
        memory: BatteryMemory {
            programs: cnc.programs().clone(),
            ..cnc.battery_memory()
        },
        ladder: Arc::clone(cnc.plc().ladder()).into(),
        plc_retained: Some(cnc.plc().memory().retained()),
        lathe: simulation.lathe.config().clone(),
        start: Some(machine),
        // The active tool offset is not part of the work zero: the program calls its own.
        absolute: Some(machine - cnc.frame().zero),
        ..Setup::default()
    }
}
