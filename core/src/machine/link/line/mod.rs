//! Boards that read lines: Grbl 1.1, grblHAL, FluidNC.
//!
//! Motion goes out as straight segments of fixed duration; the board's own
//! planner is set so that it never limits. Characters of unanswered lines never
//! exceed the board's receive buffer, motion not yet made never exceeds the
//! lookahead.

mod answers;
mod describe;
mod family;
mod items;
mod opening;
mod required;
mod segments;
mod session;

pub use answers::{Answer, BoardState, Status};
pub(super) use describe::piece;
pub use family::Family;
pub use required::{Limits, Required, Setting};
pub use session::LineLink;
