//! The value of a data item, and the machine from which it is read.

use std::fmt;
use std::sync::Arc;

use gsk_core::cnc::Cnc;
use gsk_core::machine::SimulatedLathe;
use gsk_workpiece::job::Job;

/// The load of the current cut, % of what the machine bears.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MachineLoad {
    /// Torque of the spindle, compared to its torque at the current speed.
    pub spindle: f64,
    /// Force of the slide X.
    pub x: f64,
    /// Force of the slide Z.
    pub z: f64,
}

/// Control, lathe and job from which the values of data items are read.
#[derive(Clone, Copy, Debug)]
pub struct MachineSource<'a> {
    /// The control from which values are read.
    pub cnc: &'a Cnc,
    /// The simulated lathe, which also exists while a pulse board moves the axes.
    pub lathe: &'a SimulatedLathe,
    /// Job of the selected program; `None` without one.
    pub job: Option<&'a Job>,
    /// Load of the simulated lathe; `None` if it is not known.
    pub load: Option<MachineLoad>,
    /// Machine time since the cycle start of the current or the last run, ms.
    pub run_ms: u64,
}

/// The observed value of a data item.
#[derive(Clone, Debug, PartialEq)]
pub enum AgentValue {
    /// The lathe does not have the quantity, or does not report it now.
    Unavailable,
    /// A number in the unit of the data item.
    Number(f64),
    /// A point: X, Y and Z, mm.
    Point([f64; 3]),
    /// One of the words that the MTConnect standard lists for the item.
    Word(&'static str),
    /// A free text, such as a block or a program name.
    Text(Arc<str>),
    /// XML element and identifier of an asset.
    Asset(&'static str, Arc<str>),
}

impl fmt::Display for AgentValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unavailable => f.write_str("UNAVAILABLE"),
            Self::Number(number) => number.fmt(f),
            Self::Point([x, y, z]) => write!(f, "{x} {y} {z}"),
            Self::Word(word) => f.write_str(word),
            Self::Text(text) | Self::Asset(_, text) => f.write_str(text),
        }
    }
}

/// Returns the identifier of the asset for a tool of the job, by its tool number.
pub(crate) fn tool_asset_id(number: u8) -> String {
    format!("T{number:02}")
}
