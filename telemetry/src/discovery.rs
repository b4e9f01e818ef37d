//! Describes the documents to Home Assistant, which then shows the lathe without settings.

use gsk_messages::{Message, say};
use serde_json::{Map, Value, json};

use crate::lathe_identity::LatheIdentity;
use crate::message::TelemetryMessage;

/// Start of the topics in which Home Assistant looks for devices, unless it was configured
/// otherwise.
pub const DEFAULT_DISCOVERY_PREFIX: &str = "homeassistant";

/// Where the description is published.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DiscoveryOptions {
    /// Start of the topics: `homeassistant`.
    pub prefix: String,
}

/// A value that Home Assistant shows.
struct DiscoveredEntity {
    /// Last level of the topic of its document.
    document: &'static str,
    /// Member of the document.
    member: &'static str,
    name: Message,
    /// Unit; empty without one.
    unit: &'static str,
    /// Class of Home Assistant, which selects icon and conversion; empty without one.
    class: &'static str,
}

fn sensors() -> Vec<DiscoveredEntity> {
    let entity = |document, member, name, unit, class| DiscoveredEntity {
        document,
        member,
        name,
        unit,
        class,
    };
    vec![
        entity("path", "execution", say::mqtt_execution(), "", ""),
        entity("path", "mode", say::mqtt_mode(), "", ""),
        entity("path", "program", say::page_program(), "", ""),
        entity("path", "block", say::page_block(), "", ""),
        entity("path", "parts", say::page_parts(), "", ""),
        entity("path", "tool", say::page_tool(), "", ""),
        entity("path", "feed", say::page_feed(), "mm/s", "speed"),
        entity(
            "path",
            "process_time",
            say::page_time_spent(),
            "s",
            "duration",
        ),
        entity("c", "speed", say::page_speed(), "rpm", ""),
        entity("c", "spindle_load", say::mqtt_spindle_load(), "%", ""),
        entity("x", "x_work", say::mqtt_position("X"), "mm", "distance"),
        entity("z", "z_work", say::mqtt_position("Z"), "mm", "distance"),
        entity(
            "control",
            "time_cutting",
            say::mqtt_cutting_time(),
            "s",
            "duration",
        ),
    ]
}

/// The discovery topics of a lathe.
pub(crate) fn entities(
    identity: &LatheIdentity,
    options: &DiscoveryOptions,
) -> Vec<TelemetryMessage> {
    let node = node_id(&identity.prefix);
    let sensors = sensors().into_iter().map(|it| {
        let mut config = base_config(identity, &node, it.document, it.member, &it.name);
        config.insert(
            "value_template".to_owned(),
            format!("{{{{ value_json.{} }}}}", it.member).into(),
        );
        for (member, value) in [("unit_of_measurement", it.unit), ("device_class", it.class)] {
            if !value.is_empty() {
                config.insert(member.to_owned(), value.into());
            }
        }
        (
            format!("{}/sensor/{node}/{}/config", options.prefix, it.member),
            config,
        )
    });
    let alarm = {
        let name = say::mqtt_alarm();
        let mut config = base_config(identity, &node, "alarms", "alarm", &name);
        let template = "{{ 'ON' if value_json.count > 0 else 'OFF' }}";
        config.insert("value_template".to_owned(), template.into());
        config.insert("device_class".to_owned(), "problem".into());
        config.insert(
            "json_attributes_topic".to_owned(),
            identity.topic("alarms").into(),
        );
        (
            format!("{}/binary_sensor/{node}/alarm/config", options.prefix),
            config,
        )
    };
    let emergency = {
        let name = say::mqtt_emergency_stop();
        let mut config = base_config(identity, &node, "control", "estop", &name);
        let template = "{{ 'OFF' if value_json.estop == 'ARMED' else 'ON' }}";
        config.insert("value_template".to_owned(), template.into());
        config.insert("device_class".to_owned(), "safety".into());
        (
            format!("{}/binary_sensor/{node}/estop/config", options.prefix),
            config,
        )
    };
    let all = sensors.chain([alarm, emergency]);
    all.map(|(topic, config)| TelemetryMessage::retained(topic, Value::Object(config).to_string()))
        .collect()
}

/// The members that all entities have.
fn base_config(
    identity: &LatheIdentity,
    node: &str,
    document: &str,
    member: &str,
    name: &Message,
) -> Map<String, Value> {
    let description = &identity.description;
    let device = json!({
        "identifiers": [node],
        "name": description.lathe_name,
        "manufacturer": "GSK",
        "model": description.control_model,
        "sw_version": identity.version,
    });
    let id = format!("{node}_{member}");
    let members = [
        ("name", Value::from(name.text(identity.language))),
        ("unique_id", id.into()),
        ("state_topic", identity.topic(document).into()),
        ("availability_topic", identity.online_topic().into()),
        ("device", device),
    ];
    let members = members.map(|(name, value)| (name.to_owned(), value));
    members.into_iter().collect()
}

/// An identifier from the prefix: letters, digits and underscores.
fn node_id(prefix: &str) -> String {
    let word = |character: char| match character {
        'a'..='z' | 'A'..='Z' | '0'..='9' => character.to_string(),
        '/' | '-' | '_' | '.' | ' ' => "_".to_owned(),
        // Prefixes that differ only in other letters remain different.
        _ => format!("u{:x}", u32::from(character)),
    };
    prefix.chars().map(word).collect()
}
