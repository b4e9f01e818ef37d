//! Where reading goes on after a block.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::command::Source;
use crate::interpreter::context::exact::Exact;
use crate::interpreter::context::place::{Call, Place};

/// What follows a block.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) enum Flow {
    /// The next line.
    #[default]
    Next,
    /// Another place; calls stay as they are.
    Jump(Place),
    /// G70: the blocks of its profile, and back.
    Finish(Box<Finishing>),
    /// The next run of the innermost call.
    Again,
    /// M98.
    Call(Call),
    /// G65, and a move under G66.
    MacroCall(Box<MacroEntry>),
    /// The end of the innermost call, going on here.
    Return(Place),
    /// The end of the run.
    End,
}

/// A macro being called.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct MacroEntry {
    pub(crate) call: Call,
    /// Its local variables, by number.
    pub(crate) arguments: BTreeMap<u8, f64>,
}

/// A profile being finished.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Finishing {
    /// Its first block.
    pub(crate) first: Place,
    /// Index of its last block.
    pub(crate) last: u32,
    /// The block after the cycle.
    pub(crate) back: Place,
    /// Programmed start of the cycle.
    pub(crate) start: Exact,
    /// The block of the cycle.
    pub(crate) source: Source,
    /// Lines of its first and its last block.
    pub(crate) lines: (u32, u32),
}
