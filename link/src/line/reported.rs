//! The properties that a line board reports during the opening.

use gsk_messages::{Message, say};
use thiserror::Error;

use super::fluidnc_config::FluidNcConfig;

/// The reason for which the link does not support a board.
#[derive(Debug, Error)]
#[error("{}", self.message())]
pub(super) enum Unsupported {
    /// The board's answer to `$I` contains no version: its firmware is too old, or not Grbl.
    NoVersion,
    /// The firmware with this name is unknown to the link.
    Firmware(String),
    /// This Grbl version is older than 1.1f.
    Old(String),
    /// The board has no axis X or no axis Z; its axes have these letters.
    Axes(String),
    /// The sizes of motion queue and receive buffer are missing or too small in this item or line
    /// of the board.
    NoSizes(&'static str),
}

impl Unsupported {
    /// Returns the message that explains why the board is not supported.
    pub(super) fn message(&self) -> Message {
        match self {
            Self::NoVersion => say::board_version_missing(say::board_is_another()),
            Self::Firmware(firmware) => say::board_firmware_unknown(firmware),
            Self::Old(version) => say::board_grbl_too_old(version),
            Self::Axes(axes) => say::board_axes_wrong(axes),
            Self::NoSizes(source) => say::board_sizes_missing(source),
        }
    }
}

/// The properties that the board has reported so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Reported {
    pub(super) version: String,
    pub(super) firmware: Option<String>,
    pub(super) axes: Option<String>,
    /// Number and value of each numbered setting, in the order of the reports.
    pub(super) settings: Vec<(u16, f64)>,
    /// Path and value of each named setting of FluidNC.
    pub(super) items: FluidNcConfig,
}

impl Reported {
    /// Returns the last reported value of the setting with this number; `None` without one.
    pub(super) fn setting(&self, number: u16) -> Option<f64> {
        let mut newest_first = self.settings.iter().rev();
        newest_first
            .find(|(reported, _)| *reported == number)
            .map(|(_, value)| *value)
    }

    /// Extracts name and version of FluidNC from a version report like `4.0 FluidNC v4.0.4
    /// (esp32-wifi) :`; `None` for another firmware.
    pub(super) fn fluidnc(&self) -> Option<&str> {
        let (_, name) = self.version.split_once(' ')?;
        let name = name.split('(').next()?.trim();
        name.starts_with("FluidNC").then_some(name)
    }
}
