//! Circular arcs and their approximation by chords.
//!
//! ```text
//!        ___
//!      /  |s \        s: sagitta = radius · (1 − cos(step / 2))
//!     /---+---\
//! ```

use core::f64::consts::{PI, TAU};

use gsk_units::Point;

/// Greatest distance of a chord from its arc, mm: two units of the grid.
pub const SAGITTA_MM: f64 = 0.000_2;

/// Maximum number of chords of one arc.
const MAX_CHORDS: f64 = 4096.0;

/// A circular arc in the working plane, with Z to the right and X upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneArc {
    /// The centre of the arc, mm; X is a radius.
    pub center: Point,
    /// The radius of the arc, mm.
    pub radius: f64,
    /// The direction from the centre to the start, radians counter-clockwise from +Z.
    pub begin: f64,
    /// The angle from start to end, radians; positive is counter-clockwise.
    pub sweep: f64,
}

impl PlaneArc {
    /// Creates an arc about `center` from one point to another, mm. Equal points give a full
    /// circle.
    pub fn between(from: Point, to: Point, center: Point, clockwise: bool) -> Self {
        let (first, last) = (from - center, to - center);
        let begin = angle(first);
        let mut sweep = angle(last) - begin;
        // An end that lies before the start by rounding only is the start.
        const SAME: f64 = 1e-12;
        if clockwise && sweep >= -SAME {
            sweep -= TAU;
        } else if !clockwise && sweep <= SAME {
            sweep += TAU;
        }
        Self {
            center,
            radius: first.length(),
            begin,
            sweep,
        }
    }

    /// The point, mm, at a fraction of the arc: 0 is the start, 1 the end.
    pub fn point_at(&self, fraction: f64) -> Point {
        let angle = self.begin + self.sweep * fraction;
        self.center + Point::new(libm::sin(angle), libm::cos(angle)) * self.radius
    }

    /// Returns points from start to end of the arc; their chords are within [`SAGITTA_MM`] of it.
    pub fn points(&self) -> impl Iterator<Item = Point> + use<> {
        let arc = *self;
        let chords = arc.chord_count(SAGITTA_MM);
        (0..=chords).map(move |index| arc.point_at(f64::from(index) / f64::from(chords)))
    }

    /// Returns the number of equal chords that stay within `sagitta_mm` of the arc.
    pub fn chord_count(&self, sagitta_mm: f64) -> u32 {
        let least = (1.0 - sagitta_mm / self.radius.max(sagitta_mm)).max(-1.0);
        let step = (2.0 * libm::acos(least)).max(1e-6);
        libm::ceil(self.sweep.abs() / step).clamp(1.0, MAX_CHORDS) as u32
    }
}

/// Returns the direction of a displacement, radians counter-clockwise from +Z.
pub fn angle(displacement: Point) -> f64 {
    libm::atan2(displacement.x, displacement.z)
}

/// Returns the vector of length 1 in a direction, degrees counter-clockwise from +Z.
pub fn unit_vector(degrees: f64) -> Point {
    let radians = degrees * PI / 180.0;
    Point::new(libm::sin(radians), libm::cos(radians))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_on_the_arc_and_chords_within_the_sagitta() {
        let (from, to) = (Point::new(10.0, 0.0), Point::new(0.0, 10.0));
        for (clockwise, sweep) in [(true, -PI / 2.0), (false, 1.5 * PI)] {
            let arc = PlaneArc::between(from, to, Point::default(), clockwise);
            assert!((arc.sweep - sweep).abs() < 1e-12);
            let points: Vec<Point> = arc.points().collect();
            assert!((*points.last().unwrap() - to).length() < 1e-9);
            for pair in points.windows(2) {
                assert!((pair[1].length() - 10.0).abs() < 1e-9);
                assert!(10.0 - ((pair[0] + pair[1]) * 0.5).length() <= SAGITTA_MM * 1.000_1);
            }
        }
    }

    #[test]
    fn equal_end_points_give_a_full_circle() {
        let point = Point::new(1.0, 1.0);
        let arc = PlaneArc::between(point, point, Point::default(), false);
        assert!((arc.sweep - TAU).abs() < 1e-12);
    }
}
