//! Paces machine time by wall time: determines how many ticks are due, and measures whether the
//! computer is fast enough.

use web_time::{Duration, Instant};

/// Time between two runs of the kernel thread, ms.
pub const TURN_MS: u64 = 8;
/// Greatest number of ticks in one turn at the speed of a real lathe, so that keys take effect
/// between turns.
const MAX_TICKS_REAL: u64 = 40;
/// Longest delay for which ticks are made up, ms. After a longer one machine time is slower than
/// the clock; no motion is skipped.
const CATCH_UP_MS: u64 = 250;
/// Interval over which the ratio of machine time to wall time is measured.
const WINDOW: Duration = Duration::from_secs(2);

/// Greatest number of ticks in one turn at the speed of the computer.
const MAX_TICKS_FASTEST: u64 = 100_000;

/// Speed of machine time while a program runs on the simulated lathe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunSpeed {
    /// Machine time divided by wall time, in per cent.
    Percent(u32),
    /// Machine time runs as fast as the computer can simulate it.
    Fastest,
}

impl RunSpeed {
    /// The speed of a real lathe: 100 %.
    pub const REAL: Self = Self::Percent(100);

    /// Speeds that the operator can select, the slowest first.
    pub const CHOICES: [Self; 11] = [
        Self::Percent(10),
        Self::Percent(25),
        Self::Percent(50),
        Self::REAL,
        Self::Percent(200),
        Self::Percent(500),
        Self::Percent(1000),
        Self::Percent(2000),
        Self::Percent(5000),
        Self::Percent(10_000),
        Self::Fastest,
    ];
}

/// Determines how many ticks of 1 ms are due at the selected speed.
#[derive(Clone, Copy, Debug)]
pub struct TickPacer {
    speed: RunSpeed,
    /// Wall time that corresponds to tick zero.
    origin: Instant,
    done_ticks: u64,
    /// Wall time of the last call of [`Self::take_due`].
    last_due_call: Instant,
    window_start: Instant,
    window_done_ticks: u64,
    ratio: f64,
}

impl TickPacer {
    /// Creates a pacer whose tick zero is at `now`, at the speed of a real lathe.
    pub const fn new(now: Instant) -> Self {
        Self {
            speed: RunSpeed::REAL,
            origin: now,
            done_ticks: 0,
            last_due_call: now,
            window_start: now,
            window_done_ticks: 0,
            ratio: 1.0,
        }
    }

    /// Returns the current speed of machine time.
    pub const fn speed(&self) -> RunSpeed {
        self.speed
    }

    /// Sets the speed of machine time; at a change drops the ticks that are due at the old speed.
    pub fn set_speed(&mut self, speed: RunSpeed, now: Instant) {
        if speed == self.speed {
            return;
        }
        let ratio = match speed {
            RunSpeed::Percent(percent) => f64::from(percent) / 100.0,
            RunSpeed::Fastest => self.ratio,
        };
        *self = Self {
            speed,
            ratio,
            ..Self::new(now)
        };
    }

    /// Returns the number of ticks to run now; they count as done.
    pub fn take_due(&mut self, now: Instant) -> u64 {
        self.measure_ratio(now);
        self.last_due_call = now;
        let due = match self.speed {
            RunSpeed::Percent(percent) => self.due_at(u64::from(percent.max(1)), now),
            RunSpeed::Fastest => MAX_TICKS_FASTEST,
        };
        self.done_ticks += due;
        due
    }

    fn due_at(&mut self, percent: u64, now: Instant) -> u64 {
        let elapsed = micros(now.saturating_duration_since(self.origin));
        let overdue_ticks =
            (elapsed.saturating_mul(percent) / 100_000).saturating_sub(self.done_ticks);
        let catch_up = (CATCH_UP_MS * percent / 100).max(1);
        if overdue_ticks > catch_up {
            self.origin += Duration::from_micros((overdue_ticks - catch_up) * 100_000 / percent);
        }
        overdue_ticks.min((MAX_TICKS_REAL * percent / 100).max(1))
    }

    /// Makes this number of ticks due again: [`Self::take_due`] has returned them, but there was no
    /// time to run them.
    pub const fn give_back(&mut self, ticks: u64) {
        self.done_ticks = self.done_ticks.saturating_sub(ticks);
    }

