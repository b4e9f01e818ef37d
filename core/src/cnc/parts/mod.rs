//! Parts of the control; each one owns its state and the functions that need no other part.

mod coordinates;
mod drives;
mod hand;
mod plc_port;
mod run;
mod spindle_unit;
mod switches;

pub(crate) use coordinates::Coordinates;
pub(crate) use drives::Drives;
pub(crate) use hand::HandMotion;
pub(crate) use plc_port::PlcPort;
pub(crate) use run::Run;
pub(crate) use spindle_unit::SpindleUnit;
pub(crate) use switches::Switches;
