//! Where the scan stands and pauses inside a slot.

use serde::{Deserialize, Serialize};

/// Where the scan pauses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stop {
    /// At the end of the slot.
    AtEnd,
    /// After one rung; a called subprogram belongs to it.
    AfterRung,
}

/// A place inside a slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Place {
    /// In level 1, or already in the part of level 2.
    pub level1: bool,
    /// Operation that is next.
    pub at: usize,
    /// Operations of this slot so far, as the watchdog counts them.
    pub executed: usize,
}

impl Place {
    /// The beginning of a slot; a program without level 1 begins with level 2.
    pub const fn first(end1: usize) -> Place {
        Place {
            level1: end1 > 0,
            at: 0,
            executed: 0,
        }
    }
}
