//! The device model: components of a lathe, and their data items.

use crate::readers;
use crate::value::{AgentValue, MachineSource};
use ItemCategory::{Event, Sample};

/// A component of the device model, such as an axis or the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Component {
    /// Name of the component's XML element, such as `Linear`.
    pub element: &'static str,
    /// Identifier of the component, unique in the device.
    pub id: &'static str,
    /// Name of the component, such as `X`; `None` for groups.
    pub name: Option<&'static str>,
    /// Identifier of the component that contains this one; `None` for the lathe and the agent.
    pub parent: Option<&'static str>,
}

const fn component(
    element: &'static str,
    id: &'static str,
    name: Option<&'static str>,
    parent: Option<&'static str>,
) -> Component {
    Component {
        element,
        id,
        name,
        parent,
    }
}

/// The agent, and the components of every lathe, each after the one that contains it.
pub static COMPONENTS: [Component; 9] = [
    component("Agent", "agent", Some("agent"), None),
    component("Device", "lathe", None, None),
    component("Axes", "axes", Some("axes"), Some("lathe")),
    component("Linear", "x", Some("X"), Some("axes")),
    component("Linear", "z", Some("Z"), Some("axes")),
    component("Rotary", "c", Some("C"), Some("axes")),
    component("Chuck", "chuck", Some("chuck"), Some("c")),
    component("Controller", "control", Some("control"), Some("lathe")),
    component("Path", "path", Some("path"), Some("control")),
];

/// The category of a data item: sample, event or condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ItemCategory {
    /// A quantity that changes continuously.
    Sample,
    /// A state, or a number that changes at discrete moments.
    Event,
    /// A condition: alarms that are active or not.
    Condition,
}

impl ItemCategory {
    /// Returns the name of the category in a document: `SAMPLE`, `EVENT` or `CONDITION`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sample => "SAMPLE",
            Self::Event => "EVENT",
            Self::Condition => "CONDITION",
        }
    }
}

