//! What a board says of itself while the link is opened.

use thiserror::Error;

use super::fluidnc_config::FluidNcConfig;
use crate::ANOTHER;

/// Why a board is not one that the link can drive.
#[derive(Debug, Error)]
pub(super) enum Unsupported {
    /// It is older than the answer to `$I` that tells, or no Grbl at all.
    #[error(
        "the board does not say who it is ([VER:…]), as Grbl older than 1.1f does not; {ANOTHER}"
    )]
    NoVersion,
    /// Another firmware.
    #[error("firmware {0} is not known")]
    Firmware(String),
    /// Version of a Grbl that is too old.
    #[error("Grbl {0} is older than 1.1f")]
    Old(String),
    /// Letters of its axes.
    #[error("the board has axes {0}; X and Z are needed")]
    Axes(String),
    /// Where it should have said what its queue and its receive buffer hold.
    #[error("the board does not say how much it can hold ({0})")]
    NoSizes(&'static str),
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
        let mut told = self.settings.iter().rev();
        told.find(|(told, _)| *told == number)
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
