//! The GSK980TD control and its simulated lathe: pure and deterministic, without I/O, clock
//! or threads.

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod alarm;
pub mod axis;
pub mod battery;
pub(crate) mod board;
pub mod cnc;
pub mod command;
pub mod compensation;
pub mod dialect;
pub mod interpreter;
pub mod json_line;
pub mod linked;
pub mod machine;
pub mod memory;
pub mod mode;
pub mod model;
pub mod motion;
pub mod operation;
pub mod preview;
pub mod program;
pub(crate) mod run_state;
pub mod setup;
pub mod simulation;
pub mod spindle;

pub use gsk_plc as plc;
pub use gsk_units as units;
