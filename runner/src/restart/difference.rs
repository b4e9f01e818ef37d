//! The values that differ between the machine now and the state before a block.

use gsk_core::cnc::Cnc;
use gsk_core::memory::ToolOffset;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_messages::{Message, say};

use super::block_search::BlockState;
use super::machine_functions::Equipment;
use crate::report;

/// A value of the machine that a restart changes.
#[derive(Clone, Debug, PartialEq)]
pub struct StateDifference {
    /// The name of the value, such as the spindle speed.
    pub name: Message,
    /// The current value in the machine, as text.
    pub now: String,
    /// The value at the beginning of the block of the restart, as text.
    pub then: String,
}

impl StateDifference {
    /// Returns the name with the current and the new value as one line.
    pub fn to_message(&self) -> Message {
        say::restart_difference(self.name.clone(), &self.now, &self.then)
    }
}

/// Collects the values that a restart changes.
#[derive(Default)]
struct DifferenceList(Vec<StateDifference>);

impl DifferenceList {
    fn compare(&mut self, name: Message, now: String, then: String) {
        if now != then {
            self.0.push(StateDifference { name, now, then });
        }
    }

    fn compare_code(&mut self, name: &str, now: String, then: String) {
        self.compare(say::as_written(name), now, then);
    }
}

/// Lists the values that a restart changes in the machine `now`.
pub(super) fn find_differences(now: &Simulation, target: &BlockState) -> Vec<StateDifference> {
    let mut list = DifferenceList::default();
    let (before, after) = (&now.cnc, &target.simulation.cnc);
    compare_words(&mut list, before, after);
    compare_equipment(&mut list, now, target);
    let frames = (before.frame(), after.frame());
    list.compare(
        say::restart_name_work_zero(),
        point_text(frames.0.zero),
        point_text(frames.1.zero),
    );
    list.compare(
        say::restart_name_tool_offset(),
        point_text(frames.0.offset),
        point_text(frames.1.offset),
    );
    list.compare(
        say::restart_name_slides(),
        point_text(before.position_machine()),
        point_text(after.commanded_machine_position()),
    );
    compare_memory(&mut list, before, after);
    list.0
}

fn compare_words(list: &mut DifferenceList, before: &Cnc, after: &Cnc) {
    let (now, then) = (before.modal(), after.modal());
    let codes = |cnc: &Cnc| {
        let inch = if cnc.modal().inch { "G20" } else { "G21" };
        format!("{} {inch}", report::modal_codes(cnc.modal()).join(" "))
    };
    list.compare_code("G", codes(before), codes(after));
    list.compare_code("F", now.feed.to_string(), then.feed.to_string());
    list.compare_code(
        "T",
        report::tool_word(before.tool()),
        report::tool_word(after.tool()),
    );
    list.compare_code(
        "S",
        before.spindle().s_word().to_string(),
        after.spindle().s_word().to_string(),
    );
    let limit = |cnc: &Cnc| {
        let limit = cnc.spindle().limit();
        limit.map_or_else(|| "-".to_owned(), |limit| limit.to_string())
    };
    list.compare(say::restart_name_speed_limit(), limit(before), limit(after));
}

fn compare_equipment(list: &mut DifferenceList, now: &Simulation, target: &BlockState) {
    let then = &target.simulation;
    let mut compare = |name: Message, equipment, state: fn(&Simulation) -> String| {
        if target.functions.last(equipment).is_some() {
            list.compare(name, state(now), state(then));
        }
    };
    compare(
        say::restart_name_spindle(),
        Equipment::Spindle,
        spindle_code,
    );
    compare(say::restart_name_gear(), Equipment::Gear, |simulation| {
        format!("M{:02}", 40 + simulation.cnc.spindle().gear())
    });
    compare(
        say::restart_name_coolant(),
        Equipment::Coolant,
        |simulation| code(simulation.lathe.is_coolant_on(), "M08", "M09"),
    );
    compare(
        say::restart_name_lubrication(),
        Equipment::Lubrication,
        |simulation| code(simulation.lathe.is_lubrication_on(), "M32", "M33"),
    );
    compare(say::restart_name_chuck(), Equipment::Chuck, |simulation| {
        code(simulation.lathe.is_chuck_clamped(), "M12", "M13")
    });
    compare(
        say::restart_name_tailstock(),
        Equipment::Tailstock,
        |simulation| code(simulation.lathe.is_tailstock_forward(), "M10", "M11"),
    );
}

/// Returns the M code (M03, M04 or M05) of the direction in which the control has switched the
/// spindle.
fn spindle_code(simulation: &Simulation) -> String {
    format!("M{:02}", simulation.cnc.spindle_m_code())
}

fn code(is_on: bool, on: &str, off: &str) -> String {
    if is_on { on } else { off }.to_owned()
}

fn compare_memory(list: &mut DifferenceList, before: &Cnc, after: &Cnc) {
    for number in before.variable_numbers() {
        let value = |cnc: &Cnc| variable_text(cnc, number);
        list.compare_code(&format!("#{number}"), value(before), value(after));
    }
    for (number, offset) in before.offsets().iter() {
        let then = after.offsets().get(number);
        list.compare_code(
            &format!("T00{number:02}"),
            offset_text(offset),
            offset_text(&then),
        );
    }
    let changed = report::changed_parameters(before.parameters(), after.parameters());
    for (number, then) in changed {
        let now = number.parse().map(|it| before.parameters().value(it));
        let now = now.unwrap_or_default().to_string();
        list.compare_code(&format!("P{number}"), now, then.to_string());
    }
}

fn variable_text(cnc: &Cnc, number: u16) -> String {
    if cnc.are_variables_real() {
        let value = cnc.real_variable(number);
        return value.map_or_else(|| "-".to_owned(), |value| value.to_string());
    }
    let value = cnc.variables().get(number);
    value.map_or_else(|| "-".to_owned(), |value| value.to_string())
}

fn offset_text(offset: &ToolOffset) -> String {
    let ToolOffset { x, z, r, t } = offset;
    format!("X{x} Z{z} R{r} T{t}")
}

/// Formats a point as the position page shows it: X as a diameter.
fn point_text(point: Point) -> String {
    format!("X{:.3} Z{:.3}", 2.0 * point.x, point.z)
}
