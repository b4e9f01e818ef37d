//! Tool-nose radius compensation C: commands with programmed geometry in,
//! commands for the imaginary tip out (manual II, C compensation).
//!
//! ```text
//!  interpreter --Command--> push ... take --Command--> control, preview
//!                             |
//!        stand      moving    |  held          Off    everything passes
//!        corner of  the move  |  commands      On     a move waits for the next
//!        the move   whose end |  after it             one, which gives its end
//!        before     is open   |
//! ```
//!
//! A move is given out as soon as the next one is known; while it runs the one
//! after that is read: three blocks are under way. Two blocks in a row without
//! motion, or a block that must not be read yet, end the open move square to
//! itself. Without G41 and G42 no command comes here.
//!
//! `stream` takes the commands, `settle` gives moves their ends, `moves` is
//! what both handle. The geometry has one file each: `piece` moves, `intersection` where two
//! paths meet, `corner` the vectors of a corner, `interference` the check with
//! `clearance` for distances, `legs` the boxes of G90 and G94.

mod clearance;
mod corner;
pub mod cutter;
mod fault;
mod interference;
mod intersection;
mod legs;
mod moves;
mod nose;
mod piece;
mod plane;
mod settle;
mod stream;

#[cfg(test)]
mod tests;

pub(crate) use fault::Fault;
pub(crate) use legs::box_corners;
pub(crate) use nose::Nose;
pub(crate) use piece::check_arc;
pub(crate) use stream::{Compensation, Origin};

use crate::units::{Point, round};

/// The least increment: 0.001 mm in Z and in the diameter X.
fn rounded(point: Point) -> Point {
    Point::new(
        round(point.x * 2000.0) / 2000.0,
        round(point.z * 1000.0) / 1000.0,
    )
}
