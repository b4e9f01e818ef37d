//! The document with the device model.

use super::{DocumentContext, add_sizes};
use crate::assets::ASSET_BUFFER_SIZE;
use crate::buffer::BUFFER_SIZE;
use crate::device_description::DeviceDescription;
use crate::model::{COMPONENTS, Component, DATA_ITEMS, DataItem};
use crate::xml::XmlWriter;

/// Writes the probe document, with components and data items; `asset_count` is the number of stored
/// assets.
pub(crate) fn write_probe(context: DocumentContext<'_>, asset_count: usize) -> String {
    let mut xml = context.begin("MTConnectDevices");
    add_sizes(
        &mut xml,
        &[
            ("bufferSize", &BUFFER_SIZE),
            ("assetBufferSize", &ASSET_BUFFER_SIZE),
            ("assetCount", &asset_count),
        ],
    );
    xml.close();
    xml.open("Devices");
    for device in COMPONENTS.iter().filter(|it| it.parent.is_none()) {
        write_component(&mut xml, context, device);
    }
    xml.finish()
}

fn write_component(xml: &mut XmlWriter, context: DocumentContext<'_>, component: &Component) {
    let identity = context.identity;
    xml.open(component.element).attribute("id", component.id);
    if component.parent.is_none() {
        let (name, uuid) = identity.name_and_uuid(component);
        xml.attribute("uuid", uuid)
            .attribute("name", name)
            .attribute("mtconnectVersion", identity.schema);
    } else {
        xml.attribute_if("name", component.name);
    }
    if component.element == "Device" {
        write_description(xml, &identity.description);
    }
    write_configuration(xml, component, &identity.description);
    let items = DATA_ITEMS
        .iter()
        .filter(|item| item.component == component.id);
    let items: Vec<&DataItem> = items.collect();
    if !items.is_empty() {
        xml.open("DataItems");
        for item in items {
            write_item(xml, item);
        }
        xml.close();
    }
    let children = COMPONENTS
        .iter()
        .filter(|it| it.parent == Some(component.id));
    let children: Vec<&Component> = children.collect();
    if !children.is_empty() {
        xml.open("Components");
        for child in children {
            write_component(xml, context, child);
        }
        xml.close();
    }
    xml.close();
}

fn write_description(xml: &mut XmlWriter, description: &DeviceDescription) {
    xml.open("Description")
        .attribute("model", &description.control_model)
        .text(format_args!("{}. X is a diameter.", description.lathe_name))
        .close();
}

/// Writes the travel of an axis and the greatest speed of the spindle.
fn write_configuration(
    xml: &mut XmlWriter,
    component: &Component,
    description: &DeviceDescription,
) {
    let [x, z] = description.travel;
    let (item_type, units, minimum, maximum) = match component.id {
        "x" => ("POSITION", "MILLIMETER", x.0, x.1),
        "z" => ("POSITION", "MILLIMETER", z.0, z.1),
        "c" => (
            "ROTARY_VELOCITY",
            "REVOLUTION/MINUTE",
            0.0,
            description.max_speed_rpm,
        ),
        _ => return,
    };
    xml.open("Configuration").open("Specifications");
    xml.open("Specification")
        .attribute("id", format_args!("{}_limits", component.id))
        .attribute("type", item_type)
        .attribute("units", units);
    xml.element("Maximum", maximum).element("Minimum", minimum);
    xml.close().close().close();
}

fn write_item(xml: &mut XmlWriter, item: &DataItem) {
    let optional = |text: &'static str| (!text.is_empty()).then_some(text);
    xml.open("DataItem")
        .attribute("category", item.category.name())
        .attribute("id", item.id)
        .attribute("name", item.id)
        .attribute("type", item.item_type)
        .attribute_if("subType", optional(item.sub_type))
        .attribute_if("units", optional(item.units))
        .attribute_if("nativeUnits", optional(item.units))
        .attribute_if("coordinateSystem", optional(item.coordinates))
        .close();
}
