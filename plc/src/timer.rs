//! The running timers. They advance with the 8 ms slots, not with the scan.

use serde::{Deserialize, Serialize};

/// Duration of a slot, ms.
pub(crate) const SLOT_MS: i32 = 8;

/// The sets of running timers, one bit for each of T0 to T99.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "[u64; 4]", into = "[u64; 4]")]
pub(crate) struct Timers {
    /// Timers whose ACT was 1 at their last execution and whose time has not elapsed.
    running: u128,
    /// Bit set of the running timers that were executed in the current scan of their level.
    executed: u128,
}

impl Timers {
    /// Records the execution of the TMRB with the number `timer`. `runs`: ACT is 1 and the
    /// time has not elapsed.
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

    /// Starts a new scan of the timers in `scope`, one bit per timer number. Timers that a
    /// jump skipped in the last scan stop and keep their value.
    pub(crate) fn begin_scan(&mut self, scope: u128) {
        self.running &= !scope | self.executed;
        self.executed &= !scope;
    }

    /// Returns the numbers of the running timers, in ascending order.
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
