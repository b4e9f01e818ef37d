//! Date and time of day where the computer stands.

use gsk_core::memory::DayTime;

/// Now, as a clock on the wall shows it.
pub fn day_time() -> DayTime {
    let now = chrono::Local::now().naive_local();
    DayTime::from_seconds(now.and_utc().timestamp())
}
