//! Tool-nose radius compensation C: converts commands with programmed geometry into commands
//! for the imaginary tip (manual II, C compensation).
//!
//! ```text
//!  interpreter --Command--> push ... take --Command--> control, preview
//!                             |
//!        tip        open      |  held          Off    commands pass unchanged
//!        vectors of the move  |  commands      On     a move waits for the next
//!        the last   without   |  after it             one, which gives its end
//!        corner     an end    |  (`Moving`)
//! ```
//!
//! A move is released as soon as the next one is known. While it runs, the move after that
//! is read: three blocks are active at once. Two consecutive blocks without motion, or a
//! block that must not be read yet, end the open move perpendicular to itself. Without G41
//! and G42 no command passes through here.
//!
//! `stream` accepts the commands, `move_ends` gives moves their ends, `open_move` holds the types
//! of both. Each part of the geometry has a file: `segment` for moves, `intersection` for the
//! meeting points of two paths, `corner` for the vectors of a corner, `interference` for the
//! check, `clearance` for distances, `box_legs` for the boxes of G90 and G94.

mod box_legs;
mod clearance;
mod corner;
pub mod cutter;
mod fault;
mod interference;
mod intersection;
mod move_ends;
mod nose;
mod open_move;
mod plane;
mod segment;
mod settings;
mod stream;

#[cfg(test)]
mod tests;

pub(crate) use box_legs::box_corners;
pub(crate) use fault::CompensationFault;
pub(crate) use nose::Nose;
pub(crate) use segment::check_arc;
pub use settings::{CompensationSettings, StartUpType};
pub(crate) use stream::{CommandContext, NoseCompensation};

use crate::units::Point;

/// Rounds a point to the least increment of the lathe: 0.001 mm in Z and in the diameter X.
fn round_to_increment(point: Point) -> Point {
    CompensationSettings::default().round(point)
}
