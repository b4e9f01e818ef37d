//! Places in programs, and the calls that lead back to one.

use serde::{Deserialize, Serialize};

use crate::command::ProgramId;

/// Where the next block is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Place {
    pub(crate) program: ProgramId,
    /// Index of the block, from 0.
    pub(crate) block: u32,
}

/// A call under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Call {
    /// The program called.
    pub(crate) program: ProgramId,
    /// How many runs are left, the present one included.
    pub(crate) runs: u16,
    /// The block after the call.
    pub(crate) back: Place,
}
