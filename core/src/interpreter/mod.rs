//! Blocks to commands: modal state and one file for each family of codes.
//!
//! ```text
//!   Program --parse--> Block --words--> Words --block::evaluate--> Plan --> Command, Command, …
//!                                         |            ^
//!                                         |            State (modal, position, frame, cycle words)
//!                                         +-- T, S, M, motion family, calls
//! ```
//!
//! A [`plan`] gives its commands one at a time, so that a cycle makes its moves
//! when they are asked for. Positions are kept as integers ([`exact`]).

mod arc;
mod block;
mod box_cycle;
mod coordinates;
mod cycle_words;
mod dwell;
mod exact;
mod facing_cycle;
mod host;
mod miscellaneous;
mod modal;
mod numbers;
mod plan;
mod positioning;
mod reader;
mod reference;
mod run;
mod spindle_speed;
mod state;
mod subprogram;
mod tool;
mod turning_cycle;
mod words;

#[cfg(test)]
mod tests;

pub use host::{Host, Step};
pub use modal::Modal;
pub(crate) use reader::Advance;
pub use reader::Interpreter;
pub(crate) use spindle_speed::speed_at as surface_rpm;
