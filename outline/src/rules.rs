//! Which outlines a tool can follow: the direction of travel at each point.
//!
//! ```text
//!                  90°                 direction from -Z towards +X
//!                   |
//!       0°  <-------+                  G71: 0° to 90°, X and Z never turn back
//!            /                         contour with an insert: down to the angle that its
//!     -52°  /                          end edge clears, up to the entering angle of 93°
//! ```

use core::f64::consts::FRAC_PI_2;

use gsk_messages::{Message, say};
use gsk_units::Point;

use crate::piece::ProfilePiece;
use crate::profile::TurnedProfile;

/// Entering angle of the holders of profiling inserts, degrees.
pub const ENTERING_DEGREES: f64 = 93.0;
/// Greatest distance that a piece may turn back without counting: half of the least increment
/// of X.
const TOLERANCE_MM: f64 = 0.000_5;

/// What limits the directions of an outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CutRule {
    /// G71: X does not decrease and Z does not increase.
    Roughing,
    /// A finishing cut towards the chuck; with the corner angle of an insert, degrees, also what
    /// its edges clear.
    Finishing {
        /// The corner angle of the insert; `None`: Z alone must not turn back.
        insert: Option<f64>,
    },
}

impl CutRule {
    /// The least and greatest direction, radians from -Z towards +X.
    fn limits(self) -> (f64, f64) {
        match self {
            Self::Roughing => (0.0, FRAC_PI_2),
            Self::Finishing { insert: None } => (-FRAC_PI_2, FRAC_PI_2),
            Self::Finishing {
                insert: Some(angle),
            } => {
                let clears = end_clearance(angle).to_radians();
                (-clears, ENTERING_DEGREES.to_radians())
            }
        }
    }
}

/// The steepest descent that the end edge of an insert clears, degrees.
pub fn end_clearance(insert: f64) -> f64 {
    (180.0 - ENTERING_DEGREES - insert).max(0.0)
}

/// Where an outline breaks a [`CutRule`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionFault {
    /// The index of the piece.
    pub piece: usize,
    /// The point of the piece with the wrong direction.
    pub at: Point,
    /// The descent towards the axis, degrees; `None` if the piece turns back towards Z+.
    pub descent: Option<f64>,
}

impl CutRule {
    /// The first piece that turns back or descends more than the rule permits; `None` if none
    /// does.
    pub fn find_fault(self, pieces: &[ProfilePiece]) -> Option<DirectionFault> {
        let (least, greatest) = self.limits();
        (pieces.iter().enumerate()).find_map(|(index, piece)| {
            let (low, high) = direction_range(piece);
            let below = excess_depth(piece, least - low.angle);
            let above = excess_depth(piece, high.angle - greatest);
            if above > TOLERANCE_MM {
                return Some(DirectionFault {
                    piece: index,
                    at: high.at,
                    descent: None,
                });
            }
            (below > TOLERANCE_MM).then(|| DirectionFault {
                piece: index,
                at: low.at,
                descent: Some(-low.angle.to_degrees()),
            })
        })
    }
}

impl TurnedProfile {
    /// Checks the direction of each piece.
    ///
    /// # Errors
    /// The first piece that turns back or descends more than the rule permits.
    pub fn check_directions(&self, rule: CutRule) -> Result<(), Message> {
        let pieces: Vec<ProfilePiece> = self.pieces().copied().collect();
        let Some(fault) = rule.find_fault(&pieces) else {
            return Ok(());
        };
        let name = self.entity_name(&self.traced[fault.piece]);
        let Point { x, z } = fault.at;
        Err(match (rule, fault.descent) {
            (CutRule::Roughing, Some(_)) => say::outline_descends(name, x * 2.0, z),
            (
                CutRule::Finishing {
                    insert: Some(insert),
                },
                Some(descent),
            ) => {
                let clears = end_clearance(insert);
                say::outline_undercut(name, x * 2.0, z, descent, insert, clears)
            }
            _ => say::outline_turns_back(name, x * 2.0, z),
        })
    }
}

/// A direction of travel, radians from -Z towards +X, with the point that has it.
#[derive(Clone, Copy)]
struct TravelDirection {
    angle: f64,
    at: Point,
}

/// The least and the greatest direction of a piece.
fn direction_range(piece: &ProfilePiece) -> (TravelDirection, TravelDirection) {
    let middle = piece.direction_at(0.5);
    let angle = libm::atan2(middle.x, -middle.z);
    // Counter-clockwise in the plane is clockwise from -Z towards +X.
    let half = piece.sweep() / 2.0;
    let start = TravelDirection {
        angle: angle + half,
        at: piece.start,
    };
    let end = TravelDirection {
        angle: angle - half,
        at: piece.end,
    };
    if half < 0.0 {
        (start, end)
    } else {
        (end, start)
    }
}

/// How far a piece turns back if its direction exceeds a limit by an angle, mm.
fn excess_depth(piece: &ProfilePiece, excess: f64) -> f64 {
    if excess <= 0.0 {
        return 0.0;
    }
    let excess = excess.min(FRAC_PI_2);
    match piece.is_arc() {
        true => piece.radius() * (1.0 - libm::cos(excess.min(piece.sweep().abs()))),
        false => piece.length() * libm::sin(excess),
    }
}
