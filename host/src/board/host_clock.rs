//! The clock that drives a board. It continues while the computer sleeps, as the board
//! does; jumps that only the wall clock shows (a paused virtual machine) are reported
//! separately.

use web_time::{Duration, SystemTime};

use crate::platform;

/// Smallest jump of the wall clock that counts as sleep of the computer; smaller ones are
/// corrections of the clock.
const MIN_JUMP: Duration = Duration::from_millis(50);

/// Measures the time since a port was opened, including sleep of the computer.
#[derive(Debug)]
pub struct HostClock {
    started_at: Duration,
    /// Readings at the last check for a jump: the time with sleep, and the wall clock.
    last_check: (Duration, SystemTime),
}

impl HostClock {
    /// Creates a clock that counts the time from now on.
    pub fn start() -> Self {
        let now = platform::time_with_sleep();
        Self {
            started_at: now,
            last_check: (now, SystemTime::now()),
        }
    }

    /// Returns the time since the start, including sleep of the computer.
    pub fn now(&self) -> Duration {
        platform::time_with_sleep().saturating_sub(self.started_at)
    }

    /// Returns the time by which only the wall clock has advanced since the last call;
    /// zero if both clocks agree, or the wall clock was set back.
    pub fn take_wall_clock_jump(&mut self) -> Duration {
        let (now, wall) = (platform::time_with_sleep(), SystemTime::now());
        let (before, wall_before) = core::mem::replace(&mut self.last_check, (now, wall));
        let by_wall = wall.duration_since(wall_before).unwrap_or_default();
        wall_clock_jump(now.saturating_sub(before), by_wall)
    }
}

fn wall_clock_jump(passed: Duration, by_wall: Duration) -> Duration {
    let more = by_wall.saturating_sub(passed);
    if more >= MIN_JUMP {
        more
    } else {
        Duration::ZERO
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jump_is_what_the_wall_clock_has_gained() {
        let ms = Duration::from_millis;
        // Asleep: both clocks show it, and the first alone is enough.
        assert_eq!(wall_clock_jump(ms(3000), ms(3000)), ms(0));
        assert_eq!(wall_clock_jump(ms(2), ms(3002)), ms(3000));
        // Slewed or set back.
        assert_eq!(wall_clock_jump(ms(2), ms(12)), ms(0));
        assert_eq!(wall_clock_jump(ms(3000), ms(0)), ms(0));
    }

    #[test]
    fn the_clock_continues_and_reports_a_jump() {
        let mut clock = HostClock::start();
        let before = clock.now();
        std::thread::sleep(Duration::from_millis(5));
        assert!(clock.now() >= before + Duration::from_millis(5));
        clock.last_check.1 -= Duration::from_secs(3);
        let jump = clock.take_wall_clock_jump();
        assert!(jump >= Duration::from_millis(2500), "{jump:?}");
    }
}
