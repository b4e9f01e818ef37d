//! What carries an insert.

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use super::insert::within;

/// A holder; the turret begins where it ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Holder {
    /// None that could touch anything.
    #[default]
    None,
    /// A square shank across the spindle axis.
    Shank {
        /// Its width along Z, mm.
        width: f64,
        /// From the tip to the turret, mm.
        length: f64,
    },
    /// A round bar along the spindle axis.
    Bar {
        /// Its diameter, mm.
        diameter: f64,
        /// From the tip to the turret, mm.
        length: f64,
    },
}

impl Holder {
    pub(super) fn check(&self) -> Result<(), Message> {
        let (across, what, length) = match *self {
            Self::None => return Ok(()),
            Self::Shank { width, length } => (width, say::tool_word_holder_width(), length),
            Self::Bar { diameter, length } => (diameter, say::tool_word_holder_diameter(), length),
        };
        within(across, 2.0, 100.0, what)?;
        within(length, 5.0, 500.0, say::tool_word_holder_length())
    }
}
