//! The position of the scan within a slot.

use serde::{Deserialize, Serialize};

/// The point at which a run of the scan stops: at the end of the slot or of a rung.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ScanStop {
    /// The scan stops at the end of the slot.
    SlotEnd,
    /// The scan stops at the end of a rung, after the subprograms that the rung calls.
    RungEnd,
}

/// The position of the scan within a slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct ScanPosition {
    /// Whether the scan is in level 1; otherwise it is in the current part of level 2.
    pub level1: bool,
    /// Index of the operation that runs next, in the compiled program.
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
