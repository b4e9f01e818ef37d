//! The clock of a page.

use std::cell::Cell;

use web_time::{Duration, Instant};

thread_local! {
    static BEGUN: Cell<Option<Instant>> = const { Cell::new(None) };
}

/// Returns the time since the first call. The browser decides whether it counts the sleep
/// of the computer.
pub fn time_with_sleep() -> Duration {
    let begun = BEGUN.get().unwrap_or_else(Instant::now);
    BEGUN.set(Some(begun));
    begun.elapsed()
}

/// Returns the same time as [`time_with_sleep`]: a page has no other process to share it with.
pub fn shared_time() -> Duration {
    time_with_sleep()
}
