//! The values that the data sheets show, from a control or a project.

use gsk_core::battery::Memory;
use gsk_core::memory::{Parameters, PitchTable, Refusal, Variables};
use gsk_panel::pages::CoordinateFormat;

use crate::kernel::monitor::{MachineView, OffsetTable, VariableTable};

/// Values, and why they cannot be written now.
#[derive(Clone, Copy)]
pub struct Values<'a> {
    pub parameters: &'a Parameters,
    pub pitch: &'a PitchTable,
    /// Why parameters cannot be written now; `None`: they can.
    pub parameters_refused: Option<Refusal>,
    pub offsets: &'a OffsetTable,
    pub variables: &'a VariableTable,
    /// Current alarms and PLC messages.
    pub alarms: &'a [String],
}

impl<'a> Values<'a> {
    /// The values of a running control.
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

    /// The values of a memory without a control. `tables` are those of the same memory.
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

/// The tables of a memory without a control. Nothing refuses a value there.
pub struct Tables {
    offsets: OffsetTable,
    variables: VariableTable,
}

impl Tables {
    /// Builds the tables. They contain the variables that are retained at power-off, in the
    /// order of the control's page.
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
            // Whole variables have 33 bits at most.
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
