//! Inserts and drills.

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

/// What cuts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Insert {
    /// An indexable insert for turning, facing and boring.
    Turning {
        /// Its form by the letter of ISO 1832.
        letter: Letter,
        /// Entering angle between the main edge and the feed, degrees; not for round
        /// ones and for tips 5 to 9, which stand even.
        #[serde(default = "right_angle")]
        entering: f64,
        /// Diameter of the inscribed circle, mm.
        size: f64,
        /// Nose radius, mm.
        nose: f64,
    },
    /// A parting or grooving insert.
    Grooving {
        /// Width, mm.
        width: f64,
        /// Radius of its corners, mm.
        nose: f64,
        /// How deep it reaches before the holder, mm.
        reach: f64,
    },
    /// A threading insert; the middle of its point is programmed.
    Threading {
        /// Angle between its flanks, degrees.
        angle: f64,
        /// Radius of its point, mm.
        nose: f64,
        /// Height of its profile, mm.
        height: f64,
    },
    /// A drill on the spindle axis.
    Drill {
        /// Diameter, mm.
        diameter: f64,
        /// Angle of its point, degrees; 180 is flat.
        point: f64,
        /// Length of its flutes, mm.
        reach: f64,
    },
}

const fn right_angle() -> f64 {
    90.0
}

/// Forms of turning inserts (ISO 1832).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Letter {
    /// Rhombic, 80°.
    C,
    /// Rhombic, 55°.
    D,
    /// Rhombic, 35°.
    V,
    /// Trigon, 80°.
    W,
    /// Triangular, 60°.
    T,
    /// Square.
    S,
    /// Round.
    R,
}

impl Letter {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::C,
        Self::D,
        Self::V,
        Self::W,
        Self::T,
        Self::S,
        Self::R,
    ];

    /// The angle at its corner, degrees.
    pub const fn corner(self) -> f64 {
        match self {
            Self::C | Self::W => 80.0,
            Self::D => 55.0,
            Self::V => 35.0,
            Self::T => 60.0,
            Self::S | Self::R => 90.0,
        }
    }
}

impl Insert {
    pub(super) fn check(&self) -> Result<(), Message> {
        match *self {
            Self::Turning {
                letter,
                entering,
                size,
                nose,
            } => {
                within(size, 2.0, 60.0, say::tool_word_size())?;
                if letter == Letter::R {
                    return Ok(());
                }
                within(nose, 0.0, size / 4.0, say::tool_word_nose())?;
                within(
                    entering,
                    30.0,
                    178.0 - letter.corner(),
                    say::tool_word_entering(),
                )
            }
            Self::Grooving { width, nose, reach } => {
                within(width, 0.3, 30.0, say::tool_word_width())?;
                within(nose, 0.0, width / 2.0, say::tool_word_nose())?;
                within(reach, 1.0, 200.0, say::tool_word_reach())
            }
            Self::Threading {
                angle,
                nose,
                height,
            } => {
                within(angle, 10.0, 100.0, say::tool_word_flanks())?;
                within(height, 0.2, 30.0, say::tool_word_height())?;
                within(nose, 0.0, height / 4.0, say::tool_word_nose())
            }
            Self::Drill {
                diameter,
                point,
                reach,
            } => {
                within(diameter, 0.3, 200.0, say::tool_word_diameter())?;
                within(point, 60.0, 180.0, say::tool_word_point())?;
                within(reach, 1.0, 1000.0, say::tool_word_reach())
            }
        }
    }
}

/// Whether a value lies in its range; not a number lies in none.
pub(crate) fn within(value: f64, least: f64, most: f64, what: Message) -> Result<(), Message> {
    if (least..=most).contains(&value) {
        Ok(())
    } else {
        Err(say::tool_value_out_of_range(what, value, least, most))
    }
}
