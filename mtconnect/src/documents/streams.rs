//! The document with observations.

use super::{DocumentContext, add_sizes};
use crate::agent_identity::{AgentIdentity, SchemaVersion};
use crate::buffer::{
    BUFFER_SIZE, ConditionState, Observation, ObservationBuffer, ObservationContent,
};
use crate::model::{COMPONENTS, Component, DATA_ITEMS, ItemCategory, device_of};
use crate::reading::FaultLevel;
use crate::value::AgentValue;
use crate::xml::XmlWriter;

/// First schema version in which an alarm has an identifier.
const CONDITION_ID_VERSION: SchemaVersion = SchemaVersion { major: 2, minor: 3 };

/// Writes observations, in the order of components. `next_sequence` is the number from which the
/// client continues.
pub(crate) fn write_streams(
    context: DocumentContext<'_>,
    buffer: &ObservationBuffer,
    next_sequence: u64,
    observations: &[&Observation],
) -> String {
    let mut xml = context.begin("MTConnectStreams");
    add_sizes(
        &mut xml,
        &[
            ("bufferSize", &BUFFER_SIZE),
            ("nextSequence", &next_sequence),
            ("firstSequence", &buffer.first_sequence()),
            ("lastSequence", &(buffer.next_sequence() - 1)),
        ],
    );
    xml.close();
    xml.open("Streams");
    let mut by_component: Vec<Vec<&Observation>> = vec![Vec::new(); COMPONENTS.len()];
    for observation in observations {
        let id = DATA_ITEMS.get(observation.item).map(|item| item.component);
        let component = COMPONENTS.iter().position(|it| Some(it.id) == id);
        if let Some(list) = component.and_then(|index| by_component.get_mut(index)) {
            list.push(observation);
        }
    }
    for device in COMPONENTS.iter().filter(|it| it.parent.is_none()) {
        let (name, uuid) = context.identity.name_and_uuid(device);
        xml.open("DeviceStream")
            .attribute("name", name)
            .attribute("uuid", uuid);
        for (component, observations) in COMPONENTS.iter().zip(&by_component) {
            if device_of(component).id == device.id && !observations.is_empty() {
                write_component_stream(&mut xml, component, context.identity, observations);
            }
        }
        xml.close();
    }
    xml.finish()
}

fn write_component_stream(
    xml: &mut XmlWriter,
    component: &Component,
    identity: &AgentIdentity,
    observations: &[&Observation],
) {
    let own_name = match component.parent {
        None => Some(identity.name_and_uuid(component).0),
        Some(_) => component.name,
    };
    xml.open("ComponentStream")
        .attribute("component", component.element)
        .attribute_if("name", own_name)
        .attribute("componentId", component.id);
    for (element, category) in [
        ("Samples", ItemCategory::Sample),
        ("Events", ItemCategory::Event),
        ("Condition", ItemCategory::Condition),
    ] {
        let of_category = |it: &&&Observation| DATA_ITEMS[it.item].category == category;
        let mut listed = observations.iter().filter(of_category).peekable();
        if listed.peek().is_some() {
            xml.open(element);
            for observation in listed {
                write_observation(xml, observation, identity.schema);
            }
            xml.close();
        }
    }
    xml.close();
}

fn write_observation(xml: &mut XmlWriter, observation: &Observation, schema: SchemaVersion) {
    let item = &DATA_ITEMS[observation.item];
    let optional = |text: &'static str| (!text.is_empty()).then_some(text);
    let element = match &observation.content {
        ObservationContent::Value(_) => item.element,
        ObservationContent::Condition(state) => match state {
            ConditionState::Unavailable => "Unavailable",
            ConditionState::Normal(_) => "Normal",
            ConditionState::Active { level, .. } => match level {
                FaultLevel::Warning => "Warning",
                FaultLevel::Fault => "Fault",
            },
        },
    };
    xml.open(element)
        .attribute("dataItemId", item.id)
        .attribute("name", item.id)
        .attribute("sequence", observation.sequence)
        .attribute("timestamp", observation.time);
    match &observation.content {
        ObservationContent::Value(value) => {
            xml.attribute_if("subType", optional(item.sub_type));
            match value {
                AgentValue::Asset(asset_type, _) => {
                    xml.attribute("assetType", asset_type);
                }
                AgentValue::Unavailable if item.item_type.starts_with("ASSET_") => {
                    xml.attribute("assetType", "File");
                }
                _ => {}
            }
            xml.text(value);
        }
        ObservationContent::Condition(state) => {
            xml.attribute("type", item.item_type);
            match state {
                ConditionState::Active { number, text, .. } => {
                    let has_id = schema >= CONDITION_ID_VERSION;
                    xml.attribute("nativeCode", number)
                        .attribute_if("conditionId", has_id.then_some(number))
                        .text(text);
                }
                ConditionState::Normal(number) => {
                    xml.attribute_if("nativeCode", *number);
                }
                ConditionState::Unavailable => {}
            }
        }
    }
    xml.close();
}
