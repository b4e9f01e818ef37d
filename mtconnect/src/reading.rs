//! The values of all data items and the active faults at one moment.

use std::sync::Arc;

use gsk_core::alarm::{Alarm, AlarmClass, number};

use crate::model::{DATA_ITEMS, item_index};
use crate::value::{AgentValue, MachineSource};

/// How serious an active condition is: a warning or a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultLevel {
    /// The machine works, but the operator must act.
    Warning,
    /// The machine has stopped.
    Fault,
}

/// An active alarm, reported as a condition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ActiveFault {
    /// Index of the condition item in [`DATA_ITEMS`](crate::model::DATA_ITEMS).
    pub item: usize,
    /// Whether the alarm is a warning or a fault.
    pub level: FaultLevel,
    /// Number of the alarm.
    pub number: u16,
    /// Text of the alarm in English.
    pub text: Arc<str>,
    /// Text of the alarm in Chinese.
    pub text_zh: Arc<str>,
}

/// The values of all data items and the active faults at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineReading {
    /// Value of each data item, by its index; conditions are unavailable here.
    pub values: Vec<AgentValue>,
    /// Active alarms and messages, the newest first.
    pub faults: Vec<ActiveFault>,
}

impl MachineReading {
    /// Reads the values of all data items from control and lathe.
    pub fn new(from: &MachineSource<'_>) -> Self {
        let alarms = from.cnc.alarms().iter().filter_map(fault_of_alarm);
        let messages = from
            .cnc
            .plc_messages()
            .filter_map(|(number, text)| fault_of_message(number, text));
        Self {
            values: DATA_ITEMS.iter().map(|item| (item.read)(from)).collect(),
            faults: alarms.chain(messages).collect(),
        }
    }

    /// Returns the reading of a machine that is switched off: all values are unavailable.
    pub fn unavailable() -> Self {
        Self {
            values: vec![AgentValue::Unavailable; DATA_ITEMS.len()],
            faults: Vec::new(),
        }
    }

    /// The value of the item with this identifier; unavailable for an unknown one.
    pub fn value(&self, id: &str) -> &AgentValue {
        let value = item_index(id).and_then(|index| self.values.get(index));
        value.unwrap_or(&AgentValue::Unavailable)
    }
}

/// Returns the identifier of the condition item to which an alarm belongs.
fn condition_id(alarm: &Alarm) -> &'static str {
    match (alarm.class(), alarm.number) {
        (AlarmClass::Ps, _) => "motion",
        (AlarmClass::Overtravel, number::X_PLUS_LIMIT | number::X_MINUS_LIMIT) => "x_travel",
        (AlarmClass::Overtravel, number::Z_PLUS_LIMIT | number::Z_MINUS_LIMIT) => "z_travel",
        (AlarmClass::Servo, number::X_DRIVE_NOT_READY | number::X_DRIVE_ALARM) => "x_drive",
        (AlarmClass::Servo, number::Z_DRIVE_NOT_READY | number::Z_DRIVE_ALARM) => "z_drive",
        (AlarmClass::Link, _) => "link",
        (AlarmClass::Plc, _) => "logic",
        _ => "system",
    }
}

fn fault_of_alarm(alarm: &Alarm) -> Option<ActiveFault> {
    let detail = |language| {
        let detail = alarm.further_detail();
        detail.map_or_else(String::new, |detail| {
            format!(" ({})", detail.text(language))
        })
    };
    let text = alarm.line_text_en() + &detail(gsk_messages::Language::En);
    let text_zh = alarm.line_text() + &detail(gsk_messages::Language::Zh);
    Some(ActiveFault {
        item: item_index(condition_id(alarm))?,
        level: FaultLevel::Fault,
        number: alarm.number,
        text: text.into(),
        text_zh: text_zh.into(),
    })
}

fn fault_of_message(number: u16, text: &str) -> Option<ActiveFault> {
    let message = Alarm::from_ladder_message(number, text);
    Some(ActiveFault {
        level: FaultLevel::Warning,
        ..fault_of_alarm(&message)?
    })
}
