//! The ways a program can end.

use gsk_core::preview;
use serde::{Serialize, Serializer};

/// How a program ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// M30.
    M30,
    /// M02, on models that have it.
    M02,
    /// M99 in the main program.
    M99,
    /// The end of the text.
    Text,
    /// An alarm, or a message of the ladder.
    Alarm,
    /// Cycle start was refused.
    Refused,
    /// It stopped at a board, and no operator was there to press cycle start.
    Stop,
    /// The end was requested: Ctrl-C, `kill`.
    Asked,
    /// A tool hit something, and the run was set to end then.
    Collision,
    /// It did not end within the limits.
    Limit,
}

impl End {
    /// The name in the JSON of a report.
    pub const fn name(self) -> &'static str {
        match self {
            Self::M30 => "M30",
            Self::M02 => "M02",
            Self::M99 => "M99",
            Self::Text => "EOF",
            Self::Alarm => "alarm",
            Self::Refused => "refused",
            Self::Stop => "stop",
            Self::Asked => "ended",
            Self::Collision => "collision",
            Self::Limit => "limit",
        }
    }

    /// Whether the program reached its own end.
    pub(crate) const fn is_own(self) -> bool {
        matches!(self, Self::M30 | Self::M02 | Self::M99 | Self::Text)
    }
}

impl Serialize for End {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl From<preview::End> for End {
    fn from(end: preview::End) -> Self {
        match end {
            preview::End::M30 => Self::M30,
            preview::End::M02 => Self::M02,
            preview::End::M99 => Self::M99,
            preview::End::Text => Self::Text,
            preview::End::Alarm => Self::Alarm,
            preview::End::Limit => Self::Limit,
        }
    }
}
