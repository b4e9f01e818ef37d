//! A part program or an operator script carried out to its end, and what is told of it:
//! moves, reports, pictures. Pure: files, the terminal, ports and pulse boards are handed
//! in by whoever carries something out.

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
