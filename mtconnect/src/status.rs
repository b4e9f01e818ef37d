//! The state of the machine for the page that a browser shows, as JSON.

use core::fmt::Write;

use gsk_messages::Language;

use crate::reading::MachineReading;
use crate::time_stamp::TimeStamp;
use crate::value::AgentValue;

/// Identifiers of the data items that the page in the browser shows.
const SHOWN_ITEMS: [&str; 21] = [
    "mode",
    "execution",
    "program",
    "line",
    "sequence",
    "block",
    "x_work",
    "z_work",
    "x_machine",
    "z_machine",
    "feed",
    "feed_override",
    "rapid_override",
    "speed",
    "speed_override",
    "spindle_load",
    "x_load",
    "z_load",
    "tool",
    "parts",
    "process_time",
];

/// Writes the state of the lathe as JSON. `program_s` is the machine time of the whole program, s;
/// `None` if it is unknown.
pub(crate) fn write_status(
    lathe: &str,
    reading: &MachineReading,
    program_s: Option<f64>,
    language: Language,
    now: TimeStamp,
) -> String {
    let mut json = String::from("{");
    write_member(&mut json, "time", &now.to_string());
    json.push(',');
    write_member(&mut json, "lathe", lathe);
    for id in SHOWN_ITEMS {
        json.push(',');
        write_string(&mut json, id);
        json.push(':');
        match reading.value(id) {
            AgentValue::Unavailable => json.push_str("null"),
            AgentValue::Number(number) => {
                let _ = write!(json, "{number}");
            }
            value => write_string(&mut json, &value.to_string()),
        }
    }
    json.push_str(",\"left_s\":");
    match time_left_s(reading, program_s) {
        Some(seconds) => {
            let _ = write!(json, "{seconds:.0}");
        }
        None => json.push_str("null"),
    }
    json.push_str(",\"alarms\":[");
    for (index, fault) in reading.faults.iter().enumerate() {
        if index > 0 {
            json.push(',');
        }
        write_string(
            &mut json,
            match language {
                Language::En => &fault.text,
                Language::Zh => &fault.text_zh,
            },
        );
    }
    json.push_str("]}");
    json
}

/// Returns the machine time until the end of the running program, s; `None` if no program runs or
/// its time is not known.
fn time_left_s(reading: &MachineReading, program_s: Option<f64>) -> Option<f64> {
    let is_started = matches!(
        reading.value("execution"),
        AgentValue::Word("ACTIVE" | "FEED_HOLD" | "INTERRUPTED")
    );
    let AgentValue::Number(spent_s) = reading.value("process_time") else {
        return None;
    };
    let left_s = program_s.filter(|_| is_started)? - spent_s;
    Some(left_s.max(0.0))
}

fn write_member(json: &mut String, name: &str, value: &str) {
    write_string(json, name);
    json.push(':');
    write_string(json, value);
}

fn write_string(json: &mut String, text: &str) {
    json.push('"');
    for character in text.chars() {
        match character {
            '"' | '\\' => {
                json.push('\\');
                json.push(character);
            }
            '\0'..='\u{1f}' => {
                let _ = write!(json, "\\u{:04x}", u32::from(character));
            }
            _ => json.push(character),
        }
    }
    json.push('"');
}
