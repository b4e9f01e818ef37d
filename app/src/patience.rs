//! How long a look through a program may take.
//!
//! A loop without end is no error of the text: nobody can tell it from a long
//! program but by its time.

use gsk_core::preview::Progress;
use web_time::{Duration, Instant};

use crate::platform;

/// When to give a look through a program up.
#[derive(Clone, Copy, Debug)]
pub struct Patience {
    begun: Instant,
    time: Duration,
    moves: u64,
}

impl Patience {
    /// Begins now; `time` of this computer and so many moves are the limits.
    pub fn new(time: Duration, moves: u64) -> Self {
        Self {
            begun: Instant::now(),
            time: time.min(platform::LONGEST_LOOK),
            moves,
        }
    }

    /// Whether to go on.
    pub fn lasts(&self, progress: &Progress) -> bool {
        progress.moves < self.moves && self.begun.elapsed() < self.time
    }
}
