//! What the control remembers: parameters, offsets, variables, counters.

mod counters;
mod named;
mod offsets;
mod parameters;
mod pitch;
mod table;
mod variables;

pub use counters::Counters;
pub use offsets::{OFFSETS, Offsets, ToolOffset};
pub use parameters::{ParameterError, Parameters};
pub use pitch::{PitchError, PitchTable};
pub use table::{Disk, Effective, LAST_PARAMETER, ParameterRow, Range, row, rows};
pub use variables::Variables;
