//! Machine time against wall time: how many ticks are due, and whether the PC
//! keeps up.

use std::time::{Duration, Instant};

/// The kernel thread wakes up every so many milliseconds.
pub const BATCH_MS: u64 = 8;
/// The most ticks run in one go, so that keys are seen in between.
const MOST_AT_ONCE: u64 = 40;
/// What is missed beyond this is never caught up: the machine is slower than
/// the clock then, and no motion is skipped.
const CATCH_UP_MS: u64 = 250;
/// The ratio is measured over this time.
const WINDOW: Duration = Duration::from_secs(2);

/// Paces ticks of one millisecond.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// Wall time at which tick zero would have run.
    origin: Instant,
    done: u64,
    window_start: Instant,
    window_done: u64,
    ratio: f64,
}

impl Pace {
    /// Starts at a moment.
    pub const fn new(now: Instant) -> Self {
        Self {
            origin: now,
            done: 0,
            window_start: now,
            window_done: 0,
            ratio: 1.0,
        }
    }

    /// The number of ticks to run now; they count as done.
    pub fn due(&mut self, now: Instant) -> u64 {
        self.measure(now);
        let elapsed = millis(now.saturating_duration_since(self.origin));
        let behind = elapsed.saturating_sub(self.done);
        if behind > CATCH_UP_MS {
            self.origin += Duration::from_millis(behind - CATCH_UP_MS);
        }
        let due = behind.min(MOST_AT_ONCE);
        self.done += due;
        due
    }

    /// When the next ticks are due.
    pub fn next(&self) -> Instant {
        self.origin + Duration::from_millis(self.done + BATCH_MS)
    }

    /// Machine time over wall time in the last two seconds: 1 unless the PC is too
    /// slow.
    pub const fn ratio(&self) -> f64 {
        self.ratio
    }

    fn measure(&mut self, now: Instant) {
        let wall = now.saturating_duration_since(self.window_start);
        if wall < WINDOW {
            return;
        }
        let ran = self.done - self.window_done;
        let ratio = ran as f64 / (wall.as_secs_f64() * 1000.0);
        // Catching up after a pause may run a little faster than the clock.
        self.ratio = ratio.min(1.0);
        self.window_start = now;
        self.window_done = self.done;
    }
}

fn millis(duration: Duration) -> u64 {
    u64::try_from(duration.as_millis()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_follow_the_clock_without_drift() {
        let start = Instant::now();
        let mut pace = Pace::new(start);
        let mut ran = 0;
        for step in 1..=1000u64 {
            ran += pace.due(start + Duration::from_micros(step * 8_300));
        }
        assert_eq!(ran, 8300);
        assert_eq!(pace.next(), start + Duration::from_millis(8308));
    }

    #[test]
    fn a_short_delay_is_caught_up_and_a_long_one_is_dropped() {
        let start = Instant::now();
        let mut pace = Pace::new(start);
        let mut ran = 0;
        for _ in 0..20 {
            ran += pace.due(start + Duration::from_millis(200));
        }
        assert_eq!(ran, 200);
        // An hour asleep.
        let later = start + Duration::from_secs(3600);
        let mut ran = 0;
        for _ in 0..20 {
            ran += pace.due(later);
        }
        assert_eq!(ran, CATCH_UP_MS);
        assert!(pace.next() <= later + Duration::from_millis(BATCH_MS));
    }

    #[test]
    fn a_slow_computer_shows_in_the_ratio() {
        let start = Instant::now();
        let mut pace = Pace::new(start);
        // 40 ticks take 80 ms.
        for step in 1..=50u64 {
            pace.due(start + Duration::from_millis(step * 80));
        }
        assert!((pace.ratio() - 0.5).abs() < 0.05, "{}", pace.ratio());
    }
}
