//! Tools: their description in a job, and the shape computed from it.
//!
//! All shapes are relative to the programmed point, the imaginary tip of the insert
//! ([`gsk_units::tip_direction`]):
//!
//! ```text
//!            |    holder   |
//!            |____________ |
//!          main edge  /
//!            \       /        tip 3: the body is at +X and +Z;
//!    feed <-  \_.---'         the other tips are mirror images
//!             P   nose
//! ```

mod holder;
mod insert;
mod shape;

use serde::{Deserialize, Serialize};

use gsk_messages::{Message, say};
use gsk_units::{Point, tip_direction};

pub use holder::Holder;
pub(crate) use insert::check_range;
pub use insert::{Insert, InsertLetter};
pub use shape::{BodyPart, ToolShape};

/// A tool, described by its catalogue dimensions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tool {
    /// The cutting part: an insert or a drill.
    pub insert: Insert,
    /// Tip number of the control, 0 to 9. It gives the direction from the nose centre to the
    /// imaginary tip.
    pub tip: u8,
    /// The holder that carries the insert.
    #[serde(default)]
    pub holder: Holder,
}

impl Tool {
    /// Creates a right-hand turning tool: 80° insert, entering angle 95°, nose radius 0.8 mm.
    pub const fn turning() -> Self {
        Self {
            insert: Insert::Turning {
                letter: InsertLetter::C,
                entering: 95.0,
                size: 12.7,
                nose: 0.8,
            },
            tip: 3,
            holder: Holder::Shank {
                width: 20.0,
                length: 60.0,
            },
        }
    }

    /// Creates a boring bar of 12 mm: 55° insert, entering angle 93°, nose radius 0.4 mm.
    pub const fn boring() -> Self {
        Self {
            insert: Insert::Turning {
                letter: InsertLetter::D,
                entering: 93.0,
                size: 6.35,
                nose: 0.4,
            },
            tip: 2,
            holder: Holder::Bar {
                diameter: 12.0,
                length: 80.0,
            },
        }
    }

    /// Creates a grooving tool of `width`, mm. The programmed point is its left corner.
    pub const fn grooving(width: f64) -> Self {
        Self {
            insert: Insert::Grooving {
                width,
                nose: 0.1,
                reach: 16.0,
            },
            tip: 3,
            holder: Holder::Shank {
                width: 20.0,
                length: 60.0,
            },
        }
    }

    /// Creates a tool for external threads with a flank angle, degrees.
    pub const fn threading(angle: f64) -> Self {
        Self {
            insert: Insert::Threading {
                angle,
                nose: 0.05,
                height: 4.0,
            },
            tip: 8,
            holder: Holder::Shank {
                width: 20.0,
                length: 60.0,
            },
        }
    }

    /// Creates a twist drill of `diameter`, mm, with a point of 118°.
    pub const fn drill(diameter: f64) -> Self {
        Self {
            insert: Insert::Drill {
                diameter,
                point: 118.0,
                reach: 80.0,
            },
            tip: 7,
            holder: Holder::None,
        }
    }

    /// Returns the nose radius of the insert, mm; 0 for a drill.
    pub const fn nose(&self) -> f64 {
        match self.insert {
            Insert::Turning {
                letter: InsertLetter::R,
                size,
                ..
            } => size / 2.0,
            Insert::Turning { nose, .. }
            | Insert::Grooving { nose, .. }
            | Insert::Threading { nose, .. } => nose,
            Insert::Drill { .. } => 0.0,
        }
    }

    /// The vector from the imaginary tip to the centre of the nose, mm; X is a radius.
    pub fn center(&self) -> Point {
        -(tip_direction(self.tip) * self.nose())
    }

    /// Returns the number of cutting edges that share the feed of a revolution: two lips of a
    /// drill, one edge of any other tool.
    pub const fn edge_count(&self) -> u8 {
        match self.insert {
            Insert::Drill { .. } => 2,
            _ => 1,
        }
    }

    /// Whether the tool cuts bores: its body is nearer to the spindle axis than its tip.
    pub const fn is_internal(&self) -> bool {
        matches!(self.tip, 1 | 2 | 6)
    }

    /// Checks that all lengths and angles are in their ranges.
    ///
    /// # Errors
    /// The first value out of range.
    pub fn check(&self) -> Result<(), Message> {
        check_range(f64::from(self.tip), 0.0, 9.0, say::tool_word_tip())?;
        self.insert.check()?;
        self.holder.check()
    }
}
