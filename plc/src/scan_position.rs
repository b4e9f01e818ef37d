//! Where the scan stands and pauses inside a slot.

use serde::{Deserialize, Serialize};

/// Where the scan pauses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ScanStop {
    /// At the end of the slot.
    SlotEnd,
    /// After one rung; a called subprogram belongs to it.
    RungEnd,
}

/// A place inside a slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct ScanPosition {
    /// In level 1, or already in the part of level 2.
    pub level1: bool,
    /// Operation that is next.
    #[serde(rename = "at")]
    pub next_op: usize,
    /// Operations of this slot so far, as the watchdog counts them.
    pub executed: usize,
}

impl ScanPosition {
    /// The beginning of a slot; a program without level 1 begins with level 2.
    pub const fn first(end1: usize) -> ScanPosition {
        ScanPosition {
            level1: end1 > 0,
            next_op: 0,
            executed: 0,
        }
    }
}
