//! Geometry of a programmed move.
//!
//! ```text
//!     line                          arc, turn +1 counter-clockwise
//!     start o---entry/exit--> o     start o--.         exit ^
//!                                              `.  entry    |
//!                                       center +  `o end----'
//! ```

use core::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use super::fault::CompensationFault;
use super::plane::sweep;
use crate::units::Point;

/// Greatest distance of two points that count as the same, mm.
pub(super) const SAME_POINT_MM: f64 = 1e-7;
/// Greatest distance of the centre of an arc from an end of the arc at which it counts as on that
/// end, mm.
const ON_POINT_MM: f64 = 0.0005;
/// Greatest distance of an end point from the circle of its arc, mm.
pub(crate) const OFF_CIRCLE_MM: f64 = 0.010;
/// Difference of the radii at the ends of an arc below which its radius counts as constant, mm.
const ON_CIRCLE_MM: f64 = 1e-10;
/// Greatest excess of the nose radius over the radius of an inner arc, mm: rounding both ends and
/// the centre to 0.001 mm has this effect.
const ROUNDING_SHORTAGE_MM: f64 = 0.0018;
/// The nose fills an inner arc whose radius exceeds the nose radius by less than this, mm.
const FILLED_ARC_MM: f64 = 0.002;
/// Chord length below which an arc is run as a straight line, mm: rounding could reverse the arc.
const SHORT_ARC_MM: f64 = 0.002;

/// Greatest sweep, rad, of an inner arc in which a larger nose can rest.
const WIDE_SWEEP_RAD: f64 = 0.9 * PI;

/// A line or an arc, with the directions of travel at its ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct ContourSegment {
    pub(super) start: Point,
    pub(super) end: Point,
    /// Direction of travel at the start, a unit vector.
    pub(super) entry: Point,
    /// Direction of travel at the end, a unit vector.
    pub(super) exit: Point,
    pub(super) circle: Option<Circle>,
}

/// The circle of an arc, and its sense of rotation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Circle {
    pub(super) center: Point,
    /// Distance of the centre from the start of the arc, mm. The radius changes linearly along
    /// the arc if it differs from `last_radius`.
    pub(super) radius: f64,
    /// Distance of the centre from the end of the arc, mm.
    pub(super) last_radius: f64,
    /// Direction of rotation: +1 counter-clockwise, -1 clockwise.
    pub(super) turn: f64,
}

/// Whether the distance of two points is at most [`SAME_POINT_MM`].
#[inline]
pub(super) fn are_same(one: Point, other: Point) -> bool {
    let between = other - one;
    between.dot(between) <= SAME_POINT_MM * SAME_POINT_MM
}

impl ContourSegment {
    /// Creates a straight move, with its ends in mm; an error if they are the same point.
    pub(super) fn line(start: Point, end: Point) -> Result<Self, CompensationFault> {
        let along = (end - start)
            .unit()
            .filter(|_| !are_same(start, end))
            .ok_or(CompensationFault::SamePoint)?;
        Ok(Self {
            start,
            end,
            entry: along,
            exit: along,
            circle: None,
        })
    }

    /// Creates an arc about `center`, mm; an error if the centre is on an end or an end is off the
    /// circle.
    pub(super) fn arc(
        start: Point,
        end: Point,
        center: Point,
        clockwise: bool,
    ) -> Result<Self, CompensationFault> {
        let turn = if clockwise { -1.0 } else { 1.0 };
        let (first, last) = (start - center, end - center);
        check_arc(first.length(), last.length())?;
        let entry = first.unit().ok_or(CompensationFault::CenterAtStart)?;
        let exit = last.unit().ok_or(CompensationFault::CenterAtEnd)?;
        Ok(Self {
            start,
            end,
            entry: entry.left() * turn,
            exit: exit.left() * turn,
            circle: Some(Circle {
                center,
                radius: first.length(),
                last_radius: last.length(),
                turn,
            }),
        })
    }

    /// The angle that the move sweeps, rad, up to a full turn; 0 for a line.
    pub(super) fn sweep(&self) -> f64 {
        let Some(circle) = &self.circle else {
            return 0.0;
        };
        let (first, last) = (self.start - circle.center, self.end - circle.center);
        let angle = sweep(first, last, circle.turn);
        if angle <= 0.0 { TAU } else { angle }
    }

