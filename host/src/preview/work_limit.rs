//! Limits a preview: by its amount of work, and by the time of this computer on request.

use gsk_core::preview::{PreviewProgress, WorkBudget};
use web_time::{Duration, Instant};

use crate::platform;

/// Limits of the work and the time of a preview.
#[derive(Clone, Copy, Debug)]
pub struct WorkLimit {
    budget: WorkBudget,
    /// Time at which the preview is cancelled; `None`: no time limit.
    deadline: Option<Instant>,
}

impl WorkLimit {
    /// Limits the work only, so that the same program gets the same result on every computer.
    pub fn new(budget: WorkBudget) -> Self {
        Self {
            budget: budget.min(platform::LARGEST_PREVIEW),
            deadline: None,
        }
    }

    /// Also limits the time, counted from this call; `None` sets no limit.
    #[must_use]
    pub fn with_deadline(self, time: Option<Duration>) -> Self {
        Self {
            deadline: time.and_then(|time| Instant::now().checked_add(time)),
            ..self
        }
    }

    /// Whether a preview that has made this progress may continue.
    pub fn allows(&self, progress: &PreviewProgress) -> bool {
        let in_time = |deadline| Instant::now() < deadline;
        self.budget.allows(progress) && self.deadline.is_none_or(in_time)
    }
}
