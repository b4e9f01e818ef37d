//! Reasons for refused requests of a file transfer.

use gsk_messages::{Message, say};

/// The reason for which a request is refused. Each reason has a code on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum TransferFault {
    /// A file of this name already exists.
    Exists,
    /// No file of this name exists.
    NotFound,
    /// The control cannot have a file of this name.
    BadName,
    /// The password level or a lock forbids the request.
    NoRight,
    /// 程序开关 (program switch) or 参数开关 (parameter switch) is off.
    SwitchOff,
    /// The memory is full.
    Full,
    /// The control is machining, moving, or busy with another transfer.
    Busy,
    /// The frame is damaged; the sender retransmits it.
    Damaged,
    /// The request is out of sequence: no connection, or no file that it belongs to.
    Sequence,
    /// The content does not match the announcement or the name.
    Content,
}

impl TransferFault {
    /// All faults with their codes on the wire.
    const ALL: [(u8, Self); 10] = [
        (1, Self::Exists),
        (2, Self::NotFound),
        (3, Self::BadName),
        (4, Self::NoRight),
        (5, Self::SwitchOff),
        (6, Self::Full),
        (7, Self::Busy),
        (8, Self::Damaged),
        (9, Self::Sequence),
        (10, Self::Content),
    ];

    /// Returns the code on the wire, 1 to 10.
    pub fn code(self) -> u8 {
        let row = Self::ALL.iter().find(|(_, fault)| *fault == self);
        row.map_or(0, |(code, _)| *code)
    }

    /// Finds the fault of a code; `None` for an unknown code.
    pub fn from_code(code: u8) -> Option<Self> {
        let row = Self::ALL.iter().find(|(known, _)| *known == code);
        row.map(|(_, fault)| *fault)
    }

    /// Returns the message for the operator about why the request was refused.
    pub fn message(self) -> Message {
        match self {
            Self::Exists => say::transfer_fault_exists(),
            Self::NotFound => say::transfer_fault_not_found(),
            Self::BadName => say::transfer_fault_name(),
            Self::NoRight => say::transfer_fault_no_right(),
            Self::SwitchOff => say::transfer_fault_switch_off(),
            Self::Full => say::transfer_fault_full(),
            Self::Busy => say::transfer_fault_busy(),
            Self::Damaged => say::transfer_fault_damaged(),
            Self::Sequence => say::transfer_fault_sequence(),
            Self::Content => say::transfer_fault_content(),
        }
    }
}
