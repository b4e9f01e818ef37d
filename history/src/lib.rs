//! Records the inputs of a machine and returns to any moment of a session: full states at
//! intervals, and the inputs after them.
//!
//! The machine is deterministic, so that a state and the later inputs determine every later
//! state ([`history::History`]). The same events, encoded as bytes, are a recording that can be
//! replayed elsewhere ([`recording`]).

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod board_exchange;
pub mod history;
pub mod machine_part;
pub mod moment;
pub mod recording;
pub mod replay;
mod state_list;
