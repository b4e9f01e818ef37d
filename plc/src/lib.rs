//! A ladder engine for the GSK980TD: compiles an instruction list and runs it in two
//! levels.
//!
//! ```
//! use std::sync::Arc;
//! use gsk_plc::{Ladder, Plc};
//!
//! let ladder = Ladder::compile("END1\nLDI F100.3\nOUT G120.0\nEND2")?;
//! let mut plc = Plc::new(Arc::new(ladder));
//! plc.run_slot();
//! assert_eq!(plc.memory().g(120), 1);
//! # Ok::<(), gsk_plc::CompileErrors>(())
//! ```
//!
//! The crate does not depend on the CNC. [`Ladder`] is a compiled instruction list,
//! [`PlcMemory`] contains the areas X Y F G R A K D T C DC DT, and [`Plc::run_slot`] runs
//! the program in slots of 8 ms. The crate does no I/O and reads no clock: the same inputs
//! in the same slots give the same memory.

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod address;
mod check;
mod code;
mod cross_reference;
mod debugging;
mod declarations;
mod diagnostic;
mod directive;
mod force;
mod function;
mod instruction;
mod ladder;
mod listing;
mod memory;
mod network;
mod parser;
mod rung_dependencies;
mod rung_text;
mod scan;
mod scan_position;
mod skippable_rungs;
mod timer;

pub use address::{AddressError, Area, BitAddress, ByteAddress};
pub use check::MAX_STEPS;
pub use cross_reference::{Access, CrossReference};
pub use declarations::LadderDeclarations;
pub use diagnostic::{CompileError, CompileErrors, Rule, compile_summary};
pub use directive::{Comment, Header, LadderMessage, MCode, PlcAddress, StartValue};
pub use force::Force;
pub use instruction::{
    INSTRUCTIONS, InstructionRole, InstructionRow, Mnemonic, Operand, OperandKind, Statement,
};
pub use ladder::{Ladder, Rung};
pub use memory::{PlcMemory, RetainedMemory};
pub use network::{Branch, Contact, Element, Network, PowerFlow, RungBody};
pub use scan::{Plc, PlcFault};
