//! Boards that read lines: Grbl 1.1, grblHAL, FluidNC.
//!
//! Motion goes out as straight segments of fixed duration; the board's own
//! planner is set so that it never limits. Characters of unanswered lines never
//! exceed the board's receive buffer, motion not yet made never exceeds the
//! lookahead.

mod describe;
mod family;
mod fluidnc_config;
mod opening;
mod realtime;
mod reported;
mod required;
mod response;
mod segments;
mod session;

pub use family::FirmwareFamily;
pub use required::{RequiredSettings, Setting};
pub use response::{BoardState, LineResponse, StatusReport};
pub use session::LineLink;
