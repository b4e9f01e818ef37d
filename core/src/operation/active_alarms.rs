//! The alarms that stand, newest first.

use gsk_messages::Message;
use serde::{Deserialize, Serialize};

use crate::alarm::{Alarm, groups};

/// Alarms that stand until RESET or until their cause is gone.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ActiveAlarms {
    list: Vec<Alarm>,
}

impl ActiveAlarms {
    /// Newest first.
    pub fn list(&self) -> &[Alarm] {
        &self.list
    }

    /// Whether none stands.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Adds an alarm; one that already stands with the same number stays as it
    /// is. Returns whether it is new.
    pub fn raise(&mut self, alarm: Alarm) -> bool {
        if self.contains(alarm.number) {
            return false;
        }
        self.list.insert(0, alarm);
        true
    }

    /// More is known of an alarm that stands.
    pub(crate) fn restate(&mut self, number: u16, detail: Message) {
        if let Some(alarm) = self.list.iter_mut().find(|alarm| alarm.number == number) {
            alarm.detail = Some(detail);
        }
    }

    /// Whether an alarm of this number stands.
    pub fn contains(&self, number: u16) -> bool {
        self.list.iter().any(|alarm| alarm.number == number)
    }

    /// Takes one away whose cause is gone.
    pub fn remove(&mut self, number: u16) {
        self.list.retain(|alarm| alarm.number != number);
    }

    /// RESET: everything goes that RESET can clear, but for what still `stands`; the
    /// emergency stop goes with its contact alone, 100 with the parameter switch and
    /// 000 with the power.
    pub fn reset(&mut self, stands: impl Fn(u16) -> bool) {
        self.list
            .retain(|alarm| groups::outlives_reset(alarm.number) || stands(alarm.number));
    }
}
