//! Tool holders: shanks and bars.

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use super::insert::check_range;

/// A tool holder. The turret begins at the end of the holder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Holder {
    /// No holder: the collision check covers the insert only.
    #[default]
    None,
    /// A square shank across the spindle axis.
    Shank {
        /// Width of the shank along Z, mm.
        width: f64,
        /// Distance from the tool tip to the turret, mm.
        length: f64,
    },
    /// A round bar along the spindle axis.
    Bar {
        /// Diameter of the bar, mm.
        diameter: f64,
        /// Distance from the tool tip to the turret, mm.
        length: f64,
    },
}

impl Holder {
    pub(super) fn check(&self) -> Result<(), Message> {
        let (size, size_name, length) = match *self {
            Self::None => return Ok(()),
            Self::Shank { width, length } => (width, say::tool_word_holder_width(), length),
            Self::Bar { diameter, length } => (diameter, say::tool_word_holder_diameter(), length),
        };
        check_range(size, 2.0, 100.0, size_name)?;
        check_range(length, 5.0, 500.0, say::tool_word_holder_length())
    }
}
