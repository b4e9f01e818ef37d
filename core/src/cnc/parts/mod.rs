//! Parts of the control; each one owns its state and the functions that need no other part.

mod coordinates;
mod drives;
mod manual_motion;
mod plc_port;
mod run;
mod spindle_unit;
mod switches;

pub(crate) use coordinates::Coordinates;
pub(crate) use drives::DriveUnit;
pub(crate) use manual_motion::ManualMotion;
pub(crate) use plc_port::PlcPort;
pub(crate) use run::CncRun;
pub use run::RunStop;
pub(crate) use spindle_unit::SpindleUnit;
pub(crate) use switches::WriteSwitches;
