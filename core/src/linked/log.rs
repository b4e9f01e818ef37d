//! Entries of the link's log.

use crate::command::ProgramId;
use crate::units::{PerAxis, Pulses};
use gsk_link::SettingDifference;

/// An entry of the link's log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LinkNote {
    /// The board's count was compared with the commanded count.
    CountChecked {
        /// The program that has just ended, if its end caused the comparison.
        program: Option<ProgramId>,
        /// Pulses that the control commanded.
        commanded: PerAxis<Pulses>,
        /// Count of the board in the control's pulses; `None` if it reported none.
        counted: Option<PerAxis<Pulses>>,
        /// Whether both counts agree.
        agrees: bool,
    },
    /// The data dictionary of a board, for [`LinkedControl::add_dictionaries`](super::LinkedControl::add_dictionaries) at the
    /// next opening.
    DictionaryReceived {
        /// Processor and firmware version.
        name: String,
        /// Compressed dictionary as the board sent it.
        compressed: Vec<u8>,
    },
    /// A setting of the board differs from what the control needs.
    SettingDiffers(SettingDifference),
}

/// Log entries, and state for entries to come.
#[derive(Clone, Debug, Default)]
pub(super) struct LinkLog {
    /// Set while a requested comparison of the counts is under way.
    pub(super) checking: bool,
    /// A count that agreed at a standstill and is not logged yet.
    pub(super) agreed_count: Option<PerAxis<Pulses>>,
    /// A program that ended and whose final count is not checked yet.
    pub(super) ended_program: Option<ProgramId>,
    pub(super) notes: Vec<LinkNote>,
}
