//! The values that differ between the machine now and the state before a block.

use gsk_core::cnc::Cnc;
use gsk_core::memory::ToolOffset;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_messages::{Message, say};

use super::block_search::BlockState;
use super::machine_functions::Equipment;
use super::words::{RestartWord, RestartWords};
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
    /// The value that the program has there, if the operator has put another one in its place.
    pub replaced: Option<String>,
    /// The word by which the operator can change the value; `None` if he cannot.
    pub word: Option<RestartWord>,
}

impl StateDifference {
    /// Returns the name with the current and the new value as one line.
    pub fn to_message(&self) -> Message {
        let name = self.name.clone();
        match &self.replaced {
            None => say::restart_difference(name, &self.now, &self.then),
            Some(replaced) => {
                say::restart_difference_changed(name, &self.now, &self.then, replaced)
            }
        }
    }

    /// The word that leaves the value of the machine as it is now; `None` if the operator cannot
    /// change the value, or not to this one (F0).
    pub fn keeping_word(&self) -> Option<String> {
        let word = self.word?;
        // The offset number of T comes from the program.
        let length = match word {
            RestartWord::Tool => self.now.len().min(2),
            _ => self.now.len(),
        };
        let keeping = word.with_value(self.now.get(..length)?);
        let is_permitted = RestartWords::default().set(&keeping).is_ok();
        is_permitted.then_some(keeping)
    }
}

/// A value now, before the block, and there by the program alone.
struct ComparedValues {
    now: String,
    then: String,
    program: String,
}

/// Collects the values that a restart changes.
#[derive(Default)]
struct DifferenceList(Vec<StateDifference>);

impl DifferenceList {
    fn compare(&mut self, name: Message, now: String, then: String) {
        if now != then {
            self.0.push(StateDifference {
                name,
                now,
                then,
                replaced: None,
                word: None,
            });
        }
    }

    /// Compares a value that the operator can change; `program` is that of the program. A changed
    /// value is in the list even if the machine has it.
    fn compare_word(&mut self, word: RestartWord, name: Message, values: ComparedValues) {
        let ComparedValues { now, then, program } = values;
        if now != then || then != program {
            self.0.push(StateDifference {
                name,
                replaced: (then != program).then_some(program),
                now,
                then,
                word: Some(word),
            });
        }
    }

    fn compare_code(&mut self, name: &str, now: String, then: String) {
        self.compare(say::as_written(name), now, then);
    }
}

/// Lists the values that a restart changes in the machine `now`. `found` is the state before the
/// block without the words of the operator.
pub(super) fn find_differences(
    now: &Simulation,
    target: &BlockState,
    found: &BlockState,
) -> Vec<StateDifference> {
    let mut list = DifferenceList::default();
    let (before, after) = (&now.cnc, &target.simulation.cnc);
    compare_words(&mut list, [before, after, &found.simulation.cnc]);
    compare_equipment(&mut list, now, target, found);
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

fn compare_words(list: &mut DifferenceList, [before, after, program]: [&Cnc; 3]) {
    let codes = |cnc: &Cnc| {
        let inch = if cnc.modal().inch { "G20" } else { "G21" };
        format!("{} {inch}", report::modal_codes(cnc.modal()).join(" "))
    };
    list.compare_code("G", codes(before), codes(after));
    let mut compare = |word: RestartWord, value: fn(&Cnc) -> String| {
        let values = ComparedValues {
            now: value(before),
            then: value(after),
            program: value(program),
        };
        list.compare_word(word, say::as_written(word.with_value("")), values);
    };
    compare(RestartWord::Feed, |cnc| cnc.modal().feed.to_string());
    compare(RestartWord::Tool, |cnc| report::tool_word(cnc.tool()));
    compare(RestartWord::Speed, |cnc| cnc.spindle().s_word().to_string());
    let limit = |cnc: &Cnc| {
        let limit = cnc.spindle().limit();
        limit.map_or_else(|| "-".to_owned(), |limit| limit.to_string())
    };
    list.compare(say::restart_name_speed_limit(), limit(before), limit(after));
}

fn compare_equipment(
    list: &mut DifferenceList,
    now: &Simulation,
    target: &BlockState,
    found: &BlockState,
) {
    let is_switched = |equipment| target.functions.last(equipment).is_some();
    let coolant = |is_on| code(is_on, "M08", "M09");
    if is_switched(Equipment::Spindle) {
        let values = ComparedValues {
            now: format!("M{:02}", now.cnc.spindle_m_code()),
            then: format!("M{:02}", target.spindle_code()),
            program: format!("M{:02}", found.spindle_code()),
        };
        list.compare_word(RestartWord::Spindle, say::restart_name_spindle(), values);
    }
    if is_switched(Equipment::Coolant) {
        let values = ComparedValues {
            now: coolant(now.lathe.is_coolant_on()),
            then: coolant(target.is_coolant_on()),
            program: coolant(found.is_coolant_on()),
        };
        list.compare_word(RestartWord::Coolant, say::restart_name_coolant(), values);
    }
    let mut compare = |name: Message, equipment, state: fn(&Simulation) -> String| {
        if is_switched(equipment) {
            list.compare(name, state(now), state(&target.simulation));
        }
    };
    compare(say::restart_name_gear(), Equipment::Gear, |simulation| {
        format!("M{:02}", 40 + simulation.cnc.spindle().gear())
    });
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
