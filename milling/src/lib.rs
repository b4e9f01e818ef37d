//! Interprets programs of the GSK980MDi, a mill control of the same family.
//!
//! It turns blocks into moves of three to five axes with scaling, rotation, length offsets
//! and cutter radius compensation, and reports their time and alarms. `check` and `plot` use
//! it. No machine runs it.
//!
//! ```text
//!   gsk_core: text -> words -> blocks, macro B, calls
//!      Walker --block--> words --> block (codes/) --> transform --> cutter --> tracker --> Move
//!                                   |                                            |
//!                                   memory: parameters, offsets, zeros           time, bounds
//! ```

mod arc;
mod axes;
mod block;
mod bounds;
mod caution;
mod codes;
pub mod commissioning;
mod cutter;
mod cycles;
mod homing;
pub mod keys;
mod memory;
mod modal;
mod moves;
mod options;
mod parameter_table;
mod preview;
mod space;
mod state;
mod system;
mod time;
mod tracker;
mod transform;
mod travel;
mod words;

#[cfg(test)]
mod tests;

pub use axes::{Axes, Further};
pub use bounds::{Bounds, Lengths};
pub use caution::{Caution, Slip};
pub use homing::{ParameterValues, homing};
pub use memory::{MillMemory, Offset, parameter};
pub use modal::{Modal, Spindle};
pub use moves::{Arc, Move, MoveKind};
pub use options::WordError;
pub use parameter_table::{ParameterRow, parameter_rows};
pub use preview::{End, MillSetup, Preview, Progress, preview_while};
pub use space::{Axis, Each, Flat, Length, Plane, Position};
