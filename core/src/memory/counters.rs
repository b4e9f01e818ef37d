//! Part counter and cutting time.

use serde::{Deserialize, Serialize};

/// The part counter has four digits (manual III-2.1.1).
const PARTS: u32 = 10_000;
/// Parts that may be required, as macro B names them.
const REQUIRED: u32 = 10_000;
/// Hours that the timer of cycle start counts, 1145324.612, as ms.
const STARTED_MS: u64 = 4_123_168_603_200;
/// The cutting time has two digits for the hours.
const CUTTING_MS: u64 = 100 * 60 * 60 * 1000;

/// What the position page counts; kept over power-off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Parts made: ends by M30, and M99 of the main program.
    pub parts: u32,
    /// Time in cutting feed, ms.
    pub cutting_ms: u64,
    /// Parts to be made: #3902 of macro B, which no page shows.
    #[serde(default, skip_serializing_if = "is_zero_u32")]
    pub required: u32,
    /// Time with the lamp of cycle start on, ms: #3002 of macro B.
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

/// `ms` more; from `limit` on it begins at 0 again. What was read may be anything.
const fn counted(before: u64, ms: u64, limit: u64) -> u64 {
    let sum = before.saturating_add(ms);
    if sum < limit {
        sum
    } else {
        (before % limit + ms) % limit
    }
}

impl Counters {
    /// After as many parts the counter is at 0 again.
    pub const PARTS: u32 = PARTS;
    /// After as many milliseconds the cutting time is.
    pub const CUTTING_MS: u64 = CUTTING_MS;
    /// As many parts and more cannot be required.
    pub const REQUIRED: u32 = REQUIRED;
    /// After as many milliseconds the time of cycle start is.
    pub const STARTED_MS: u64 = STARTED_MS;

    /// One more part; after 9999 comes 0.
    pub(crate) const fn count_part(&mut self) {
        self.parts = (self.parts % PARTS + 1) % PARTS;
    }

    /// More time in cutting feed; after 99:59:59 comes 00:00:00.
    pub(crate) const fn count_cutting_ms(&mut self, ms: u64) {
        self.cutting_ms = counted(self.cutting_ms, ms, CUTTING_MS);
    }

    /// More time with cycle start on.
    pub(crate) const fn count_started_ms(&mut self, ms: u64) {
        self.started_ms = counted(self.started_ms, ms, STARTED_MS);
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
            started_ms: STARTED_MS - 1,
            required: 0,
        };
        counters.count_part();
        counters.count_cutting_ms(1);
        counters.count_started_ms(1);
        assert_eq!(counters, Counters::default());
    }
}
