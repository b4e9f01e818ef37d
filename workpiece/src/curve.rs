//! Arcs as chords.
//!
//! ```text
//!        ___
//!      /  |s \        s: sagitta = radius · (1 − cos(step / 2))
//!     /---+---\
//! ```

use core::f64::consts::{PI, TAU};

use gsk_units::Point;

/// How far a chord may be off its arc, mm: two units of the grid.
pub const SAGITTA_MM: f64 = 0.000_2;

/// Chords of an arc at most.
const MOST_CHORDS: f64 = 4096.0;

/// An arc of the working plane, Z to the right and X up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// Its centre.
    pub center: Point,
    /// Its radius, mm.
    pub radius: f64,
    /// Where it begins, radians counter-clockwise from +Z.
    pub begin: f64,
    /// How far it goes, radians; counter-clockwise is greater than 0.
    pub sweep: f64,
}

impl Arc {
    /// From one point to another; the same one gives a full circle.
    pub fn between(from: Point, to: Point, center: Point, clockwise: bool) -> Self {
        let (first, last) = (from - center, to - center);
        let begin = angle(first);
        let mut sweep = angle(last) - begin;
        // A whisker before the start is the start.
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

    /// The point at a part of the way, 0 to 1.
    pub fn at(&self, part: f64) -> Point {
        let angle = self.begin + self.sweep * part;
        self.center + Point::new(libm::sin(angle), libm::cos(angle)) * self.radius
    }

    /// Its points, both ends too, so near that chords stay within [`SAGITTA_MM`].
    pub fn points(&self) -> impl Iterator<Item = Point> + use<> {
        let arc = *self;
        let chords = arc.chords(SAGITTA_MM);
        (0..=chords).map(move |index| arc.at(f64::from(index) / f64::from(chords)))
    }

    /// How many chords stay within a sagitta, mm.
    pub fn chords(&self, sagitta: f64) -> u32 {
        let least = (1.0 - sagitta / self.radius.max(sagitta)).max(-1.0);
        let step = (2.0 * libm::acos(least)).max(1e-6);
        libm::ceil(self.sweep.abs() / step).clamp(1.0, MOST_CHORDS) as u32
    }
}

/// Direction of a displacement, radians counter-clockwise from +Z.
pub fn angle(displacement: Point) -> f64 {
    libm::atan2(displacement.x, displacement.z)
}

/// The displacement of length 1 in a direction, degrees counter-clockwise from +Z.
pub fn direction(degrees: f64) -> Point {
    let radians = degrees * PI / 180.0;
    Point::new(libm::sin(radians), libm::cos(radians))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_lie_on_the_arc_and_chords_near_it() {
        let (from, to) = (Point::new(10.0, 0.0), Point::new(0.0, 10.0));
        for (clockwise, sweep) in [(true, -PI / 2.0), (false, 1.5 * PI)] {
            let arc = Arc::between(from, to, Point::default(), clockwise);
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
    fn the_same_point_is_a_full_circle() {
        let point = Point::new(1.0, 1.0);
        let arc = Arc::between(point, point, Point::default(), false);
        assert!((arc.sweep - TAU).abs() < 1e-12);
    }
}
