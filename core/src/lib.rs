//! The GSK980TD control itself, pure and deterministic, and the simulated lathe.

pub mod alarm;
pub mod axis;
pub mod cnc;
pub mod command;
pub(crate) mod compensation;
pub mod interpreter;
pub mod machine;
pub mod memory;
pub mod motion;
pub mod operation;
pub mod preview;
pub mod program;
pub mod setup;
pub mod simulation;
pub mod spindle;
pub mod units;

pub use gsk_plc as plc;
