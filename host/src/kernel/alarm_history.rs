//! Collects the alarms raised since the control was opened, for the window.

use std::sync::Arc;

use gsk_core::cnc::Cnc;
use gsk_panel::alarm_log::{AlarmLog, AlarmRecord};

/// The alarms raised since the control was opened, and the copy of them for the window.
#[derive(Debug, Default)]
pub(super) struct AlarmHistory {
    record: AlarmLog,
    published: Arc<Vec<AlarmRecord>>,
}

impl AlarmHistory {
    /// Adds the alarms that were raised or cleared in this tick.
    pub(super) fn update(&mut self, cnc: &Cnc) {
        if self.record.update(cnc) {
            self.published = Arc::new(self.record.newest_first().cloned().collect());
        }
    }

    /// Returns the alarms raised since the control was opened, the newest first.
    pub(super) fn records(&self) -> Arc<Vec<AlarmRecord>> {
        Arc::clone(&self.published)
    }
}
