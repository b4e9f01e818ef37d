//! The nose of the tool: its radius and where the imaginary tip lies.
//!
//! ```text
//!   X ^    2   6   1        The number says in which direction the imaginary
//!     |      \ | /          tip lies, seen from the centre of the nose;
//!     |    7 - o - 5        0 and 9: the tip is the centre.
//!     |      / | \
//!     |    3   8   4        tip = centre + |R| * direction
//!     +--------------> Z
//! ```

use serde::{Deserialize, Serialize};

use crate::memory::ToolOffset;
use crate::units::Point;

/// The nose in force: what the last T took from the offset table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Nose {
    /// Radius, mm; a negative one exchanges the sides of G41 and G42.
    pub(crate) radius: f64,
    /// Direction of the imaginary tip, 0 to 9.
    pub(crate) direction: u8,
}

impl Nose {
    /// The nose of a row of the offset table.
    pub(crate) const fn of(offset: &ToolOffset) -> Self {
        Self {
            radius: offset.r,
            direction: offset.t,
        }
    }

    /// The signs of the direction from the centre to the imaginary tip.
    pub(super) const fn direction(self) -> Point {
        let (z, x) = match self.direction {
            1 => (1.0, 1.0),
            2 => (-1.0, 1.0),
            3 => (-1.0, -1.0),
            4 => (1.0, -1.0),
            5 => (1.0, 0.0),
            6 => (0.0, 1.0),
            7 => (-1.0, 0.0),
            8 => (0.0, -1.0),
            _ => (0.0, 0.0),
        };
        Point::new(x, z)
    }

    /// From the centre to the imaginary tip, mm. The sign of R has no part in it.
    pub(super) fn tip(self) -> Point {
        self.direction() * self.radius.abs()
    }
}
