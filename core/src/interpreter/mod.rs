//! Blocks to commands: modal state and one file for each family of codes.
//!
//! ```text
//!   Program --parse--> Block --words--> Words --block::evaluate--> Plan --> Command, Command, …
//!                                         |            ^
//!                                         |            State (modal, position, frame, cycle words)
//!                                         +-- T, S, M, motion family, calls
//! ```
//!
//! A `plan` gives its commands one at a time, so that a cycle makes its moves
//! when they are asked for. Positions are kept as integers (`exact`).

mod arc;
mod arithmetic;
mod block;
mod box_cycle;
mod compound;
mod compound_thread;
mod context;
mod contour;
mod coordinates;
mod corner;
mod cycle;
mod cycle_words;
mod dwell;
mod emission;
mod exact;
mod explanation;
mod facing_cycle;
mod finishing;
mod flow;
mod host;
mod immediate;
mod inch;
mod jump;
mod lookahead;
mod machine_codes;
mod macro_block;
mod miscellaneous;
mod moves;
mod nose_compensation;
mod nose_radius;
mod pass_over;
mod pattern;
mod pecking;
mod place;
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
mod writes;

#[cfg(test)]
mod tests;

pub use crate::command::Modal;
pub use explanation::Explanation;
pub use host::{Host, Step};
pub use immediate::Immediate;
pub use machine_codes::MachineCodes;
pub(crate) use pass_over::PassedOver;
pub use reader::Interpreter;
pub(crate) use reader::{Advance, ReadTo};
pub(crate) use spindle_speed::speed_at as surface_rpm;
