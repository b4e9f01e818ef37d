//! Collects the alarms raised since the control was opened, for the window.

use std::sync::Arc;

use gsk_core::cnc::Cnc;
use gsk_panel::alarm_log::{AlarmLog, AlarmRecord, MAX_RECORDS};
use gsk_panel::emulator::Emulator;

/// The alarms raised since the control was opened, and the copy of them for the window.
#[derive(Clone, Debug, Default)]
pub(super) struct AlarmHistory {
    record: AlarmLog,
    /// Ticks of the machine at which the records were made, the oldest first.
    raised_ticks: Vec<u64>,
    published: Arc<Vec<AlarmRecord>>,
}

impl AlarmHistory {
    /// Adds the alarms that were raised in this tick; returns `true` if there were any.
    pub(super) fn update(&mut self, machine: &Emulator) -> bool {
        let count = self.record.update(machine.cnc());
        if count > 0 {
            let ticks = core::iter::repeat_n(machine.ticks(), count);
            self.raised_ticks.extend(ticks);
            let excess = self.raised_ticks.len().saturating_sub(MAX_RECORDS);
            self.raised_ticks.drain(..excess);
            self.publish();
        }
        count > 0
    }

    /// Removes the alarms that were raised after a tick to which the machine has returned. `cnc` is
    /// the control at that tick.
    pub(super) fn return_to(&mut self, tick: u64, cnc: &Cnc) {
        let remaining = self.raised_ticks.partition_point(|raised| *raised <= tick);
        let removed = self.raised_ticks.len() - remaining;
        self.raised_ticks.truncate(remaining);
        self.record.remove_newest(removed, cnc);
        self.publish();
    }

    fn publish(&mut self) {
        self.published = Arc::new(self.record.newest_first().cloned().collect());
    }

    /// Returns the alarms raised since the control was opened, the newest first.
    pub(super) fn records(&self) -> Arc<Vec<AlarmRecord>> {
        Arc::clone(&self.published)
    }
}
