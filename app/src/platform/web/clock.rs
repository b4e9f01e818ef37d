//! The clock of a page.

use std::cell::Cell;

use web_time::{Duration, Instant};

thread_local! {
    static BEGUN: Cell<Option<Instant>> = const { Cell::new(None) };
}

/// Time since the first call; whether it counts the sleep of the computer is the browser's
/// affair.
pub fn time_with_sleep() -> Duration {
    let begun = BEGUN.get().unwrap_or_else(Instant::now);
    BEGUN.set(Some(begun));
    begun.elapsed()
}

/// A page has no other process to share a time with.
pub fn shared_time() -> Duration {
    time_with_sleep()
}
