//! The machine at the control: contacts, pulses and voltages between both, and the
//! simulated lathe.
//!
//! ```text
//!                 Outputs: Y contacts, pulses, SVC, drive enable
//!          Cnc ──────────────────────────────────────────────► Lathe
//!              ◄──────────────────────────────────────────────
//!                 Inputs: X contacts, index pulses, drives, encoder, handwheel
//! ```

mod axis_drive;
mod chuck;
mod config;
mod config_check;
mod faults;
mod io;
mod lathe;
mod load_limits;
mod picture_config;
pub(crate) mod pins;
mod spindle_drive;
mod turret;
mod wiring;

#[cfg(test)]
mod tests;

pub use config::{
    AxisConfig, ChuckConfig, Dog, LatheConfig, LimitSwitches, ScrewError, ServoConfig, SlideEnds,
    SpindleConfig, TurretConfig,
};
pub use config_check::ConfigError;
pub use faults::{FAULTS, FaultRow, LatheFault};
pub(crate) use io::BoardContacts;
pub use io::{MachineInputs, MachineOutputs, TrippedLimit};
pub use lathe::SimulatedLathe;
pub use load_limits::LoadLimits;
pub use picture_config::{LatheConstruction, PictureConfig, TowerSignals};
