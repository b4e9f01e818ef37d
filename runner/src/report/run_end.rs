//! The ways a program can end.

use gsk_core::preview;
use serde::{Serialize, Serializer};

/// The reason for which a program run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunEnd {
    /// M30 ended the program.
    M30,
    /// M02 ended the program, on models that have it.
    M02,
    /// M99 ended the main program.
    M99,
    /// The text of the program ended without an M30.
    Text,
    /// An alarm, or a message of the PLC ladder, stopped the program.
    Alarm,
    /// Cycle start had no effect: the control refused it.
    Refused,
    /// The program stopped on a board, and no operator was at the terminal to continue it.
    Stop,
    /// The user requested the end: Ctrl-C or `kill`.
    Requested,
    /// A tool collided, and the run was set to end then.
    Collision,
    /// The run reached the location at which it was set to end.
    Location,
    /// A cut above the limits stalled the spindle or loosened the stock of the simulated lathe.
    Overload,
    /// The program did not end within the time or part limit.
    Limit,
}

impl RunEnd {
    /// Returns the name of the end in the JSON of a report.
    pub const fn name(self) -> &'static str {
        match self {
            Self::M30 => "M30",
            Self::M02 => "M02",
            Self::M99 => "M99",
            Self::Text => "EOF",
            Self::Alarm => "alarm",
            Self::Refused => "refused",
            Self::Stop => "stop",
            Self::Requested => "ended",
            Self::Collision => "collision",
            Self::Location => "until",
            Self::Overload => "overload",
            Self::Limit => "limit",
        }
    }

    /// Whether the program reached its own end, M30, M02, M99 or the end of the text, or the
    /// location at which it was set to end.
    pub(crate) const fn is_expected_end(self) -> bool {
        matches!(
            self,
            Self::M30 | Self::M02 | Self::M99 | Self::Text | Self::Location
        )
    }
}

impl Serialize for RunEnd {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl From<preview::PreviewEnd> for RunEnd {
    fn from(end: preview::PreviewEnd) -> Self {
        match end {
            preview::PreviewEnd::M30 => Self::M30,
            preview::PreviewEnd::M02 => Self::M02,
            preview::PreviewEnd::M99 => Self::M99,
            preview::PreviewEnd::Text => Self::Text,
            preview::PreviewEnd::Alarm => Self::Alarm,
            preview::PreviewEnd::Limit => Self::Limit,
        }
    }
}
