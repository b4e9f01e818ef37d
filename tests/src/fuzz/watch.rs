//! What a driver sees of a run: the longest unit of work, and what was new.

use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::time::{Duration, Instant};

/// The longest that a block, a tick or a slot may take.
pub const LIMIT: Duration = Duration::from_millis(50);

thread_local! {
    static LONGEST: Cell<Duration> = const { Cell::new(Duration::ZERO) };
    static SEEN: RefCell<BTreeSet<u64>> = const { RefCell::new(BTreeSet::new()) };
}

/// What one run was like.
#[derive(Debug, Default)]
pub struct Report {
    /// The longest unit of work.
    pub longest: Duration,
    /// Marks of what happened.
    pub seen: BTreeSet<u64>,
}

/// Does one unit of work and notes how long it took.
pub fn unit<T>(work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    took(start.elapsed());
    result
}

/// Notes how long a unit of work took.
pub fn took(time: Duration) {
    LONGEST.with(|longest| longest.set(longest.get().max(time)));
}

/// Notes that something happened; a kind of thing and which one.
pub fn seen(kind: &str, which: impl Hash) {
    let mut hasher = DefaultHasher::new();
    (kind, which).hash(&mut hasher);
    SEEN.with(|seen| seen.borrow_mut().insert(hasher.finish()));
}

/// A message without what it quotes and without numbers: the rule it tells of.
pub fn rule(message: &str) -> String {
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

/// How often something happened, roughly: its power of two.
pub const fn roughly(count: u64) -> u32 {
    u64::BITS - count.leading_zeros()
}

/// What was noted since the last call.
pub fn take() -> Report {
    Report {
        longest: LONGEST.with(|longest| longest.replace(Duration::ZERO)),
        seen: SEEN.with(RefCell::take),
    }
}
