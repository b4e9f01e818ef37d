//! The state of the lathe as JSON: a document for each component, the alarms, the assets.

use gsk_messages::Language;
use gsk_mtconnect::model::{Component, DATA_ITEMS, DataItem, ItemCategory};
use gsk_mtconnect::{AgentAssets, AgentValue, FaultLevel, MachineReading, TimeStamp};
use serde_json::{Map, Value, json};

/// Greatest length of a program that is published, bytes.
const MAX_PROGRAM_BYTES: usize = 256 * 1024;

/// The items of a component that have a value, with their index in the reading.
pub(crate) fn items_of(component: &Component) -> impl Iterator<Item = (usize, &'static DataItem)> {
    let id = component.id;
    let items = DATA_ITEMS.iter().enumerate();
    items.filter(move |(_, item)| {
        // Assets have topics of their own.
        let is_asset = item.id.starts_with("asset_");
        item.component == id && item.category != ItemCategory::Condition && !is_asset
    })
}

/// The document of a component: its values, and the moment of the newest one.
pub(crate) fn component_document(
    component: &Component,
    reading: &MachineReading,
    time_ms: u64,
) -> String {
    let mut members = Map::new();
    members.insert("time".to_owned(), json_time(time_ms));
    for (index, item) in items_of(component) {
        let value = reading.values.get(index);
        let value = value.map_or(Value::Null, json_value);
        members.insert(item.id.to_owned(), value);
    }
    Value::Object(members).to_string()
}

/// The document of the active alarms and messages, the newest first.
pub(crate) fn alarm_document(reading: &MachineReading, time_ms: u64) -> String {
    let alarms: Vec<Value> = reading
        .faults
        .iter()
        .map(|fault| {
            let level = match fault.level {
                FaultLevel::Warning => "warning",
                FaultLevel::Fault => "fault",
            };
            json!({
                "condition": DATA_ITEMS.get(fault.item).map(|item| item.id),
                "level": level,
                "number": fault.number,
                "text": &*fault.text,
                "text_zh": &*fault.text_zh,
            })
        })
        .collect();
    json!({ "time": json_time(time_ms), "count": alarms.len(), "alarms": alarms }).to_string()
}

/// The document of the selected program. A long program is published without its text.
pub(crate) fn program_document(assets: &AgentAssets, time_ms: u64) -> String {
    let time = json_time(time_ms);
    match &assets.program {
        Some((name, program)) => {
            let text = program.text();
            let published = (text.len() <= MAX_PROGRAM_BYTES).then_some(text);
            json!({ "time": time, "name": name, "bytes": text.len(), "text": published })
        }
        None => json!({ "time": time, "name": null, "bytes": 0, "text": null }),
    }
    .to_string()
}

/// The document of the tools of the job, as a job file describes them.
pub(crate) fn tool_document(assets: &AgentAssets, time_ms: u64) -> String {
    let tools: Vec<Value> = assets
        .job
        .iter()
        .flat_map(|job| {
            job.tools.iter().map(|(number, tool)| {
                json!({
                    "number": number,
                    "tool": tool,
                    "length": job.lengths.get(number),
                })
            })
        })
        .collect();
    json!({ "time": json_time(time_ms), "tools": tools }).to_string()
}

fn json_time(time_ms: u64) -> Value {
    TimeStamp(time_ms).to_string().into()
}

fn json_value(value: &AgentValue) -> Value {
    match value {
        AgentValue::Unavailable => Value::Null,
        AgentValue::Number(number) => json!(number),
        AgentValue::Point(point) => json!(point),
        AgentValue::Word(word) => json!(word),
        AgentValue::Text(text) | AgentValue::Asset(_, text) => json!(&**text),
    }
}

/// The code of a language in documents.
pub(crate) const fn language_code(language: Language) -> &'static str {
    match language {
        Language::En => "en",
        Language::Zh => "zh-CN",
    }
}
