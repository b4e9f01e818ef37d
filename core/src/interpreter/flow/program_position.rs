//! Positions of blocks in programs, and the calls that return to them.

use core::num::NonZeroU32;

use serde::{Deserialize, Serialize};

use crate::command::ProgramId;

/// The position of a block: its program and index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct ProgramPosition {
    pub(crate) program: ProgramId,
    /// Index of the block in the program, from 0.
    pub(crate) block: u32,
}

impl ProgramPosition {
    /// Returns the position of the next block.
    pub(crate) const fn next_block(self) -> Self {
        Self {
            block: self.block.saturating_add(1),
            ..self
        }
    }
}

/// A running call of a subprogram or macro, or of a range of blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct ProgramCall {
    /// The program whose blocks the call runs.
    pub(crate) program: ProgramId,
    /// Number of runs left, the current one included.
    #[serde(rename = "runs")]
    pub(crate) runs_left: u16,
    /// Position of the block after the call, where the caller continues.
    #[serde(rename = "back")]
    pub(crate) return_position: ProgramPosition,
    /// The kind of the call, which determines its local variables.
    #[serde(default, skip_serializing_if = "CallKind::is_subprogram")]
    pub(crate) kind: CallKind,
    /// Index, from 0, of the block with which each run begins.
    #[serde(default)]
    #[serde(rename = "first")]
    pub(crate) first_block: u32,
    /// Number of blocks of each run; `None` if M99 or the end of the program ends the run.
    #[serde(default)]
    #[serde(rename = "blocks")]
    pub(crate) block_count: Option<NonZeroU32>,
    /// Whether the codes of `CodeCalls` are ordinary codes in the called program, which call
    /// no program.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    pub(crate) codes_ordinary: bool,
}

impl ProgramCall {
    /// The position of the first block of each run.
    pub(crate) const fn begin_position(&self) -> ProgramPosition {
        ProgramPosition {
            program: self.program,
            block: self.first_block,
        }
    }

    /// Whether `position` is after the last block of a run; false for a call without a number
    /// of blocks.
    pub(crate) fn is_finished_at(&self, position: ProgramPosition) -> bool {
        self.block_count.is_some_and(|count| {
            position.program == self.program
                && position.block >= self.first_block.saturating_add(count.get())
        })
    }
}

/// The kind of a program call, which determines its local variables.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum CallKind {
    /// By M98: shares the variables of its caller.
    #[default]
    Subprogram,
    /// By G65: has separate variables, deleted at its end.
    Macro,
    /// By a move under the modal call (G66) with this index, from 0: keeps its variables from
    /// call to call.
    Modal(u8),
}

impl CallKind {
    /// Whether the call shares the variables of its caller.
    pub(crate) const fn is_subprogram(&self) -> bool {
        matches!(self, Self::Subprogram)
    }
}
