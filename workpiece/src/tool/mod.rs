//! Tools: what a person says of one, and the shape that follows from it.
//!
//! All shapes are relative to the point that the program moves, the imaginary tip of
//! the insert ([`gsk_units::tip_direction`]):
//!
//! ```text
//!            |    holder   |
//!            |____________ |
//!          main edge  /
//!            \       /        body towards +X and +Z: tip 3,
//!    feed <-  \_.---'         the others are its mirror images
//!             P   nose
//! ```

mod holder;
mod insert;
mod shape;

use serde::{Deserialize, Serialize};

use gsk_messages::{Message, say};
use gsk_units::{Point, tip_direction};

pub use holder::Holder;
pub(crate) use insert::within;
pub use insert::{Insert, Letter};
pub use shape::{BodyPart, Shape};

/// A tool as a person describes it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tool {
    /// The insert, or the drill.
    pub insert: Insert,
    /// Number of the direction from the nose to the imaginary tip, 0 to 9.
    pub tip: u8,
    /// What carries it.
    #[serde(default)]
    pub holder: Holder,
}

impl Tool {
    /// A right-hand turning tool: an 80° insert, entering angle 95°, nose 0.8 mm.
    pub const fn turning() -> Self {
        Self {
            insert: Insert::Turning {
                letter: Letter::C,
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

    /// A boring bar with a 55° insert, nose 0.4 mm.
    pub const fn boring() -> Self {
        Self {
            insert: Insert::Turning {
                letter: Letter::D,
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

    /// A grooving tool; its left corner is programmed.
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

    /// A threading tool for outside threads.
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

    /// A twist drill.
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

    /// Radius of the nose, mm.
    pub const fn nose(&self) -> f64 {
        match self.insert {
            Insert::Turning {
                letter: Letter::R,
                size,
                ..
            } => size / 2.0,
            Insert::Turning { nose, .. }
            | Insert::Grooving { nose, .. }
            | Insert::Threading { nose, .. } => nose,
            Insert::Drill { .. } => 0.0,
        }
    }

    /// From the imaginary tip to the centre of the nose, mm.
    pub fn center(&self) -> Point {
        -(tip_direction(self.tip) * self.nose())
    }

    /// Whether it cuts from the inside: its body lies towards the spindle axis.
    pub const fn is_internal(&self) -> bool {
        matches!(self.tip, 1 | 2 | 6)
    }

    /// Whether its lengths and angles make a tool.
    ///
    /// # Errors
    /// The rule that is broken.
    pub fn check(&self) -> Result<(), Message> {
        within(f64::from(self.tip), 0.0, 9.0, say::tool_word_tip())?;
        self.insert.check()?;
        self.holder.check()
    }
}
