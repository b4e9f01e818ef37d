//! Local date and time of day.

use chrono::Timelike;
use gsk_core::memory::DayTime;

/// Returns the current local date and time of day.
pub fn day_time() -> DayTime {
    let now = chrono::Local::now().naive_local();
    DayTime::from_seconds(now.and_utc().timestamp())
}

/// Returns the local time of day as `14:03:27`.
pub fn clock_text() -> String {
    let now = chrono::Local::now();
    format!("{:02}:{:02}:{:02}", now.hour(), now.minute(), now.second())
}
