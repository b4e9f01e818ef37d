//! Part counter and cutting time.

use serde::{Deserialize, Serialize};

/// The part counter has four digits (manual III-2.1.1).
const PARTS: u32 = 10_000;
/// The cutting time has two digits for the hours.
const CUTTING_MS: u64 = 100 * 60 * 60 * 1000;

/// What the position page counts; kept over power-off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Parts made: ends by M30, and M99 of the main program.
    pub parts: u32,
    /// Time in cutting feed, ms.
    pub cutting_ms: u64,
}

impl Counters {
    /// After as many parts the counter is at 0 again.
    pub const PARTS: u32 = PARTS;
    /// After as many milliseconds the cutting time is.
    pub const CUTTING_MS: u64 = CUTTING_MS;

    /// One more part; after 9999 comes 0.
    pub(crate) const fn count_part(&mut self) {
        self.parts = (self.parts % PARTS + 1) % PARTS;
    }

    /// More time in cutting feed; after 99:59:59 comes 00:00:00.
    pub(crate) const fn count_cutting_ms(&mut self, ms: u64) {
        self.cutting_ms = (self.cutting_ms % CUTTING_MS + ms) % CUTTING_MS;
    }

    /// Parts to zero.
    pub(crate) const fn clear_parts(&mut self) {
        self.parts = 0;
    }

    /// Cutting time to zero.
    pub(crate) const fn clear_cutting_time(&mut self) {
        self.cutting_ms = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_counters_start_again_after_their_last_digit() {
        let mut counters = Counters {
            parts: 9999,
            cutting_ms: CUTTING_MS - 1,
        };
        counters.count_part();
        counters.count_cutting_ms(1);
        assert_eq!(counters, Counters::default());
    }
}
