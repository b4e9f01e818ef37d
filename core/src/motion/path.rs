//! Geometry of a cut: straight or circular, as a function of the distance to go.

use core::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::units::Point;

/// Greatest distance of two points that count as the same, mm; an arc between such points is a full
/// circle.
const COINCIDENT_MM: f64 = 1e-7;

/// A straight or circular path with its length.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct CutPath {
    from: Point,
    to: Point,
    length: f64,
    #[serde(rename = "bend")]
    arc_geometry: Option<ArcGeometry>,
}

/// The arc of a path: centre, radius and angles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct ArcGeometry {
    center: Point,
    /// Direction from the centre to the start, rad, counted from +Z towards +X.
    start: f64,
    /// Angle of the arc, rad; positive counter-clockwise.
    sweep: f64,
    /// Radius at the start, mm. `growth` is its increase up to the end, mm, which comes from
    /// rounding only.
    radius: f64,
    growth: f64,
}

impl CutPath {
    /// Creates a straight path between two points, mm.
    pub fn line(from: Point, to: Point) -> Self {
        Self {
            from,
            to,
            length: (to - from).length(),
            arc_geometry: None,
        }
    }

    /// Creates a circular path about `center`, mm; clockwise is as seen with +Z to the right and +X
    /// up. The path is a full circle if start and end coincide.
    pub fn arc(from: Point, to: Point, center: Point, clockwise: bool) -> Self {
        let start_arm = from - center;
        let end_arm = to - center;
        let radius = start_arm.length();
        if radius <= COINCIDENT_MM || !radius.is_finite() {
            return Self::line(from, to);
        }
        let start = libm::atan2(start_arm.x, start_arm.z);
        let end = libm::atan2(end_arm.x, end_arm.z);
        let sweep = if clockwise { start - end } else { end - start };
        let sweep = if sweep < 0.0 { sweep + TAU } else { sweep };
        let sweep = if (to - from).length() <= COINCIDENT_MM {
            TAU
        } else {
            sweep
        };
        let growth = end_arm.length() - radius;
        let arc_geometry = ArcGeometry {
            center,
            start,
            sweep: if clockwise { -sweep } else { sweep },
            radius,
            growth,
        };
        Self {
            from,
            to,
            length: sweep * (radius + growth / 2.0),
            arc_geometry: Some(arc_geometry),
        }
    }

    /// Returns the length of the path, mm.
    pub const fn length(&self) -> f64 {
        self.length
    }

    /// Whether the path is a straight line.
    pub(crate) const fn is_straight(&self) -> bool {
        self.arc_geometry.is_none()
    }

    /// Returns the end point of the path, mm.
    pub const fn to(&self) -> Point {
        self.to
    }

    /// The point, mm, on the path at the distance `remaining`, mm, before its end; exactly the end
    /// point if that is zero.
    pub fn point_at(&self, remaining: f64) -> Point {
        if remaining <= 0.0 {
            return self.to;
        }
        let fraction = 1.0 - remaining / self.length;
        let Some(arc_geometry) = &self.arc_geometry else {
            return self.from + (self.to - self.from) * fraction;
        };
        let (sine, cosine) = libm::sincos(arc_geometry.start + arc_geometry.sweep * fraction);
        let radius = arc_geometry.radius + arc_geometry.growth * fraction;
        arc_geometry.center + Point::new(sine * radius, cosine * radius)
    }

    /// Returns the path shifted by a vector, mm.
    pub fn shifted(self, by: Point) -> Self {
        let bend = self.arc_geometry.map(|bend| ArcGeometry {
            center: bend.center + by,
            ..bend
        });
        Self {
            from: self.from + by,
            to: self.to + by,
            arc_geometry: bend,
            ..self
        }
    }
}
