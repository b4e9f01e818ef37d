//! Local date and time of day.

use gsk_core::memory::DayTime;

/// Returns the current local date and time of day.
pub fn day_time() -> DayTime {
    let now = chrono::Local::now().naive_local();
    DayTime::from_seconds(now.and_utc().timestamp())
}
