//! Which block the reader reads after a block.

pub(super) mod call_context;
pub(super) mod code_calls;
pub(super) mod program_position;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::command::SourcePosition;
use crate::interpreter::exact::ExactPoint;
use crate::interpreter::flow::program_position::{ProgramCall, ProgramPosition};

/// The continuation of a run after a block: the next block, a jump, a call, a return or the end.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) enum Flow {
    /// Continues with the next block of the program.
    #[default]
    Next,
    /// Jumps to the block at this position; the running calls stay.
    Jump(ProgramPosition),
    /// Runs the profile of a G70, then returns to the block after the G70.
    #[serde(rename = "Finish")]
    RunProfile(Box<Finishing>),
    /// Repeats the innermost call, which has runs left.
    #[serde(rename = "Again")]
    RunAgain,
    /// Makes this call of a subprogram or of a range of blocks (M98, G20, G25).
    Call(ProgramCall),
    /// Makes this call of a macro, by G65, by another code or by a move under G66.
    MacroCall(Box<MacroEntry>),
    /// Ends the innermost call and continues at the block with this position.
    Return(ProgramPosition),
    /// Ends the run of the program.
    End,
}

/// A call of a macro with its arguments.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct MacroEntry {
    pub(crate) call: ProgramCall,
    /// Values of the local variables at the beginning of the call, by variable number.
    pub(crate) arguments: BTreeMap<u8, f64>,
}

/// A running G70: the profile that it runs and where it returns to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Finishing {
    /// Position of the first block of the profile.
    pub(crate) first: ProgramPosition,
    /// Index of the last block of the profile, from 0.
    pub(crate) last: u32,
    /// Position of the block after the G70, where the run continues.
    #[serde(rename = "back")]
    pub(crate) return_position: ProgramPosition,
    /// Programmed position at the start of the G70.
    pub(crate) start: ExactPoint,
    /// Source position of the G70 block.
    pub(crate) source: SourcePosition,
    /// Lines of the first and the last block of the profile in the text of the program.
    pub(crate) lines: (u32, u32),
}
