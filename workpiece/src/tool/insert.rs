//! Cutting inserts and drills.

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

/// The cutting part of a tool: an insert or a drill.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Insert {
    /// An indexable insert for turning, facing and boring.
    Turning {
        /// The form of the insert, by its letter in ISO 1832.
        letter: InsertLetter,
        /// Entering angle between the main edge and the feed direction, degrees. It has no
        /// effect on round inserts and with tips 5 to 9: those tools are symmetric.
        #[serde(default = "right_angle")]
        entering: f64,
        /// Diameter of the circle inscribed in the insert, mm.
        size: f64,
        /// Nose radius of the insert, mm.
        nose: f64,
    },
    /// A parting or grooving insert.
    Grooving {
        /// Width of the cutting edge, mm.
        width: f64,
        /// Radius of both corners of the cutting edge, mm.
        nose: f64,
        /// Greatest cutting depth in front of the holder, mm.
        reach: f64,
    },
    /// A threading insert. The programmed point is the middle of its tip.
    Threading {
        /// Angle between the flanks of the thread, degrees.
        angle: f64,
        /// Nose radius of the insert, mm.
        nose: f64,
        /// Height of the thread profile, mm.
        height: f64,
    },
    /// A drill on the spindle axis.
    Drill {
        /// Diameter of the drill, mm.
        diameter: f64,
        /// Point angle of the drill, degrees; 180 is flat.
        point: f64,
        /// Length of the flutes of the drill, mm.
        reach: f64,
    },
}

/// Multiple of the limits for roughing at which a turning insert breaks.
const BREAKING_SHARE: f64 = 1.5;

/// Cutting force of a grooving insert as a multiple of that of outside turning with the same chip,
/// which cannot spread in the groove. The constants of the handbook by Kosilova and Meshcheryakov
/// (table 22) give 1.28 for a blade of 5 mm, 1.36 for 4 mm and 1.65 for 2 mm at a feed of 0.1 mm
/// and 28 m/min.
const GROOVING_FORCE: f64 = 1.3;

const fn right_angle() -> f64 {
    90.0
}

/// The form of a turning insert, by its letter in ISO 1832.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum InsertLetter {
    /// Letter C: rhombic insert, 80°.
    C,
    /// Letter D: rhombic insert, 55°.
    D,
    /// Letter V: rhombic insert, 35°.
    V,
    /// Letter W: trigon insert, 80°.
    W,
    /// Letter T: triangular insert, 60°.
    T,
    /// Letter S: square insert.
    S,
    /// Letter R: round insert.
    R,
}

impl InsertLetter {
    /// All letters, in the order in which the tool dialog lists them.
    pub const ALL: [Self; 7] = [
        Self::C,
        Self::D,
        Self::V,
        Self::W,
        Self::T,
        Self::S,
        Self::R,
    ];

    /// Returns the corner angle of the insert, degrees.
    pub const fn corner(self) -> f64 {
        match self {
            Self::C | Self::W => 80.0,
            Self::D => 55.0,
            Self::V => 35.0,
            Self::T => 60.0,
            Self::S | Self::R => 90.0,
        }
    }

    /// The edge length of the insert from the diameter of its inscribed circle (ISO 1832), mm.
    pub fn edge_length_mm(self, size: f64) -> f64 {
        let sine = |degrees: f64| libm::sin(degrees * core::f64::consts::PI / 180.0);
        match self {
            Self::C | Self::D | Self::V => size / sine(self.corner()),
            // tan 60°
            Self::T => size * 1.732_050_807_568_877_2,
            Self::W => size * 0.684,
            Self::S | Self::R => size,
        }
    }
}

