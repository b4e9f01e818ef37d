//! A programmed move as geometry.
//!
//! ```text
//!     line                          arc, turn +1 counter-clockwise
//!     start o---entry/exit--> o     start o--.         exit ^
//!                                              `.  entry    |
//!                                       center +  `o end----'
//! ```

use core::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::fault::Fault;
use super::plane::{left, sweep, unit};
use crate::units::Point;

/// Nearer than this, two points are one, mm.
pub(super) const SAME: f64 = 1e-7;
/// Nearer than this, a centre lies on a point of its arc, mm.
const ON_POINT: f64 = 0.0005;
/// Greatest distance of an end point from the circle of its arc, mm.
pub(crate) const OFF_CIRCLE: f64 = 0.010;

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
    pub(super) radius: f64,
    /// +1 counter-clockwise, -1 clockwise.
    pub(super) turn: f64,
}

impl Piece {
    /// A straight move.
    pub(super) fn line(start: Point, end: Point) -> Result<Self, Fault> {
        let along = unit(end - start)
            .filter(|_| (end - start).length() > SAME)
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
        let entry = unit(first).ok_or(Fault::CenterAtStart)?;
        let exit = unit(last).ok_or(Fault::CenterAtEnd)?;
        Ok(Self {
            start,
            end,
            entry: left(entry) * turn,
            exit: left(exit) * turn,
            circle: Some(Circle {
                center,
                radius: first.length(),
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

    /// How far the end lies off the circle of its start.
    pub(super) fn misfit(&self) -> f64 {
        self.circle.as_ref().map_or(0.0, |circle| {
            ((self.end - circle.center).length() - circle.radius).abs()
        })
    }

    pub(super) fn length_of_chord(&self) -> f64 {
        (self.end - self.start).length()
    }
}

impl Circle {
    /// The radius of the path of the nose centre: to the left by `rho`.
    pub(super) fn offset_radius(&self, rho: f64) -> Result<f64, Fault> {
        let radius = self.radius - self.turn * rho;
        if radius < -1e-9 {
            return Err(Fault::SmallArc);
        }
        Ok(radius.max(0.0))
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
