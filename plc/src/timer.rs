//! Which timers run: they advance with the 8 ms slots, not with the scan.

use serde::{Deserialize, Serialize};

/// Length of a slot, ms.
pub(crate) const SLOT_MS: i32 = 8;

/// The running timers, one bit a timer T0 to T99.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "[u64; 4]", into = "[u64; 4]")]
pub(crate) struct Timers {
    /// ACT was 1 when the timer was last executed, and its time is not over.
    running: u128,
    /// Running, and executed since the timer's level last began.
    executed: u128,
}

impl Timers {
    /// Notes that a TMRB was executed, and whether its time goes on.
    pub fn record_execution(&mut self, timer: u8, runs: bool) {
        let bit = 1u128 << (timer & 127);
        if runs {
            self.running |= bit;
            self.executed |= bit;
        } else {
            self.running &= !bit;
            self.executed &= !bit;
        }
    }

    /// A new scan of the timers in `scope` begins: those that a jump skipped
    /// in the last scan stand still and keep their value.
    pub(crate) fn begin_scan(&mut self, scope: u128) {
        self.running &= !scope | self.executed;
        self.executed &= !scope;
    }

    /// Numbers of the running timers, upwards.
    pub fn running(&self) -> impl Iterator<Item = u16> {
        let mut rest = self.running;
        std::iter::from_fn(move || {
            if rest == 0 {
                return None;
            }
            let timer = rest.trailing_zeros();
            rest &= rest - 1;
            u16::try_from(timer).ok()
        })
    }
}

impl From<[u64; 4]> for Timers {
    fn from(halves: [u64; 4]) -> Timers {
        let [a, b, c, d] = halves.map(u128::from);
        Timers {
            running: a | b << 64,
            executed: c | d << 64,
        }
    }
}

impl From<Timers> for [u64; 4] {
    fn from(timers: Timers) -> [u64; 4] {
        [
            timers.running as u64,
            (timers.running >> 64) as u64,
            timers.executed as u64,
            (timers.executed >> 64) as u64,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn skipped_timer_stops_running() {
        let mut timers = Timers::default();
        timers.record_execution(3, true);
        timers.record_execution(99, true);
        timers.begin_scan(u128::MAX);
        assert_eq!(timers.running().collect::<Vec<_>>(), [3, 99]);
        timers.record_execution(3, true);
        timers.begin_scan(u128::MAX);
        assert_eq!(timers.running().collect::<Vec<_>>(), [3]);
    }

    #[test]
    fn timers_survive_serialization() {
        let mut timers = Timers::default();
        timers.record_execution(0, true);
        timers.record_execution(70, true);
        timers.record_execution(71, false);
        assert_eq!(Timers::from(<[u64; 4]>::from(timers)), timers);
    }
}
