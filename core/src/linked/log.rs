//! Entries of the link's log.

use crate::command::ProgramId;
use crate::units::{PerAxis, Pulses};
use gsk_link::SettingDifference;

/// An entry for the log of the link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LinkNote {
    /// The board's count was compared with the commanded count.
    CountChecked {
        /// The program that has just ended, if its end caused the comparison; otherwise
        /// `None`.
        program: Option<ProgramId>,
        /// Pulse count that the control has commanded, for each axis.
        commanded: PerAxis<Pulses>,
        /// The board's count in the control's pulses; `None` if it reported no count.
        counted: Option<PerAxis<Pulses>>,
        /// Whether the commanded and the board's count agree.
        agrees: bool,
    },
    /// The data dictionary of a board. Pass it to
    /// [`LinkedControl::add_dictionaries`](super::LinkedControl::add_dictionaries) at the
    /// next opening.
    DictionaryReceived {
        /// Name of the dictionary: processor and firmware version.
        name: String,
        /// Compressed dictionary as the board sent it.
        compressed: Vec<u8>,
    },
    /// A setting of the board differs from the required value.
    SettingDiffers(SettingDifference),
}

/// Log entries, and data for the next entries.
#[derive(Clone, Debug, Default)]
pub(super) struct LinkLog {
    /// Whether a comparison of the counts was requested and is not finished.
    pub(super) checking: bool,
    /// A count that was equal at a standstill and is not logged yet; `None` without one.
    pub(super) agreed_count: Option<PerAxis<Pulses>>,
    /// A program that ended and whose final count is not checked yet; `None` without one.
    pub(super) ended_program: Option<ProgramId>,
    pub(super) notes: Vec<LinkNote>,
}
