//! Data that the control stores: parameters, offsets, variables, counters.

mod authority;
mod counters;
mod disks;
mod factory_values;
mod machine_parameters;
mod named_parameters;
mod offsets;
mod panel_parameters;
pub mod parameter;
mod parameter_groups;
mod parameter_table;
mod parameters;
mod pitch;
mod registers;
mod rights;
mod settings;
mod variables;

pub use authority::{Authority, OperationLevel};
pub use counters::Counters;
pub use disks::{DiskContent, Disks};
pub use offsets::{OFFSET_ROWS, Offsets, ToolOffset};
pub use parameter_groups::ParameterGroup;
pub use parameter_table::{
    EffectiveTime, ElectronicDisk, ParameterRange, ParameterRow, parameter_row, parameter_rows,
};
pub use parameters::{ControlParameters, ParameterError};
pub use pitch::{PitchError, PitchTable};
pub(crate) use registers::SwitchedOff;
pub use registers::{DayTime, Registers};
pub use rights::{Rights, WriteRefusal};
pub use settings::{ControlSettings, SettingRow};
pub use variables::Variables;
