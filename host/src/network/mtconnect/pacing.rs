//! Slows a simulated machine down to the speed of a real lathe, so that clients on the network
//! can follow it.

use std::thread;

use web_time::{Duration, Instant};

/// Number of ticks of 1 ms after which machine time waits for the wall clock.
const WAIT_TICKS: u64 = 10;

/// Delays ticks so that machine time does not run faster than the wall clock.
#[derive(Clone, Copy, Debug)]
pub struct MachinePacer {
    start: Instant,
    /// Number of ticks since the start.
    ticks: u64,
}

impl Default for MachinePacer {
    /// Starts to count ticks at the current wall time.
    fn default() -> Self {
        Self {
            start: Instant::now(),
            ticks: 0,
        }
    }
}

impl MachinePacer {
    /// Counts a tick, and waits if the machine is ahead of the wall clock. A computer that is too
    /// slow does not catch up.
    pub fn wait_for_tick(&mut self) {
        self.ticks += 1;
        if !self.ticks.is_multiple_of(WAIT_TICKS) {
            return;
        }
        let due = self.start + Duration::from_millis(self.ticks);
        let now = Instant::now();
        if now < due {
            thread::sleep(due - now);
        } else if now.duration_since(due) > Duration::from_secs(1) {
            *self = Self::default();
        }
    }
}