impl Insert {
    /// Greatest length of a turning insert's edge that may cut in roughing, mm; `None` for other
    /// inserts. The shares are a common rule of thumb for roughing; a maker's catalogue may differ.
    pub fn greatest_edge_mm(&self) -> Option<f64> {
        let Self::Turning { letter, size, .. } = *self else {
            return None;
        };
        let share = match letter {
            InsertLetter::C | InsertLetter::S => 2.0 / 3.0,
            InsertLetter::D | InsertLetter::T => 0.5,
            InsertLetter::V | InsertLetter::W => 0.25,
            InsertLetter::R => 0.4,
        };
        Some(share * letter.edge_length_mm(size))
    }

    /// Greatest feed per revolution of a turning insert with a nose, mm; `None` for other
    /// inserts: two thirds of the nose radius, a common rule of thumb. Some makers allow less:
    /// 1/1.6 of the radius for C and S, 1/2.5 for D and T.
    pub fn greatest_feed_mm(&self) -> Option<f64> {
        match *self {
            Self::Turning { letter, nose, .. } if letter != InsertLetter::R && nose > 0.0 => {
                Some(nose * 2.0 / 3.0)
            }
            _ => None,
        }
    }

    /// The cutting force as a multiple of that of outside turning with the same chip.
    pub const fn force_factor(&self) -> f64 {
        match self {
            Self::Grooving { .. } => GROOVING_FORCE,
            Self::Turning { .. } | Self::Threading { .. } | Self::Drill { .. } => 1.0,
        }
    }

    /// Length of the edge in the material at which the insert breaks, mm; `None` without a limit.
    pub fn breaking_edge_mm(&self) -> Option<f64> {
        Some(BREAKING_SHARE * self.greatest_edge_mm()?)
    }

    /// Feed per revolution at which the insert or drill breaks, mm; `None` without a limit. A
    /// grooving insert of 2 to 3 mm is fed up to 0.05 times its width (Kyocera), a twist drill
    /// 0.018 times its diameter (Machinery's Handbook, 27th edition, p. 1029): each bears three
    /// times this.
    pub fn breaking_feed_mm(&self) -> Option<f64> {
        match *self {
            Self::Grooving { width, .. } => Some(0.15 * width),
            Self::Drill { diameter, .. } => Some(0.054 * diameter),
            Self::Turning { .. } | Self::Threading { .. } => {
                Some(BREAKING_SHARE * self.greatest_feed_mm()?)
            }
        }
    }

    pub(super) fn check(&self) -> Result<(), Message> {
        match *self {
            Self::Turning {
                letter,
                entering,
                size,
                nose,
            } => {
                check_range(size, 2.0, 60.0, say::tool_word_size())?;
                if letter == InsertLetter::R {
                    return Ok(());
                }
                check_range(nose, 0.0, size / 4.0, say::tool_word_nose())?;
                check_range(
                    entering,
                    30.0,
                    178.0 - letter.corner(),
                    say::tool_word_entering(),
                )
            }
            Self::Grooving { width, nose, reach } => {
                check_range(width, 0.3, 30.0, say::tool_word_width())?;
                check_range(nose, 0.0, width / 2.0, say::tool_word_nose())?;
                check_range(reach, 1.0, 200.0, say::tool_word_reach())
            }
            Self::Threading {
                angle,
                nose,
                height,
            } => {
                check_range(angle, 10.0, 100.0, say::tool_word_flanks())?;
                check_range(height, 0.2, 30.0, say::tool_word_height())?;
                check_range(nose, 0.0, height / 4.0, say::tool_word_nose())
            }
            Self::Drill {
                diameter,
                point,
                reach,
            } => {
                check_range(diameter, 0.3, 200.0, say::tool_word_diameter())?;
                check_range(point, 60.0, 180.0, say::tool_word_point())?;
                check_range(reach, 1.0, 1000.0, say::tool_word_reach())
            }
        }
    }
}

/// Checks that a value is between `least` and `most`; NaN is an error. `name` names the value
/// in the error.
pub(crate) fn check_range(value: f64, least: f64, most: f64, name: Message) -> Result<(), Message> {
    if (least..=most).contains(&value) {
        Ok(())
    } else {
        Err(say::tool_value_out_of_range(name, value, least, most))
    }
}
