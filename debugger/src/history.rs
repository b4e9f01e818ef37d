//! Earlier moments of a run, to go back to.

use crate::debugged_run::DebuggedRun;

/// Stores moments of a run and returns them. The run is deterministic: the ticks after a
/// stored moment lead to the same states again.
pub trait StateHistory {
    /// Called with each state in the order of its ticks; stores those that the history needs.
    fn record(&mut self, run: &DebuggedRun);

    /// The last stored moment at or before a tick; `None` before the first one.
    fn state_before(&self, tick: u64) -> Option<DebuggedRun>;
}

/// Ticks between two moments at the beginning.
const FIRST_INTERVAL: u64 = 256;
/// Number of stored moments; at about 30 KB each they need 60 MB.
const MAX_MOMENTS: usize = 2048;

/// Stores a clone of the run at equal intervals. When there are too many, it drops every
/// second one and doubles the interval.
#[derive(Clone, Debug)]
pub struct SnapshotHistory {
    interval: u64,
    moments: Vec<DebuggedRun>,
}

impl Default for SnapshotHistory {
    fn default() -> Self {
        Self {
            interval: FIRST_INTERVAL,
            moments: Vec::new(),
        }
    }
}

impl StateHistory for SnapshotHistory {
    fn record(&mut self, run: &DebuggedRun) {
        let next = self.moments.last().map(|last| last.ticks() + self.interval);
        if next.is_some_and(|next| run.ticks() < next) {
            return;
        }
        self.moments.push(run.clone());
        if self.moments.len() >= MAX_MOMENTS {
            let mut index = 0;
            self.moments.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.interval *= 2;
        }
    }

    fn state_before(&self, tick: u64) -> Option<DebuggedRun> {
        let after = self
            .moments
            .partition_point(|moment| moment.ticks() <= tick);
        self.moments.get(after.checked_sub(1)?).cloned()
    }
}
