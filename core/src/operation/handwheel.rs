//! Counts the detents of the handwheel from its two tracks (manual III-6.2).

use serde::{Deserialize, Serialize};

/// Half graduations that the counter accepts per tick: 500 graduations a second, or
/// five turns of a wheel with 100 graduations. Faster pulses are lost.
const HALVES_PER_TICK: i32 = 1;

/// Half graduations that the counter can accept in one tick after a pause.
const HALVES_AT_ONCE: i32 = 100;

/// Counts the pulses that the handwheel sends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct WheelCounter {
    /// Graduation count at the last tick; `None` before the first tick.
    last: Option<i32>,
    /// Half graduations that the counter can accept in the next tick.
    #[serde(rename = "room")]
    allowance: i32,
}

impl Default for WheelCounter {
    fn default() -> Self {
        Self {
            last: None,
            allowance: HALVES_AT_ONCE,
        }
    }
}

impl WheelCounter {
    /// Counts one tick in which the wheel is at the graduation count `wheel`. Returns the
    /// accepted graduations; negative anticlockwise.
    pub(crate) const fn count_tick(&mut self, wheel: i32) -> i32 {
        let turned = match self.last {
            Some(last) if last == wheel && self.allowance == HALVES_AT_ONCE => return 0,
            Some(last) => wheel.wrapping_sub(last),
            None => 0,
        };
        self.last = Some(wheel);
        self.allowance += HALVES_PER_TICK;
        if self.allowance > HALVES_AT_ONCE {
            self.allowance = HALVES_AT_ONCE;
        }
        let limit = self.allowance / 2;
        let counted = if turned > limit {
            limit
        } else if turned < -limit {
            -limit
        } else {
            turned
        };
        self.allowance -= 2 * counted.abs();
        counted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_turns_a_second_count_and_no_more() {
        let counted = |a_tick: i32| {
            let mut counter = WheelCounter::default();
            counter.count_tick(0);
            let mut sum = 0;
            // Every tenth tick, for ten seconds.
            for tick in 1..=1000 {
                for _ in 0..9 {
                    counter.count_tick((tick - 1) * a_tick);
                }
                sum += counter.count_tick(tick * a_tick);
            }
            sum
        };
        assert_eq!(counted(5), 5000);
        assert_eq!(counted(-5), -5000);
        // Twice as fast: half is lost, but for the first tenth of a second.
        assert!((5000..=5050).contains(&counted(10)), "{}", counted(10));
    }

    #[test]
    fn the_position_at_power_on_is_not_a_motion() {
        assert_eq!(WheelCounter::default().count_tick(1234), 0);
    }
}
