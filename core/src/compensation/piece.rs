//! A programmed move as geometry.
//!
//! ```text
//!     line                          arc, turn +1 counter-clockwise
//!     start o---entry/exit--> o     start o--.         exit ^
//!                                              `.  entry    |
//!                                       center +  `o end----'
//! ```

use core::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use super::fault::Fault;
use super::plane::sweep;
use crate::units::Point;

/// Nearer than this, two points are one, mm.
pub(super) const SAME: f64 = 1e-7;
/// Nearer than this, a centre lies on a point of its arc, mm.
const ON_POINT: f64 = 0.0005;
/// Greatest distance of an end point from the circle of its arc, mm.
pub(crate) const OFF_CIRCLE: f64 = 0.010;
/// An end so little beside its circle is on it, mm.
const EVEN: f64 = 1e-10;
/// The nose may be larger than an inner arc by what both ends and a centre rounded to
/// 0.001 mm take from it, mm.
const ROUNDED: f64 = 0.0018;
/// An inner arc larger than the nose by less than this is filled by it, mm.
const FILLED: f64 = 0.002;
/// Arcs shorter than this are run straight: rounding could turn them over.
const SHORT_ARC: f64 = 0.002;

/// An inner arc wider than this holds no nose larger than it, rad.
const WIDE: f64 = 0.9 * PI;

/// A move with the directions at its ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Piece {
    pub(super) start: Point,
    pub(super) end: Point,
    /// Direction of travel at the start.
    pub(super) entry: Point,
    /// Direction of travel at the end.
    pub(super) exit: Point,
    pub(super) circle: Option<Circle>,
}

/// What makes an arc of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Circle {
    pub(super) center: Point,
    /// At the start. An end beside this circle is reached with an even change.
    pub(super) radius: f64,
    /// At the end.
    pub(super) last_radius: f64,
    /// +1 counter-clockwise, -1 clockwise.
    pub(super) turn: f64,
}

/// Whether two points lie so near to each other that they are one.
#[inline]
pub(super) fn are_same(one: Point, other: Point) -> bool {
    let between = other - one;
    between.dot(between) <= SAME * SAME
}

impl Piece {
    /// A straight move.
    pub(super) fn line(start: Point, end: Point) -> Result<Self, Fault> {
        let along = (end - start)
            .unit()
            .filter(|_| !are_same(start, end))
            .ok_or(Fault::SamePoint)?;
        Ok(Self {
            start,
            end,
            entry: along,
            exit: along,
            circle: None,
        })
    }

    /// An arc about a centre.
    pub(super) fn arc(
        start: Point,
        end: Point,
        center: Point,
        clockwise: bool,
    ) -> Result<Self, Fault> {
        let turn = if clockwise { -1.0 } else { 1.0 };
        let (first, last) = (start - center, end - center);
        check_arc(first.length(), last.length())?;
        let entry = first.unit().ok_or(Fault::CenterAtStart)?;
        let exit = last.unit().ok_or(Fault::CenterAtEnd)?;
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

    /// The angle of an arc, 0 to a full turn; 0 for a line.
    pub(super) fn sweep(&self) -> f64 {
        let Some(circle) = &self.circle else {
            return 0.0;
        };
        let (first, last) = (self.start - circle.center, self.end - circle.center);
        let way = sweep(first, last, circle.turn);
        if way <= 0.0 { TAU } else { way }
    }

    /// The radius of an arc in a direction from its centre; beyond its ends that
    /// of the end.
    pub(super) fn radius_toward(&self, circle: &Circle, direction: Point) -> f64 {
        if (circle.last_radius - circle.radius).abs() < EVEN {
            return circle.radius;
        }
        let whole = self.sweep();
        let way = sweep(self.start - circle.center, direction, circle.turn);
        let part = if way <= whole {
            way / whole
        } else if way - whole < TAU - way {
            1.0
        } else {
            0.0
        };
        circle.radius + (circle.last_radius - circle.radius) * part
    }

    /// Where the centre of a nose rests that fills an inner arc: on that of the arc;
    /// larger than the arc, so far above its middle that neither end is cut into.
    ///
    /// ```text
    ///   start o    V    o end       the shortage / cos (sweep / 2) from the
    ///          `.  +  .'            centre + to V
    ///            `---'
    /// ```
    pub(super) fn rest(&self, rho: f64) -> Option<Point> {
        let circle = self.circle.as_ref()?;
        let shortage = circle.shortage(rho);
        if shortage < -FILLED || self.sweep() > WIDE {
            return None;
        }
        let arm = |end: Point| (end - circle.center).unit();
        let to_middle = (arm(self.start)? + arm(self.end)?) * 0.5;
        let above = to_middle.unit()? * (shortage.max(0.0) / to_middle.length());
        Some(circle.center - above)
    }

    pub(super) fn length_of_chord(&self) -> f64 {
        (self.end - self.start).length()
    }
}

impl Circle {
    /// The radius of the path of the nose centre, to the left by `rho`, where the
    /// arc itself has this radius.
    pub(super) fn beside(&self, radius: f64, rho: f64) -> f64 {
        (radius - self.turn * rho).max(0.0)
    }

    /// So much larger than an inner arc is the nose that runs to the left by `rho`.
    fn shortage(&self, rho: f64) -> f64 {
        self.turn * rho - self.radius.min(self.last_radius)
    }

    /// Alarm 053 when the nose is too large for an inner arc.
    pub(super) fn check_room(&self, rho: f64) -> Result<(), Fault> {
        if self.shortage(rho) > ROUNDED {
            return Err(Fault::SmallArc);
        }
        Ok(())
    }
}

/// The arc data of compensation C: distances of the centre from both ends.
pub(crate) fn check_arc(at_start: f64, at_end: f64) -> Result<(), Fault> {
    if at_start <= ON_POINT {
        return Err(Fault::CenterAtStart);
    }
    if at_end <= ON_POINT {
        return Err(Fault::CenterAtEnd);
    }
    // 1e-9: a thousandth more than the tolerance is beyond it, rounding is not.
    if (at_end - at_start).abs() > OFF_CIRCLE + 1e-9 {
        return Err(Fault::ArcEnd);
    }
    Ok(())
}

/// Whether so little is left of an arc from `p` to `q` that it is run straight.
pub(super) fn too_short(piece: &Piece, circle: &Circle, p: Point, q: Point) -> bool {
    let (p, q) = (p - circle.center, q - circle.center);
    let short = (q - p).length() < SHORT_ARC;
    short && (p.length() < SHORT_ARC || sweep(p, q, circle.turn) < PI || piece.sweep() <= PI)
}
