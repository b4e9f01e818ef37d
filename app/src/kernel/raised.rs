//! The alarms that were raised, for the window.

use std::sync::Arc;

use gsk_core::cnc::Cnc;
use gsk_panel::occurrences::{Occurrence, Occurrences};

/// The record, and what was handed out of it.
#[derive(Debug, Default)]
pub(super) struct Raised {
    record: Occurrences,
    shown: Arc<Vec<Occurrence>>,
}

impl Raised {
    /// Looks at the control, once a tick.
    pub(super) fn look(&mut self, cnc: &Cnc) {
        if self.record.look(cnc) {
            self.shown = Arc::new(self.record.newest_first().cloned().collect());
        }
    }

    /// For the window, the newest first.
    pub(super) fn shown(&self) -> Arc<Vec<Occurrence>> {
        Arc::clone(&self.shown)
    }
}
