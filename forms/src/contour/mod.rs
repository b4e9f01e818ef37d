//! Outlines of contour forms: points as they are given, and the lines and arcs that follow
//! from them.

mod corners;
mod drawn;
mod open_end;
mod path;
mod points;
mod solve;

pub(crate) use corners::round_corners;
pub use drawn::outline_of_profile;
pub use path::SolvedPiece;
pub use points::{CornerShape, TurnedArc, TurnedOutline, TurnedPoint};
pub use solve::OutlineSolution;
