//! Boards that read lines of G code: Grbl 1.1, grblHAL, FluidNC.
//!
//! The link sends motion as straight segments of fixed duration. The required settings
//! keep the board's own planner from limiting the motion. Unanswered lines never exceed
//! the board's receive buffer, and queued motion never exceeds the lookahead.

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
