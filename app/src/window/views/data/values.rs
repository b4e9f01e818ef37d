//! The values that the pages show, of whatever holds them: a control, or a project.

use gsk_core::battery::Memory;
use gsk_core::memory::{Parameters, PitchTable, Refusal, Variables};
use gsk_panel::pages::CoordinateFormat;

use crate::kernel::monitor::{MachineView, OffsetTable, VariableTable};

/// Values, and why they would not be taken now.
#[derive(Clone, Copy)]
pub struct Values<'a> {
    /// The parameters.
    pub parameters: &'a Parameters,
    /// The pitch error table.
    pub pitch: &'a PitchTable,
    /// Why no parameters would be taken now.
    pub parameters_refused: Option<Refusal>,
    /// The tool offsets.
    pub offsets: &'a OffsetTable,
    /// The macro variables.
    pub variables: &'a VariableTable,
    /// Alarms and messages that stand.
    pub alarms: &'a [String],
}

impl<'a> Values<'a> {
    /// Of a control.
    pub fn of_control(machine: &'a MachineView) -> Self {
        Self {
            parameters: &machine.parameters,
            pitch: &machine.pitch,
            parameters_refused: machine.parameters_refused,
            offsets: &machine.offsets,
            variables: &machine.variables,
            alarms: &machine.alarms,
        }
    }

    /// Of a memory that no control runs with; `tables`: its own.
    pub const fn of_memory(memory: &'a Memory, tables: &'a Tables) -> Self {
        Self {
            parameters: &memory.parameters,
            pitch: &memory.pitch,
            parameters_refused: None,
            offsets: &tables.offsets,
            variables: &tables.variables,
            alarms: &[],
        }
    }
}

/// The tables of a memory that no control runs with: nothing refuses a value there.
pub struct Tables {
    offsets: OffsetTable,
    variables: VariableTable,
}

impl Tables {
    /// Of a memory; of the variables those that outlast power-off, as the page of the
    /// control lists them.
    pub fn of(memory: &Memory) -> Self {
        let own = memory.model.record().own_variables;
        let real = memory.settings.macro_b || own;
        let numbers: Vec<u16> = match memory.settings.macro_b && !own {
            true => Variables::numbers_of_macro_b().collect(),
            false => Variables::numbers().collect(),
        };
        let lasting = numbers
            .into_iter()
            .filter(|it| gsk_project::is_retained_variable(*it));
        let value = |number| match real {
            true => memory.variables.real(number),
            // 33 bits at most.
            false => memory.variables.get(number).map(|value| value as f64),
        };
        Self {
            offsets: OffsetTable {
                rows: memory.offsets.clone(),
                display: CoordinateFormat {
                    diameter: !memory.parameters.radius_programming(),
                    inch: memory.parameters.inch_machine(),
                },
                refused: None,
            },
            variables: VariableTable {
                rows: lasting.map(|number| (number, value(number))).collect(),
                real,
                refused: None,
            },
        }
    }
}
