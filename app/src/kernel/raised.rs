//! The alarms that were raised, for the window.

use std::sync::Arc;

use gsk_core::cnc::Cnc;
use gsk_panel::alarm_log::{AlarmLog, AlarmRecord};

/// The record, and what was handed out of it.
#[derive(Debug, Default)]
pub(super) struct Raised {
    record: AlarmLog,
    shown: Arc<Vec<AlarmRecord>>,
}

impl Raised {
    /// Looks at the control, once a tick.
    pub(super) fn look(&mut self, cnc: &Cnc) {
        if self.record.update(cnc) {
            self.shown = Arc::new(self.record.newest_first().cloned().collect());
        }
    }

    /// For the window, the newest first.
    pub(super) fn shown(&self) -> Arc<Vec<AlarmRecord>> {
        Arc::clone(&self.shown)
    }
}
