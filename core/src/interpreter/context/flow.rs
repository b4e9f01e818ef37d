//! Which block the reader reads after a block.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::command::Source;
use crate::interpreter::context::exact::Exact;
use crate::interpreter::context::place::{Call, Place};

/// The flow of a run after a block.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) enum Flow {
    /// Reads the next block.
    #[default]
    Next,
    /// Jumps to another block; the running calls stay.
    Jump(Place),
    /// Runs the profile of a G70, then returns.
    #[serde(rename = "Finish")]
    Finish(Box<Finishing>),
    /// Starts the next run of the innermost call.
    #[serde(rename = "Again")]
    Again,
    /// Calls a subprogram (M98).
    Call(Call),
    /// Calls a macro: G65, or a move under G66.
    MacroCall(Box<MacroEntry>),
    /// Ends the innermost call and continues at this block.
    Return(Place),
    /// Ends the run.
    End,
}

/// A call of a macro with its arguments.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct MacroEntry {
    pub(crate) call: Call,
    /// Arguments: local variables by number.
    pub(crate) arguments: BTreeMap<u8, f64>,
}

/// A G70 that runs its profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Finishing {
    /// The first block of the profile.
    pub(crate) first: Place,
    /// Index of the last block of the profile.
    pub(crate) last: u32,
    /// The block after the G70.
    #[serde(rename = "back")]
    pub(crate) back: Place,
    /// Programmed position at the start of the G70.
    pub(crate) start: Exact,
    /// Source position of the G70.
    pub(crate) source: Source,
    /// Lines of the first and the last block of the profile.
    pub(crate) lines: (u32, u32),
}
