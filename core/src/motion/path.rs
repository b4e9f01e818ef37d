//! Geometry of a cut: straight or circular, as a function of the distance to go.

use core::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::units::Point;

/// Points nearer than this coincide, mm; an arc between them is a full circle.
const SAME: f64 = 1e-7;

/// A line or an arc with its length.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Path {
    from: Point,
    to: Point,
    length: f64,
    #[serde(rename = "bend")]
    bend: Option<Bend>,
}

/// The circular part of a path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Bend {
    center: Point,
    /// Angle of the start, from +Z towards +X, rad.
    start: f64,
    /// Angle swept, positive counter-clockwise, rad.
    sweep: f64,
    /// Radius at the start, and its increase to the end (rounding only).
    radius: f64,
    growth: f64,
}

impl Path {
    /// A straight line.
    pub fn line(from: Point, to: Point) -> Self {
        Self {
            from,
            to,
            length: (to - from).length(),
            bend: None,
        }
    }

    /// An arc, clockwise as seen with +Z to the right and +X up. It is a full circle if
    /// start and end coincide.
    pub fn arc(from: Point, to: Point, center: Point, clockwise: bool) -> Self {
        let start_arm = from - center;
        let end_arm = to - center;
        let radius = start_arm.length();
        if radius <= SAME || !radius.is_finite() {
            return Self::line(from, to);
        }
        let start = libm::atan2(start_arm.x, start_arm.z);
        let end = libm::atan2(end_arm.x, end_arm.z);
        let turn = if clockwise { start - end } else { end - start };
        let turn = if turn < 0.0 { turn + TAU } else { turn };
        let turn = if (to - from).length() <= SAME {
            TAU
        } else {
            turn
        };
        let growth = end_arm.length() - radius;
        let bend = Bend {
            center,
            start,
            sweep: if clockwise { -turn } else { turn },
            radius,
            growth,
        };
        Self {
            from,
            to,
            length: turn * (radius + growth / 2.0),
            bend: Some(bend),
        }
    }

    /// Length along the path, mm.
    pub const fn length(&self) -> f64 {
        self.length
    }

    /// Whether the path is a line.
    pub(crate) const fn is_straight(&self) -> bool {
        self.bend.is_none()
    }

    /// End point.
    pub const fn to(&self) -> Point {
        self.to
    }

    /// The point `remaining` mm before the end; exactly the end point at zero.
    pub fn at(&self, remaining: f64) -> Point {
        if remaining <= 0.0 {
            return self.to;
        }
        let done = 1.0 - remaining / self.length;
        let Some(bend) = &self.bend else {
            return self.from + (self.to - self.from) * done;
        };
        let (sine, cosine) = libm::sincos(bend.start + bend.sweep * done);
        let radius = bend.radius + bend.growth * done;
        bend.center + Point::new(sine * radius, cosine * radius)
    }

    /// The path shifted by a vector.
    pub fn translated(self, by: Point) -> Self {
        let bend = self.bend.map(|bend| Bend {
            center: bend.center + by,
            ..bend
        });
        Self {
            from: self.from + by,
            to: self.to + by,
            bend,
            ..self
        }
    }
}