/// A function that reads the current value of a data item from control and lathe.
pub type ItemReader = fn(&MachineSource<'_>) -> AgentValue;

/// A quantity, state or condition of the lathe that the agent observes.
#[derive(Clone, Copy, Debug)]
pub struct DataItem {
    /// Identifier of the data item, unique in the device.
    pub id: &'static str,
    /// Identifier of the component to which the item belongs.
    pub component: &'static str,
    /// Whether the item is a sample, an event or a condition.
    pub category: ItemCategory,
    /// MTConnect type of the item, such as `POSITION`.
    pub item_type: &'static str,
    /// Name of the XML element of an observation, such as `Position`; empty for conditions.
    pub element: &'static str,
    /// MTConnect sub-type of the item, such as `ACTUAL`; empty without one.
    pub sub_type: &'static str,
    /// MTConnect unit of the value, such as `MILLIMETER`; empty without one.
    pub units: &'static str,
    /// MTConnect coordinate system of a position, such as `MACHINE`; empty without one.
    pub coordinates: &'static str,
    /// Function that reads the value; the value of a condition is always unavailable.
    pub read: ItemReader,
}

const fn item(
    component: &'static str,
    id: &'static str,
    category: ItemCategory,
    names: [&'static str; 3],
    units: [&'static str; 2],
    read: ItemReader,
) -> DataItem {
    DataItem {
        id,
        component,
        category,
        item_type: names[0],
        element: names[1],
        sub_type: names[2],
        units: units[0],
        coordinates: units[1],
        read,
    }
}

const fn condition(component: &'static str, id: &'static str, item_type: &'static str) -> DataItem {
    item(
        component,
        id,
        ItemCategory::Condition,
        [item_type, "", ""],
        ["", ""],
        readers::unavailable,
    )
}

/// Creates the data item for the actual position of an axis, mm.
const fn position(
    component: &'static str,
    id: &'static str,
    coordinates: &'static str,
    read: ItemReader,
) -> DataItem {
    let names = ["POSITION", "Position", "ACTUAL"];
    item(
        component,
        id,
        Sample,
        names,
        ["MILLIMETER", coordinates],
        read,
    )
}

const fn event(
    component: &'static str,
    id: &'static str,
    names: [&'static str; 3],
    read: ItemReader,
) -> DataItem {
    item(component, id, Event, names, ["", ""], read)
}

const fn sample(
    component: &'static str,
    id: &'static str,
    names: [&'static str; 3],
    units: &'static str,
    read: ItemReader,
) -> DataItem {
    item(component, id, Sample, names, [units, ""], read)
}

/// Creates the data item for an override, %.
const fn percentage(
    component: &'static str,
    id: &'static str,
    names: [&'static str; 3],
    read: ItemReader,
) -> DataItem {
    item(component, id, Event, names, ["PERCENT", ""], read)
}

/// Creates the data item for the position of the tool in X and Z, mm.
const fn path_position(id: &'static str, coordinates: &'static str, read: ItemReader) -> DataItem {
    let names = ["PATH_POSITION", "PathPosition", "ACTUAL"];
    item(
        "path",
        id,
        Sample,
        names,
        ["MILLIMETER_3D", coordinates],
        read,
    )
}

const LOAD: [&str; 3] = ["LOAD", "Load", "ACTUAL"];
const MODE_OVERRIDE: &str = "CONTROLLER_MODE_OVERRIDE";
const MODE_OVERRIDE_ELEMENT: &str = "ControllerModeOverride";

/// The data items of every lathe; those of one component are neighbours. Observations name an
/// item by its index.
pub static DATA_ITEMS: [DataItem; 50] = [
    event(
        "agent",
        "agent_avail",
        ["AVAILABILITY", "Availability", ""],
        readers::availability,
    ),
    event(
        "lathe",
        "avail",
        ["AVAILABILITY", "Availability", ""],
        readers::availability,
    ),
    event(
        "lathe",
        ASSET_CHANGED_ID,
        ["ASSET_CHANGED", "AssetChanged", ""],
        readers::unavailable,
    ),
    event(
        "lathe",
        ASSET_REMOVED_ID,
        ["ASSET_REMOVED", "AssetRemoved", ""],
        readers::unavailable,
    ),
    position("x", "x_machine", "MACHINE", readers::x_machine),
    position("x", "x_work", "WORK", readers::x_work),
    sample("x", "x_load", LOAD, "PERCENT", readers::x_load),
    condition("x", "x_travel", "POSITION"),
    condition("x", "x_drive", "ACTUATOR"),
    position("z", "z_machine", "MACHINE", readers::z_machine),
    position("z", "z_work", "WORK", readers::z_work),
    sample("z", "z_load", LOAD, "PERCENT", readers::z_load),
    condition("z", "z_travel", "POSITION"),
    condition("z", "z_drive", "ACTUATOR"),
    sample(
        "c",
        "speed",
        ["ROTARY_VELOCITY", "RotaryVelocity", "ACTUAL"],
        "REVOLUTION/MINUTE",
        readers::speed_actual,
    ),
    sample(
        "c",
        "speed_commanded",
        ["ROTARY_VELOCITY", "RotaryVelocity", "COMMANDED"],
        "REVOLUTION/MINUTE",
        readers::speed_commanded,
    ),
    percentage(
        "c",
        "speed_override",
        ["ROTARY_VELOCITY_OVERRIDE", "RotaryVelocityOverride", ""],
        readers::spindle_override,
    ),
    event(
        "c",
        "spindle_direction",
        ["DIRECTION", "Direction", "ROTARY"],
        readers::spindle_direction,
    ),
    event(
        "c",
        "spindle_mode",
        ["ROTARY_MODE", "RotaryMode", ""],
        readers::rotary_mode,
    ),
    sample("c", "spindle_load", LOAD, "PERCENT", readers::spindle_load),
    event(
        "chuck",
        "chuck_state",
        ["CHUCK_STATE", "ChuckState", ""],
        readers::chuck_state,
    ),
    event(
        "control",
        "estop",
        ["EMERGENCY_STOP", "EmergencyStop", ""],
        readers::emergency_stop,
    ),
    event(
        "control",
        "message",
        ["MESSAGE", "Message", ""],
        readers::message,
    ),
    sample(
        "control",
        "time_on",
        ["EQUIPMENT_TIMER", "EquipmentTimer", "POWERED"],
        "SECOND",
        readers::time_powered,
    ),
    sample(
        "control",
        "time_started",
        ["EQUIPMENT_TIMER", "EquipmentTimer", "OPERATING"],
        "SECOND",
        readers::time_operating,
    ),
    sample(
        "control",
        "time_cutting",
        ["EQUIPMENT_TIMER", "EquipmentTimer", "WORKING"],
        "SECOND",
        readers::time_working,
    ),
    condition("control", "system", "SYSTEM"),
    condition("control", "logic", "LOGIC_PROGRAM"),
    condition("control", "link", "COMMUNICATIONS"),
    path_position("path_machine", "MACHINE", readers::path_machine),
    path_position("path_work", "WORK", readers::path_work),
    sample(
        "path",
        "feed",
        ["PATH_FEEDRATE", "PathFeedrate", "ACTUAL"],
        "MILLIMETER/SECOND",
        readers::feed_actual,
    ),
    sample(
        "path",
        "feed_programmed",
        ["PATH_FEEDRATE", "PathFeedrate", "PROGRAMMED"],
        "MILLIMETER/SECOND",
        readers::feed_programmed,
    ),
    percentage(
        "path",
        "feed_override",
        [
            "PATH_FEEDRATE_OVERRIDE",
            "PathFeedrateOverride",
            "PROGRAMMED",
        ],
        readers::feed_override,
    ),
    percentage(
        "path",
        "rapid_override",
        ["PATH_FEEDRATE_OVERRIDE", "PathFeedrateOverride", "RAPID"],
        readers::rapid_override,
    ),
    event(
        "path",
        "mode",
        ["CONTROLLER_MODE", "ControllerMode", ""],
        readers::controller_mode,
    ),
    event(
        "path",
        "execution",
        ["EXECUTION", "Execution", ""],
        readers::execution,
    ),
    event(
        "path",
        "program",
        ["PROGRAM", "Program", ""],
        readers::program,
    ),
    event("path", "block", ["BLOCK", "Block", ""], readers::block),
    event(
        "path",
        "line",
        ["LINE_NUMBER", "LineNumber", "ABSOLUTE"],
        readers::line_number,
    ),
    event(
        "path",
        "sequence",
        ["LINE_LABEL", "LineLabel", ""],
        readers::line_label,
    ),
    event(
        "path",
        "tool",
        ["TOOL_NUMBER", "ToolNumber", ""],
        readers::tool_number,
    ),
    event(
        "path",
        "tool_asset",
        ["TOOL_ASSET_ID", "ToolAssetId", ""],
        readers::tool_asset,
    ),
    event(
        "path",
        "parts",
        ["PART_COUNT", "PartCount", "ALL"],
        readers::part_count,
    ),
    event(
        "path",
        "parts_required",
        ["PART_COUNT", "PartCount", "TARGET"],
        readers::parts_required,
    ),
    event(
        "path",
        "single_block",
        [MODE_OVERRIDE, MODE_OVERRIDE_ELEMENT, "SINGLE_BLOCK"],
        readers::single_block,
    ),
    event(
        "path",
        "dry_run",
        [MODE_OVERRIDE, MODE_OVERRIDE_ELEMENT, "DRY_RUN"],
        readers::dry_run,
    ),
    event(
        "path",
        "machine_lock",
        [MODE_OVERRIDE, MODE_OVERRIDE_ELEMENT, "MACHINE_AXIS_LOCK"],
        readers::machine_lock,
    ),
    condition("path", "motion", "MOTION_PROGRAM"),
    sample(
        "path",
        "process_time",
        ["PROCESS_TIMER", "ProcessTimer", "PROCESS"],
        "SECOND",
        readers::process_time,
    ),
];

/// Identifier of the item that names an asset that is new or has changed.
pub(crate) const ASSET_CHANGED_ID: &str = "asset_changed";
/// Identifier of the item that names an asset that was removed.
pub(crate) const ASSET_REMOVED_ID: &str = "asset_removed";

/// Returns the index of a data item in [`DATA_ITEMS`]; `None` for an unknown identifier.
pub fn item_index(id: &str) -> Option<usize> {
    DATA_ITEMS.iter().position(|item| item.id == id)
}

/// Returns the device that contains a component: the lathe or the agent.
pub(crate) fn device_of(component: &'static Component) -> &'static Component {
    let mut device = component;
    while let Some(parent) = device.parent.and_then(component_index) {
        device = &COMPONENTS[parent];
    }
    device
}

/// Returns the index of a component in [`COMPONENTS`]; `None` for an unknown identifier.
pub fn component_index(id: &str) -> Option<usize> {
    COMPONENTS.iter().position(|component| component.id == id)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn identifiers_are_unique_and_items_of_a_component_are_neighbours() {
        let components = COMPONENTS.iter().map(|component| component.id);
        let items = DATA_ITEMS.iter().map(|item| item.id);
        let all: BTreeSet<&str> = components.chain(items).collect();
        assert_eq!(all.len(), COMPONENTS.len() + DATA_ITEMS.len());
        let mut runs: Vec<&str> = DATA_ITEMS.iter().map(|item| item.component).collect();
        runs.dedup();
        let order: Vec<&str> = COMPONENTS
            .iter()
            .map(|component| component.id)
            .filter(|id| *id != "axes")
            .collect();
        assert_eq!(runs, order);
        for (index, component) in COMPONENTS.iter().enumerate() {
            let parent = component.parent.map(|id| component_index(id).expect(id));
            assert!(parent.is_none_or(|parent| parent < index), "{component:?}");
        }
    }
}
