//! Radius of the tool nose and direction of its imaginary tip ([`tip_direction`]).

use serde::{Deserialize, Serialize};

use crate::memory::ToolOffset;
use crate::units::{Point, tip_direction};

/// The active nose, as the last T word took it from the offset table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Nose {
    /// Nose radius, mm; a negative one exchanges the sides of G41 and G42.
    pub(crate) radius: f64,
    /// Number of the direction from the nose centre to the imaginary tip, 0 to 9.
    pub(crate) direction: u8,
}

impl Nose {
    /// Reads nose radius (R) and tip direction (T) from a row of the tool offset table.
    pub(crate) const fn from_offset(offset: &ToolOffset) -> Self {
        Self {
            radius: offset.r,
            direction: offset.t,
        }
    }

    /// Direction from the nose centre to the imaginary tip: -1, 0 or 1 in X and Z.
    pub(super) const fn tip_signs(self) -> Point {
        tip_direction(self.direction)
    }

    /// Displacement from the nose centre to the imaginary tip, mm. The sign of R is ignored.
    pub(super) fn tip_vector(self) -> Point {
        self.tip_signs() * self.radius.abs()
    }
}
