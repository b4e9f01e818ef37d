//! When a look through a program is given up: by the work it takes, and by the time of this
//! computer where the user asks for that.

use gsk_core::preview::{Progress, WorkBudget};
use web_time::{Duration, Instant};

use crate::platform;

/// Limits of a look, from its beginning on.
#[derive(Clone, Copy, Debug)]
pub struct WorkLimit {
    budget: WorkBudget,
    /// When it ends whatever it has found.
    deadline: Option<Instant>,
}

impl WorkLimit {
    /// Limits the work alone: the same program gets the same verdict on every computer.
    pub fn new(budget: WorkBudget) -> Self {
        Self {
            budget: budget.min(platform::LARGEST_LOOK),
            deadline: None,
        }
    }

    /// Limits the time, too, counted from now.
    #[must_use]
    pub fn within(self, time: Option<Duration>) -> Self {
        Self {
            deadline: time.and_then(|time| Instant::now().checked_add(time)),
            ..self
        }
    }

    /// Whether a look that has come so far may go on.
    pub fn allows(&self, progress: &Progress) -> bool {
        let in_time = |deadline| Instant::now() < deadline;
        self.budget.allows(progress) && self.deadline.is_none_or(in_time)
    }
}
