//! Runs part programs and operator scripts to their end and reports the results: moves, the
//! part, reports. It does no I/O itself; the caller passes in files, the terminal, ports and
//! pulse boards.

pub mod block_calls;
pub mod board;
pub mod curves;
pub mod dialect;
pub mod execution;
mod html;
pub mod ladder;
pub mod machining;
pub mod mill;
pub mod move_output;
pub mod narration;
pub mod partner;
pub mod program_summary;
pub mod report;
pub mod restart;
pub mod script;
pub mod sheet;
pub mod text_format;
pub mod times;

pub use gsk_messages::Language;
