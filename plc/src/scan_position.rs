//! The position of the scan within a slot.

use serde::{Deserialize, Serialize};

/// Where a run of the scan stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ScanStop {
    /// At the end of the slot.
    SlotEnd,
    /// The scan stops at the end of a rung, after the subprograms that the rung calls.
    RungEnd,
}

/// A position within a slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct ScanPosition {
    /// Whether the scan is in level 1; otherwise it is in the part of level 2.
    pub level1: bool,
    /// Index of the operation that runs next.
    #[serde(rename = "at")]
    pub next_op: usize,
    /// Number of operations in this slot so far, for the watchdog.
    pub executed: usize,
}

impl ScanPosition {
    /// Returns the start of a slot. `end1` is the index of END1; a program without level 1
    /// starts with level 2.
    pub const fn first(end1: usize) -> ScanPosition {
        ScanPosition {
            level1: end1 > 0,
            next_op: 0,
            executed: 0,
        }
    }
}
