//! Limits a preview: by its amount of work, and by the time of this computer on request.

use gsk_core::preview::{PreviewProgress, WorkBudget};
use web_time::{Duration, Instant};

use crate::platform;

/// Limits of a preview, from its beginning on.
#[derive(Clone, Copy, Debug)]
pub struct WorkLimit {
    budget: WorkBudget,
    /// When the preview ends in any case.
    deadline: Option<Instant>,
}

impl WorkLimit {
    /// Limits the work alone: the same program gets the same result on every computer.
    pub fn new(budget: WorkBudget) -> Self {
        Self {
            budget: budget.min(platform::LARGEST_PREVIEW),
            deadline: None,
        }
    }

    /// Limits the time, too, counted from now.
    #[must_use]
    pub fn with_deadline(self, time: Option<Duration>) -> Self {
        Self {
            deadline: time.and_then(|time| Instant::now().checked_add(time)),
            ..self
        }
    }

    /// Whether a preview with this progress may continue.
    pub fn allows(&self, progress: &PreviewProgress) -> bool {
        let in_time = |deadline| Instant::now() < deadline;
        self.budget.allows(progress) && self.deadline.is_none_or(in_time)
    }
}
