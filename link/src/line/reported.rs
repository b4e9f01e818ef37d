//! What a board says of itself while the link is opened.

use gsk_messages::{Message, say};
use thiserror::Error;

use super::fluidnc_config::FluidNcConfig;

/// Why a board is not one that the link can drive.
#[derive(Debug, Error)]
#[error("{}", self.message())]
pub(super) enum Unsupported {
    /// It is older than the answer to `$I` that tells, or no Grbl at all.
    NoVersion,
    /// Another firmware.
    Firmware(String),
    /// Version of a Grbl that is too old.
    Old(String),
    /// Letters of its axes.
    Axes(String),
    /// Where it should have said what its queue and its receive buffer hold.
    NoSizes(&'static str),
}

impl Unsupported {
    /// In words.
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

/// What the board has reported of itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Reported {
    pub(super) version: String,
    pub(super) firmware: Option<String>,
    pub(super) axes: Option<String>,
    /// Settings with numbers, and with names.
    pub(super) settings: Vec<(u16, f64)>,
    pub(super) items: FluidNcConfig,
}

impl Reported {
    /// A setting as it was last reported.
    pub(super) fn setting(&self, number: u16) -> Option<f64> {
        let mut newest_first = self.settings.iter().rev();
        newest_first
            .find(|(reported, _)| *reported == number)
            .map(|(_, value)| *value)
    }

    /// Name and version out of `4.0 FluidNC v4.0.4 (esp32-wifi) :`, the version that such a
    /// board reports.
    pub(super) fn fluidnc(&self) -> Option<&str> {
        let (_, name) = self.version.split_once(' ')?;
        let name = name.split('(').next()?.trim();
        name.starts_with("FluidNC").then_some(name)
    }
}
