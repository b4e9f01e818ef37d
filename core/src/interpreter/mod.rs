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
mod arithmetic;
mod block;
mod box_cycle;
mod compound;
mod compound_thread;
mod contour;
mod coordinates;
mod corner;
mod cycle;
mod cycle_words;
mod dwell;
mod exact;
mod explanation;
mod facing_cycle;
mod finishing;
mod host;
mod immediate;
mod inch;
mod jump;
mod lookahead;
mod macro_block;
mod miscellaneous;
mod modal;
mod nose_compensation;
mod numbers;
mod pattern;
mod pecking;
mod plan;
mod positioning;
mod profile;
mod reader;
mod reference;
mod roughing;
mod run;
mod special_call;
mod spindle_speed;
mod state;
mod subprogram;
mod tapping;
mod thread;
mod thread_cycle;
mod tool;
mod turning_cycle;
mod variable;
mod words;

#[cfg(test)]
mod tests;

pub use explanation::Explanation;
pub use host::{Host, Step};
pub use immediate::Immediate;
pub use miscellaneous::MachineCodes;
pub use modal::Modal;
pub use reader::Interpreter;
pub(crate) use reader::{Advance, ReadTo};
pub(crate) use spindle_speed::speed_at as surface_rpm;
