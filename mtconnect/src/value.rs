//! The value of a data item, and the machine from which it is read.

use std::fmt;
use std::sync::Arc;

use gsk_core::cnc::Cnc;
use gsk_core::machine::SimulatedLathe;
use gsk_workpiece::job::Job;

/// The machine from which values are read.
#[derive(Clone, Copy, Debug)]
pub struct MachineSource<'a> {
    /// The control.
    pub cnc: &'a Cnc,
    /// The simulated lathe, also beside a pulse board.
    pub lathe: &'a SimulatedLathe,
    /// Job of the selected program; `None` without one.
    pub job: Option<&'a Job>,
    /// Machine time since the cycle start of the current or the last run, ms.
    pub run_ms: u64,
}

/// The value of a data item.
#[derive(Clone, Debug, PartialEq)]
pub enum AgentValue {
    /// The lathe does not have the quantity, or does not report it now.
    Unavailable,
    /// A number in the unit of the item.
    Number(f64),
    /// X, Y and Z, mm.
    Point([f64; 3]),
    /// A word that the standard lists.
    Word(&'static str),
    /// A text of the machine.
    Text(Arc<str>),
    /// The element and the identifier of an asset.
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

/// Identifier of the asset of a tool of the job.
pub(crate) fn tool_asset_id(number: u8) -> String {
    format!("T{number:02}")
}
