//! A clock that counts the sleep of the computer.

use std::time::Duration;

use rustix::time::{ClockId, clock_gettime};

/// The system clock that also counts while the computer sleeps.
#[cfg(any(target_os = "linux", target_os = "android"))]
const CLOCK: ClockId = ClockId::Boottime;
/// The monotonic clock, which is used on systems other than Linux.
#[cfg(not(any(target_os = "linux", target_os = "android")))]
const CLOCK: ClockId = ClockId::Monotonic;

/// Returns the time since the computer was started, including sleep.
pub fn time_with_sleep() -> Duration {
    let time = clock_gettime(CLOCK);
    let seconds = u64::try_from(time.tv_sec).unwrap_or_default();
    let rest = u32::try_from(time.tv_nsec).unwrap_or_default();
    Duration::new(seconds, rest)
}

/// Returns the time of a clock that all processes of this computer share.
pub fn shared_time() -> Duration {
    time_with_sleep()
}
