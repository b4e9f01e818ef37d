//! Interprets programs: turns blocks into commands. One folder for each family of codes.
//!
//! ```text
//!   Program --parse--> Block --sort--> SortedWords --evaluate--> Plan --> Command, …
//!                                        |            ^
//!                                        |            modal state, position, frame, …
//!                                        +-- T, S, M, motion family, calls
//! ```
//!
//! A `plan` gives its commands one at a time, so that a cycle makes each move when the caller
//! requests it. Positions are integers (`exact`).

mod block;
mod calls;
mod canned_cycle;
mod codes;
mod context;
mod cycles;
mod exact;
mod flow;
mod host;
mod macros;
mod moves;
mod nose_compensation;
mod parameter_writes;
mod pass_over;
mod plain_move;
mod plan;
mod profile;
mod reader;
mod state;
mod threads;
mod watch;
mod words;

#[cfg(test)]
mod tests;

pub use crate::command::ModalState;
pub(crate) use codes::spindle_speed::rpm_at_diameter as surface_rpm;
pub use flow::code_calls::{PlainCall, T_VARIABLE};
pub use host::immediate_host::ImmediateHost;
pub use host::machine_codes::MachineCodes;
pub use host::{Host, InterpreterStep};
pub use macros::variable::ReadError;
pub use macros::variable_access::{VariableReader, VariableWriter};
pub use moves::explanation::Explanation;
pub(crate) use pass_over::PassedOver;
pub use reader::Interpreter;
pub use reader::walker::{WalkedBlock, Walker};
pub use reader::word_audit::{BlockRemark, IgnoredWord, LocatedRemark, WordAdvice};
pub(crate) use reader::{AdvanceResult, ReadState};
pub use watch::RunningCall;
