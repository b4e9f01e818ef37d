//! Runs part programs and operator scripts to their end and reports the results: moves,
//! reports, pictures. It does no I/O itself; the caller passes in files, the terminal, ports
//! and pulse boards.

pub mod board;
pub mod curves;
mod decimal;
pub mod dialect;
pub mod execution;
pub mod first_look;
pub mod lesson;
pub mod machining;
pub mod mill;
pub mod moves;
pub mod narration;
pub mod partner;
pub mod picture;
pub mod report;
pub mod script;
pub mod solid;
pub mod times;
pub mod words;

pub use gsk_messages::Language;
