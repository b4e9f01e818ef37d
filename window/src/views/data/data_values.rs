//! The values that the data sheets show, from a control or a project.

use gsk_core::battery::BatteryMemory;
use gsk_core::memory::{ControlParameters, PitchTable, Variables, WriteRefusal};
use gsk_core::model::ModelRecord;
use gsk_host::kernel::monitor::{MachineAlarms, MachineView, OffsetTable, VariableTable};
use gsk_panel::pages::CoordinateFormat;

/// The values that the data view shows, and why they cannot be written now.
#[derive(Clone)]
pub struct DataValues<'a> {
    /// The record of the control model, which may have separate ranges.
    pub record: &'static ModelRecord,
    /// The parameters as this model is delivered.
    pub delivered: ControlParameters,
    pub parameters: &'a ControlParameters,
    pub pitch: &'a PitchTable,
    /// The reason why parameters cannot be written at the moment; `None` if they can.
    pub parameters_refusal: Option<WriteRefusal>,
    pub offsets: &'a OffsetTable,
    pub variables: &'a VariableTable,
    /// The active alarms; `None` for a memory without a control.
    pub alarms: Option<&'a MachineAlarms>,
}

impl<'a> DataValues<'a> {
    /// Creates the values that the pages show for a running control.
    pub fn of_control(machine: &'a MachineView, record: &'static ModelRecord) -> Self {
        Self {
            record,
            delivered: delivered_parameters(record),
            parameters: &machine.parameters,
            pitch: &machine.pitch,
            parameters_refusal: machine.parameters_refused,
            offsets: &machine.offsets,
            variables: &machine.variables,
            alarms: Some(&machine.alarms),
        }
    }

    /// Creates the values of a memory without a control. `tables` are those of the same
    /// memory.
    pub fn of_memory(memory: &'a BatteryMemory, tables: &'a MemoryTables) -> Self {
        Self {
            record: memory.model.record(),
            delivered: delivered_parameters(memory.model.record()),
            parameters: &memory.parameters,
            pitch: &memory.pitch,
            parameters_refusal: None,
            offsets: &tables.offsets,
            variables: &tables.variables,
            alarms: None,
        }
    }
}

/// Returns the parameters with which a control model is delivered.
fn delivered_parameters(record: &ModelRecord) -> ControlParameters {
    let mut parameters = ControlParameters::default();
    parameters.apply_delivered_values(record);
    parameters
}

/// The tables of a memory without a control, where nothing refuses a value.
pub struct MemoryTables {
    offsets: OffsetTable,
    variables: VariableTable,
}

impl MemoryTables {
    /// Builds the tables of a memory. They contain the variables that are retained at
    /// power-off, in the order of the control's page.
    pub fn from_memory(memory: &BatteryMemory) -> Self {
        let has_model_variables = memory.model.record().own_variables;
        let is_real = memory.settings.macro_b || has_model_variables;
        let numbers: Vec<u16> = match memory.settings.macro_b && !has_model_variables {
            true => Variables::numbers_of_macro_b().collect(),
            false => Variables::numbers().collect(),
        };
        let retained = numbers
            .into_iter()
            .filter(|it| gsk_project::is_retained_variable(*it));
        let value = |number| match is_real {
            true => memory.variables.real_value(number),
            // Whole variables have 33 bits at most.
            false => memory.variables.get(number).map(|value| value as f64),
        };
        Self {
            offsets: OffsetTable {
                rows: memory.offsets.clone(),
                display: CoordinateFormat {
                    diameter: !memory.parameters.is_radius_programming(),
                    inch: memory.parameters.is_inch_machine(),
                },
                refused: None,
            },
            variables: VariableTable {
                rows: retained.map(|number| (number, value(number))).collect(),
                real: is_real,
                refused: None,
            },
        }
    }
}
