//! Interprets programs of the GSK980MDi, a mill control of the same family.
//!
//! It turns blocks into moves of three to five axes with scaling, rotation, length offsets
//! and cutter radius compensation, and reports their time and alarms. `check` and `plot` use
//! it. No machine runs it.
//!
//! ```text
//!   gsk_core: text -> words -> blocks, macro B, calls
//!      Walker --block--> words --> block (codes/) --> transform --> cutter --> tracker --> move
//!                                   |                                            |
//!                                   memory: parameters, offsets, zeros           time, bounds
//! ```

mod axes;
mod block;
mod caution;
mod codes;
pub mod commissioning;
mod cycles;
pub mod keys;
pub mod machine_tables;
mod memory;
mod modal;
mod options;
mod parameter_table;
mod path;
mod preview;
mod reference_return;
mod space;
mod state;
mod system;
mod transform;
mod words;

#[cfg(test)]
mod tests;

pub use axes::{Axes, FurtherAxis};
pub use caution::{MillCaution, MillSlip};
pub use memory::{MillMemory, MillOffset, MillOffsetMemory, parameter};
pub use modal::{MillModal, SpindleState};
pub use options::MillWordError;
pub use parameter_table::{MillParameterRow, WithoutEffect, mill_parameter_rows};
pub use path::bounds::{MillBounds, MillPathLengths};
pub use path::moves::{MillArc, MillMove, MillMoveKind};
pub use preview::{MillPreview, MillSetup, PreviewEnd, PreviewProgress, preview_while};
pub use reference_return::{ParameterValues, describe_reference_returns};
pub use space::{AxisValues, Length, MillAxis, MillPosition, Plane, PlanePoint};
