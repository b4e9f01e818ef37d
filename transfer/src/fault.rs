//! Why a side refuses what the other one asks for.

use gsk_messages::{Message, say};

/// Why something is refused, as it goes over the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum Fault {
    /// There is a file of this name already.
    Exists,
    /// There is no file of this name.
    NotFound,
    /// A name that the control cannot have.
    BadName,
    /// The level of the password, or a lock, stands against it.
    NoRight,
    /// 程序开关 or 参数开关 is off.
    SwitchOff,
    /// No room for it.
    Full,
    /// The control machines, moves, or is busy with another transfer.
    Busy,
    /// What has arrived is damaged: to be sent once more.
    Damaged,
    /// Not what comes now: no connection, or no file that this belongs to.
    Sequence,
    /// What the file holds is not what its name promises.
    Content,
}

impl Fault {
    /// All of them, with their codes.
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

    /// Its code on the wire, 1–10.
    pub fn code(self) -> u8 {
        let row = Self::ALL.iter().find(|(_, fault)| *fault == self);
        row.map_or(0, |(code, _)| *code)
    }

    /// From its code; none for one that nobody knows.
    pub fn of(code: u8) -> Option<Self> {
        let row = Self::ALL.iter().find(|(known, _)| *known == code);
        row.map(|(_, fault)| *fault)
    }

    /// What is said of it.
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
