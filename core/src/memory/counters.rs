//! Part counter and cutting time.

use serde::{Deserialize, Serialize};

/// What the position page counts; kept over power-off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Parts made: ends by M30, and M99 of the main program.
    pub parts: u32,
    /// Time in cutting feed, ms.
    pub cutting_ms: u64,
}

impl Counters {
    /// One more part.
    pub const fn count_part(&mut self) {
        self.parts = self.parts.saturating_add(1);
    }

    /// More time in cutting feed.
    pub const fn count_cutting_ms(&mut self, ms: u64) {
        self.cutting_ms = self.cutting_ms.saturating_add(ms);
    }

    /// Parts to zero.
    pub const fn clear_parts(&mut self) {
        self.parts = 0;
    }

    /// Cutting time to zero.
    pub const fn clear_cutting_time(&mut self) {
        self.cutting_ms = 0;
    }
}
