//! Records what a driver needs of a run: the longest unit of work, and new results.

use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::time::{Duration, Instant};

/// Greatest duration of a unit of work: a block, a tick or a slot.
pub const UNIT_TIME_LIMIT: Duration = Duration::from_millis(50);

thread_local! {
    static LONGEST: Cell<Duration> = const { Cell::new(Duration::ZERO) };
    static SEEN: RefCell<BTreeSet<u64>> = const { RefCell::new(BTreeSet::new()) };
}

/// What an input has reached in one run.
#[derive(Debug, Default)]
pub struct UnitRecord {
    /// Duration of the longest unit of work.
    pub longest_unit: Duration,
    /// Hashes of the events that were recorded, by which new results are recognized.
    pub events: BTreeSet<u64>,
}

/// Runs one unit of work, records its duration and returns its result.
pub fn run_unit<T>(work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    record_duration(start.elapsed());
    result
}

/// Records the duration of a unit of work that has ended.
pub fn record_duration(time: Duration) {
    LONGEST.with(|longest| longest.set(longest.get().max(time)));
}

/// Records an event by its kind and a value that identifies the event within the kind.
pub fn record_event(kind: &str, which: impl Hash) {
    let mut hasher = DefaultHasher::new();
    (kind, which).hash(&mut hasher);
    SEEN.with(|seen| seen.borrow_mut().insert(hasher.finish()));
}

/// Returns the first 20 lower-case letters of a message outside quoted text, which identify
/// its rule.
pub fn message_rule(message: &str) -> String {
    let before = message.split('"').next().unwrap_or("");
    let after = message.rsplit('"').next().unwrap_or("");
    let quotes = before.len() < message.len();
    before
        .chars()
        .chain(after.chars().take(if quotes { usize::MAX } else { 0 }))
        .filter(char::is_ascii_lowercase)
        .take(20)
        .collect()
}

/// Returns the number of binary digits of a count, as its order of magnitude.
pub const fn order_of_magnitude(count: u64) -> u32 {
    u64::BITS - count.leading_zeros()
}

/// Returns what was recorded since the last call, and starts a new record.
pub fn take_record() -> UnitRecord {
    UnitRecord {
        longest_unit: LONGEST.with(|longest| longest.replace(Duration::ZERO)),
        events: SEEN.with(RefCell::take),
    }
}
