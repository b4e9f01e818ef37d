//! What the owner should find in the log of a link.

use crate::command::ProgramId;
use crate::units::{PerAxis, Pulses};
use gsk_link::SettingDifference;

/// Something for the log of the link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Note {
    /// The board's count was compared with the commanded one.
    Checked {
        /// The program that has just ended, if it was that.
        program: Option<ProgramId>,
        /// What was commanded.
        commanded: PerAxis<Pulses>,
        /// What the board has counted, where it said so.
        counted: Option<PerAxis<Pulses>>,
        /// They agree.
        agrees: bool,
    },
    /// What a board said it understands, for [`Linked::know`](super::Linked::know) at the next opening.
    Learned {
        /// Processor and version.
        name: String,
        /// As it goes over the wire.
        packed: Vec<u8>,
    },
    /// A setting of the board is not what it has to be.
    Differs(SettingDifference),
}

/// Notes, and what is still to become one.
#[derive(Clone, Debug, Default)]
pub(super) struct Log {
    /// Somebody wants to know whether the counts agree; the board has been asked.
    pub(super) checking: bool,
    /// A count that agreed at a standstill and has not been noted yet.
    pub(super) agreed: Option<PerAxis<Pulses>>,
    /// The program that ended and whose end has not been checked yet.
    pub(super) ended: Option<ProgramId>,
    pub(super) notes: Vec<Note>,
}