    /// Returns the time at which the next ticks are due.
    pub fn next_due(&self) -> Instant {
        match self.speed {
            RunSpeed::Percent(percent) => {
                let wall = self.done_ticks.saturating_mul(100_000) / u64::from(percent.max(1));
                self.origin + Duration::from_micros(wall) + Duration::from_millis(TURN_MS)
            }
            RunSpeed::Fastest => self.last_due_call,
        }
    }

    /// Returns machine time divided by wall time, measured over 2 s: that of the current speed
    /// unless the computer is too slow.
    pub const fn ratio(&self) -> f64 {
        self.ratio
    }

    fn measure_ratio(&mut self, now: Instant) {
        let wall = now.saturating_duration_since(self.window_start);
        if wall < WINDOW {
            return;
        }
        let ran = self.done_ticks.saturating_sub(self.window_done_ticks);
        let ratio = ran as f64 / (wall.as_secs_f64() * 1000.0);
        self.ratio = match self.speed {
            // Catching up after a pause may run a little faster than the clock.
            RunSpeed::Percent(percent) => ratio.min(f64::from(percent) / 100.0),
            RunSpeed::Fastest => ratio,
        };
        self.window_start = now;
        self.window_done_ticks = self.done_ticks;
    }
}

fn micros(duration: Duration) -> u64 {
    u64::try_from(duration.as_micros()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_follow_the_clock_without_drift() {
        let start = Instant::now();
        let mut pace = TickPacer::new(start);
        let mut ran = 0;
        for step in 1..=1000u64 {
            ran += pace.take_due(start + Duration::from_micros(step * 8_300));
        }
        assert_eq!(ran, 8300);
        assert_eq!(pace.next_due(), start + Duration::from_millis(8308));
    }

    #[test]
    fn a_short_delay_is_caught_up_and_a_long_one_is_dropped() {
        let start = Instant::now();
        let mut pace = TickPacer::new(start);
        let mut ran = 0;
        for _ in 0..20 {
            ran += pace.take_due(start + Duration::from_millis(200));
        }
        assert_eq!(ran, 200);
        // Asleep for one hour.
        let later = start + Duration::from_secs(3600);
        let mut ran = 0;
        for _ in 0..20 {
            ran += pace.take_due(later);
        }
        assert_eq!(ran, CATCH_UP_MS);
        assert!(pace.next_due() <= later + Duration::from_millis(TURN_MS));
    }

    #[test]
    fn a_slow_computer_shows_in_the_ratio() {
        let start = Instant::now();
        let mut pace = TickPacer::new(start);
        // 40 ticks take 80 ms.
        for step in 1..=50u64 {
            pace.take_due(start + Duration::from_millis(step * 80));
        }
        assert!((pace.ratio() - 0.5).abs() < 0.05, "{}", pace.ratio());
    }

    #[test]
    fn other_speeds_follow_the_clock_too() {
        for (percent, expected) in [(10, 1000), (100, 10_000), (10_000, 1_000_000)] {
            let start = Instant::now();
            let mut pace = TickPacer::new(start);
            pace.set_speed(RunSpeed::Percent(percent), start);
            let ran: u64 = (1..=1250u64)
                .map(|step| pace.take_due(start + Duration::from_millis(step * 8)))
                .sum();
            assert_eq!(ran, expected, "{percent} %");
            assert!((pace.ratio() - f64::from(percent) / 100.0).abs() < 0.01);
            assert!(pace.next_due() > start + Duration::from_secs(10));
        }
    }

    #[test]
    fn what_a_slow_computer_does_not_run_is_not_caught_up_for_ever() {
        let start = Instant::now();
        let mut pace = TickPacer::new(start);
        pace.set_speed(RunSpeed::Percent(10_000), start);
        let mut ran = 0;
        for step in 1..=500u64 {
            let due = pace.take_due(start + Duration::from_millis(step * 10));
            let done = due.min(300);
            pace.give_back(due - done);
            ran += done;
        }
        assert!((pace.ratio() - 30.0).abs() < 0.5, "{}", pace.ratio());
        assert!(ran <= 150_000);
        // At the speed of a real lathe no ticks are due from before.
        let now = start + Duration::from_secs(5);
        pace.set_speed(RunSpeed::REAL, now);
        assert_eq!(pace.take_due(now + Duration::from_millis(8)), 8);
        pace.set_speed(RunSpeed::Fastest, now);
        assert_eq!(pace.take_due(now), MAX_TICKS_FASTEST);
        assert_eq!(pace.next_due(), now, "it does not sleep");
    }
}
