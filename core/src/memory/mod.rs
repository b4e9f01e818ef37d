//! Data that the control stores: parameters, offsets, variables, counters.

/// Numbers of data parameters that other modules pass on, by name, from the `id` column of
/// `assets/tables/parameters.tsv`. All other parameters have a method of [`Parameters`].
pub mod parameter {
    include!(concat!(env!("OUT_DIR"), "/parameter_numbers.rs"));
}

mod authority;
mod counters;
mod disks;
mod groups;
mod named;
mod named_machine;
mod named_panel;
mod offsets;
mod parameters;
mod pitch;
mod registers;
mod rights;
mod settings;
mod table;
mod variables;

pub use authority::{Authority, Level};
pub use counters::Counters;
pub use disks::{DiskContent, Disks};
pub use groups::ParameterGroup;
pub use offsets::{OFFSETS, Offsets, ToolOffset};
pub use parameters::{ParameterError, Parameters};
pub use pitch::{PitchError, PitchTable};
pub(crate) use registers::SwitchedOff;
pub use registers::{DayTime, Registers};
pub use rights::{Refusal, Rights};
pub use settings::{Setting, Settings};
pub use table::{Disk, Effective, ParameterRow, Range, row, rows};
pub use variables::Variables;
