//! Places in programs, and the calls that lead back to one.

use core::num::NonZeroU32;

use serde::{Deserialize, Serialize};

use crate::command::ProgramId;

/// Where the next block is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Place {
    pub(crate) program: ProgramId,
    /// Index of the block, from 0.
    pub(crate) block: u32,
}

impl Place {
    /// The block that follows.
    pub(crate) const fn after(self) -> Self {
        Self {
            block: self.block.saturating_add(1),
            ..self
        }
    }
}

/// A call under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Call {
    /// The program called.
    pub(crate) program: ProgramId,
    /// How many runs are left, the present one included.
    pub(crate) runs: u16,
    /// The block after the call.
    pub(crate) back: Place,
    /// What it has of its own.
    #[serde(default, skip_serializing_if = "CallKind::is_subprogram")]
    pub(crate) kind: CallKind,
    /// The block that each run begins with.
    #[serde(default)]
    pub(crate) first: u32,
    /// How many blocks each run has; none: up to the one that ends it.
    #[serde(default)]
    pub(crate) blocks: Option<NonZeroU32>,
    /// Codes that call a program by parameters are ordinary ones in it.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    pub(crate) codes_ordinary: bool,
}

impl Call {
    /// Where a run begins.
    pub(crate) const fn begin(&self) -> Place {
        Place {
            program: self.program,
            block: self.first,
        }
    }

    /// Whether a block is beyond the last one of a run.
    pub(crate) fn is_over(&self, place: Place) -> bool {
        self.blocks.is_some_and(|count| {
            place.program == self.program && place.block >= self.first.saturating_add(count.get())
        })
    }
}

/// How a program was called.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum CallKind {
    /// M98: the variables of its caller.
    #[default]
    Subprogram,
    /// G65: variables of its own.
    Macro,
    /// After a move, by the G66 of this index: variables that it keeps.
    Modal(u8),
}

impl CallKind {
    /// Whether it is an M98.
    pub(crate) const fn is_subprogram(&self) -> bool {
        matches!(self, Self::Subprogram)
    }
}
