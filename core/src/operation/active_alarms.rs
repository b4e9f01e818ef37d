//! The alarms in force, newest first.

use gsk_messages::Message;
use serde::{Deserialize, Serialize};

use crate::alarm::{Alarm, groups};

/// Alarms in force until RESET or until their cause is gone.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ActiveAlarms {
    list: Vec<Alarm>,
}

impl ActiveAlarms {
    /// Returns all active alarms, the newest first.
    pub fn list(&self) -> &[Alarm] {
        &self.list
    }

    /// Whether no alarm is active.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Adds an alarm, unless an alarm of its number is in force. Returns whether the alarm
    /// was added.
    pub fn raise(&mut self, alarm: Alarm) -> bool {
        if self.contains(alarm.number) {
            return false;
        }
        self.list.insert(0, alarm);
        true
    }

    /// Replaces the detail of the alarm with this number, if that alarm is in force.
    pub(crate) fn set_detail(&mut self, number: u16, detail: Message) {
        if let Some(alarm) = self.list.iter_mut().find(|alarm| alarm.number == number) {
            alarm.detail = Some(detail);
        }
    }

    /// Whether an alarm of this number is in force.
    pub fn contains(&self, number: u16) -> bool {
        self.list.iter().any(|alarm| alarm.number == number)
    }

    /// Removes the alarm with this number; call it when its cause is gone.
    pub fn remove(&mut self, number: u16) {
        self.list.retain(|alarm| alarm.number != number);
    }

    /// Removes the alarms that RESET can clear, except those for whose number `is_in_force`
    /// returns true. RESET never clears 207 (emergency stop), 100 (parameter switch) and
    /// 000 (power).
    pub fn reset(&mut self, is_in_force: impl Fn(u16) -> bool) {
        self.list
            .retain(|alarm| groups::survives_reset(alarm.number) || is_in_force(alarm.number));
    }
}