    /// The radius of an arc in the direction `direction` from its centre, mm. Outside the
    /// sweep it is the radius at the closer end.
    pub(super) fn radius_toward(&self, circle: &Circle, direction: Point) -> f64 {
        if (circle.last_radius - circle.radius).abs() < ON_CIRCLE_MM {
            return circle.radius;
        }
        let whole = self.sweep();
        let angle = sweep(self.start - circle.center, direction, circle.turn);
        let part = if angle <= whole {
            angle / whole
        } else if angle - whole < TAU - angle {
            1.0
        } else {
            0.0
        };
        circle.radius + (circle.last_radius - circle.radius) * part
    }

    /// The centre, mm, of a nose that fills this inner arc; `None` if the nose does not fill it. A
    /// nose as large as the arc rests on the centre of the arc, a larger nose above the middle of
    /// the arc, so that it cuts into neither end. `rho` is the nose radius, positive on the left,
    /// mm.
    ///
    /// ```text
    ///   start o    V    o end       the shortage / cos (sweep / 2) from the
    ///          `.  +  .'            centre + to V
    ///            `---'
    /// ```
    pub(super) fn rest_center(&self, rho: f64) -> Option<Point> {
        let circle = self.circle.as_ref()?;
        let shortage = circle.shortage(rho);
        if shortage < -FILLED_ARC_MM || self.sweep() > WIDE_SWEEP_RAD {
            return None;
        }
        let arm = |end: Point| (end - circle.center).unit();
        let to_middle = (arm(self.start)? + arm(self.end)?) * 0.5;
        let above = to_middle.unit()? * (shortage.max(0.0) / to_middle.length());
        Some(circle.center - above)
    }

    pub(super) fn chord_length(&self) -> f64 {
        (self.end - self.start).length()
    }
}

impl Circle {
    /// The radius of the nose-centre path, mm, where the arc has the radius `radius`. The path
    /// is `rho` to the left of the arc.
    pub(super) fn path_radius(&self, radius: f64, rho: f64) -> f64 {
        (radius - self.turn * rho).max(0.0)
    }

    /// Excess of the nose radius over the radius of this arc, mm, if the nose centre is `rho` to
    /// the left, mm; negative if the nose is smaller.
    fn shortage(&self, rho: f64) -> f64 {
        self.turn * rho - self.radius.min(self.last_radius)
    }

    /// Fails if the nose, whose centre is `rho` to the left, mm, is too large for this inner arc
    /// (alarm 053).
    pub(super) fn check_radius(&self, rho: f64) -> Result<(), CompensationFault> {
        if self.shortage(rho) > ROUNDING_SHORTAGE_MM {
            return Err(CompensationFault::SmallArc);
        }
        Ok(())
    }
}

/// Checks the distances of an arc's centre from its start and its end, mm.
///
/// # Errors
/// A distance is zero, or they differ by more than the tolerance.
pub(crate) fn check_arc(at_start: f64, at_end: f64) -> Result<(), CompensationFault> {
    if at_start <= ON_POINT_MM {
        return Err(CompensationFault::CenterAtStart);
    }
    if at_end <= ON_POINT_MM {
        return Err(CompensationFault::CenterAtEnd);
    }
    // 1e-9: an excess of 0.001 mm is out of tolerance, rounding is not.
    if (at_end - at_start).abs() > OFF_CIRCLE_MM + 1e-9 {
        return Err(CompensationFault::ArcEnd);
    }
    Ok(())
}

/// Whether the nose path from `p` to `q`, mm, beside the arc `piece` is so short that it is run as
/// a straight line.
pub(super) fn is_too_short(piece: &ContourSegment, circle: &Circle, p: Point, q: Point) -> bool {
    let (p, q) = (p - circle.center, q - circle.center);
    let short = (q - p).length() < SHORT_ARC_MM;
    short && (p.length() < SHORT_ARC_MM || sweep(p, q, circle.turn) < PI || piece.sweep() <= PI)
}
