//! Part counter, cutting time and the related counters of macro B.

use serde::{Deserialize, Serialize};

/// The part counter wraps to 0 at this value: it has four digits (manual III-2.1.1).
const PART_COUNT_LIMIT: u32 = 10_000;
/// The number of required parts (#3902) must be below this value.
const REQUIRED_PARTS_LIMIT: u32 = 10_000;
/// The timer of cycle start wraps to 0 at this value, ms: 1145324.612 h.
const STARTED_LIMIT_MS: u64 = 4_123_168_603_200;
/// The cutting time wraps to 0 at this value, ms: it has two digits for hours.
const CUTTING_LIMIT_MS: u64 = 100 * 60 * 60 * 1000;

/// Counters that are kept over power-off: those of the position page, and two of macro B.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Number of parts made: each M30, and each M99 of the main program, adds one.
    pub parts: u32,
    /// Time spent in cutting feed, ms; less than [`Self::CUTTING_LIMIT_MS`].
    pub cutting_ms: u64,
    /// Number of required parts: #3902 of macro B. No page shows it.
    #[serde(default, skip_serializing_if = "is_zero_u32")]
    pub required: u32,
    /// Time for which the cycle-start lamp was on, ms: #3002 of macro B.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub started_ms: u64,
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "the form that serde asks for"
)]
const fn is_zero_u32(value: &u32) -> bool {
    *value == 0
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "the form that serde asks for"
)]
const fn is_zero(value: &u64) -> bool {
    *value == 0
}

/// The sum of `before` and `ms`, wrapped to 0 at `limit`. `before` may exceed the limit if it
/// comes from a file.
const fn add_wrapping(before: u64, ms: u64, limit: u64) -> u64 {
    let sum = before.saturating_add(ms);
    if sum < limit {
        sum
    } else {
        (before % limit + ms) % limit
    }
}

impl Counters {
    /// The part counter wraps to 0 at this value.
    pub const PART_COUNT_LIMIT: u32 = PART_COUNT_LIMIT;
    /// The cutting time wraps to 0 at this value, ms.
    pub const CUTTING_LIMIT_MS: u64 = CUTTING_LIMIT_MS;
    /// The number of required parts must be below this value.
    pub const REQUIRED_PARTS_LIMIT: u32 = REQUIRED_PARTS_LIMIT;
    /// The time of cycle start wraps to 0 at this value, ms.
    pub const STARTED_LIMIT_MS: u64 = STARTED_LIMIT_MS;

    /// Adds one finished part; after 9999 the counter continues at 0.
    pub(crate) const fn count_part(&mut self) {
        self.parts = (self.parts % PART_COUNT_LIMIT + 1) % PART_COUNT_LIMIT;
    }

    /// Adds time in cutting feed, ms; 00:00:00 follows 99:59:59.
    pub(crate) const fn count_cutting_ms(&mut self, ms: u64) {
        self.cutting_ms = add_wrapping(self.cutting_ms, ms, CUTTING_LIMIT_MS);
    }

    /// Adds time for which the cycle-start lamp was on, ms.
    pub(crate) const fn count_started_ms(&mut self, ms: u64) {
        self.started_ms = add_wrapping(self.started_ms, ms, STARTED_LIMIT_MS);
    }

    /// Sets the number of parts to 0.
    pub(crate) const fn clear_parts(&mut self) {
        self.parts = 0;
    }

    /// Sets the cutting time to 0.
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
            cutting_ms: CUTTING_LIMIT_MS - 1,
            started_ms: STARTED_LIMIT_MS - 1,
            required: 0,
        };
        counters.count_part();
        counters.count_cutting_ms(1);
        counters.count_started_ms(1);
        assert_eq!(counters, Counters::default());
    }
}
