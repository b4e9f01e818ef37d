//! A line or an arc of an outline.
//!
//! ```text
//!          ___                bulge = tan(sweep / 4)
//!        /     \              0: a line; positive: counter-clockwise from start to end,
//!   start ----- end           with Z to the right and X up; ±1: half a turn
//! ```
//!
//! An arc by its ends and its bulge keeps its ends exactly where the next piece begins, and
//! stays an arc if an end moves.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use gsk_units::Point;

/// Bulges below this are lines.
const LEAST_BULGE: f64 = 1e-9;

/// A line or an arc of at most half a turn. X is a radius, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfilePiece {
    /// Where the piece starts.
    pub start: Point,
    /// Where the piece ends.
    pub end: Point,
    /// The tangent of a quarter of the angle of the arc; positive is counter-clockwise, 0 a
    /// line.
    pub bulge: f64,
}

impl ProfilePiece {
    /// A line.
    pub const fn line(start: Point, end: Point) -> Self {
        Self {
            start,
            end,
            bulge: 0.0,
        }
    }

    /// The pieces of an arc with this angle, radians; positive is counter-clockwise. More than
    /// half a turn becomes two pieces, and a full turn begins and ends at the angle `begin`.
    pub fn from_center(center: Point, radius: f64, begin: f64, sweep: f64) -> Vec<Self> {
        let count = if sweep.abs() > PI { 2_u32 } else { 1 };
        let step = sweep.clamp(-TAU, TAU) / f64::from(count);
        let at = |index: u32| {
            let angle = begin + step * f64::from(index);
            center + Point::new(libm::sin(angle), libm::cos(angle)) * radius
        };
        let piece = |index| Self {
            start: at(index),
            end: at(index + 1),
            bulge: libm::tan(step / 4.0),
        };
        (0..count).map(piece).collect()
    }

    /// The pieces of an arc by its ends and a bulge of any size.
    pub fn from_bulge(start: Point, end: Point, bulge: f64) -> Vec<Self> {
        let whole = Self { start, end, bulge };
        if bulge.abs() <= 1.0 {
            return vec![whole];
        }
        let (first, second) = whole.split_at(0.5);
        vec![first, second]
    }

    /// Whether the piece is an arc.
    pub fn is_arc(&self) -> bool {
        self.bulge.abs() > LEAST_BULGE
    }

    /// The angle of the arc, radians; positive is counter-clockwise, 0 a line.
    pub fn sweep(&self) -> f64 {
        match self.is_arc() {
            true => 4.0 * libm::atan(self.bulge),
            false => 0.0,
        }
    }

    /// The straight displacement from start to end.
    pub fn chord(&self) -> Point {
        self.end - self.start
    }

    /// The centre of the arc; `None` for a line.
    pub fn center(&self) -> Option<Point> {
        self.is_arc().then(|| {
            let height = (1.0 - self.bulge * self.bulge) / (4.0 * self.bulge);
            self.start + self.chord() * 0.5 + self.chord().left() * height
        })
    }

    /// The radius of the arc, mm; 0 for a line.
    pub fn radius(&self) -> f64 {
        match self.is_arc() {
            true => {
                self.chord().length() * (1.0 + self.bulge * self.bulge) / (4.0 * self.bulge).abs()
            }
            false => 0.0,
        }
    }

    /// The length of the piece along itself, mm.
    pub fn length(&self) -> f64 {
        match self.is_arc() {
            true => self.radius() * self.sweep().abs(),
            false => self.chord().length(),
        }
    }

    /// The point at a fraction of the piece: 0 is the start, 1 the end.
    pub fn point_at(&self, fraction: f64) -> Point {
        if fraction <= 0.0 {
            return self.start;
        }
        if fraction >= 1.0 {
            return self.end;
        }
        let Some(center) = self.center() else {
            return self.start + self.chord() * fraction;
        };
        center + turn(self.start - center, self.sweep() * fraction)
    }

    /// The direction of travel at a fraction of the piece, a vector of length 1; zero for a
    /// piece without length.
    pub fn direction_at(&self, fraction: f64) -> Point {
        let along = self.chord().unit().unwrap_or_default();
        turn(along, self.sweep() * (fraction - 0.5))
    }

    /// The same piece from its end to its start.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self {
            start: self.end,
            end: self.start,
            bulge: -self.bulge,
        }
    }

    /// The piece mirrored in the spindle axis.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let mirror = |point: Point| Point::new(-point.x, point.z);
        Self {
            start: mirror(self.start),
            end: mirror(self.end),
            bulge: -self.bulge,
        }
    }

    /// The piece scaled and then moved.
    #[must_use]
    pub fn placed(&self, scale: f64, offset: Point) -> Self {
        Self {
            start: self.start * scale + offset,
            end: self.end * scale + offset,
            bulge: self.bulge,
        }
    }

    /// The piece moved to the right of its travel by a distance, mm, or to the left if it is
    /// negative. `None` for an arc that vanishes.
    pub fn moved_right(&self, distance: f64) -> Option<Self> {
        let Some(center) = self.center() else {
            let right = self.chord().unit().unwrap_or_default().left() * -distance;
            return Some(Self::line(self.start + right, self.end + right));
        };
        let own = self.radius();
        let moved = own
            + if self.bulge > 0.0 {
                distance
            } else {
                -distance
            };
        (moved > 0.0).then(|| Self {
            start: center + (self.start - center) * (moved / own),
            end: center + (self.end - center) * (moved / own),
            bulge: self.bulge,
        })
    }

    /// The arc from a point that touches the direction of travel there and ends where it
    /// points along another one, counter-clockwise or clockwise; `None` for more than half a
    /// turn.
    pub fn turning(
        start: Point,
        (from, to): (Point, Point),
        radius: f64,
        counter_clockwise: bool,
    ) -> Option<Self> {
        let side = if counter_clockwise { 1.0 } else { -1.0 };
        let angle = libm::atan2(from.cross(to), from.dot(to)) * side;
        if angle <= 0.0 {
            return None;
        }
        let center = start + from.left() * (side * radius);
        let spoke = start - center;
        Some(Self {
            start,
            end: center + turn(spoke, angle * side),
            bulge: libm::tan(angle / 4.0) * side,
        })
    }

    /// The two pieces before and after a fraction.
    pub fn split_at(&self, fraction: f64) -> (Self, Self) {
        let middle = self.point_at(fraction);
        let quarter = self.sweep() / 4.0;
        let first = Self {
            start: self.start,
            end: middle,
            bulge: libm::tan(quarter * fraction),
        };
        let second = Self {
            start: middle,
            end: self.end,
            bulge: libm::tan(quarter * (1.0 - fraction)),
        };
        (first, second)
    }

    /// The fractions, ascending, at which an arc is farthest along an axis: its direction is
    /// parallel to X or Z there. Ends are not included.
    pub fn extremes(&self) -> Vec<f64> {
        let Some(center) = self.center() else {
            return Vec::new();
        };
        let (from, sweep) = (self.start - center, self.sweep());
        let begin = libm::atan2(from.x, from.z);
        let quadrants = (-4..=4).map(|index| f64::from(index) * FRAC_PI_2);
        let mut fractions: Vec<f64> = quadrants
            .map(|angle| (angle - begin) / sweep)
            .filter(|fraction| (1e-9..=1.0 - 1e-9).contains(fraction))
            .collect();
        fractions.sort_by(f64::total_cmp);
        fractions
    }

    /// The least and the greatest coordinates of the piece.
    pub fn bounds(&self) -> (Point, Point) {
        let inner = self.extremes().into_iter().map(|at| self.point_at(at));
        let points = inner.chain([self.end]);
        points.fold((self.start, self.start), |(low, high), point| {
            (
                Point::new(low.x.min(point.x), low.z.min(point.z)),
                Point::new(high.x.max(point.x), high.z.max(point.z)),
            )
        })
    }

    /// The fraction of the point of the piece's line or circle nearest to `point`; outside 0 to
    /// 1 it is beyond the ends.
    pub fn fraction_of(&self, point: Point) -> f64 {
        let Some(center) = self.center() else {
            let chord = self.chord();
            return (point - self.start).dot(chord) / chord.dot(chord).max(f64::MIN_POSITIVE);
        };
        let (from, to) = (self.start - center, point - center);
        let angle = libm::atan2(from.cross(to), from.dot(to));
        let fraction = angle / self.sweep();
        // The short way round may be the wrong one for points in the second half.
        let around = TAU / self.sweep().abs();
        if fraction < (1.0 - around) / 2.0 {
            fraction + around
        } else {
            fraction
        }
    }
}

/// A displacement turned counter-clockwise, with Z to the right and X up.
fn turn(displacement: Point, angle: f64) -> Point {
    displacement * libm::cos(angle) + displacement.left() * libm::sin(angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_near(one: Point, other: Point) -> bool {
        (one - other).length() < 1e-9
    }

    #[test]
    fn a_quarter_has_its_centre_and_its_points() {
        let arc = ProfilePiece {
            start: Point::new(0.0, 5.0),
            end: Point::new(5.0, 0.0),
            bulge: libm::tan(FRAC_PI_2 / 4.0),
        };
        assert!(is_near(arc.center().expect("an arc"), Point::default()));
        assert!((arc.radius() - 5.0).abs() < 1e-12);
        let diagonal = 5.0 * libm::sqrt(0.5);
        assert!(is_near(arc.point_at(0.5), Point::new(diagonal, diagonal)));
        assert!(is_near(arc.direction_at(0.0), Point::new(1.0, 0.0)));
        assert!((arc.fraction_of(Point::new(3.0, 3.0)) - 0.5).abs() < 1e-9);
        assert!(is_near(arc.reversed().point_at(0.25), arc.point_at(0.75)));
        assert!(arc.extremes().is_empty());
    }

    #[test]
    fn more_than_half_a_turn_becomes_two_pieces() {
        let full = ProfilePiece::from_center(Point::default(), 2.0, 0.0, TAU);
        assert_eq!(full.len(), 2);
        assert!(is_near(full[0].end, Point::new(0.0, -2.0)));
        let long = ProfilePiece::from_bulge(Point::new(0.0, 1.0), Point::new(1.0, 0.0), -2.0);
        assert_eq!(long.len(), 2);
        assert!(is_near(
            long[0].center().expect("an arc"),
            long[1].center().expect("an arc")
        ));
        assert!(long.iter().all(|piece| piece.bulge.abs() <= 1.0));
    }

    #[test]
    fn bounds_include_the_extremes() {
        let half = ProfilePiece {
            start: Point::new(0.0, 3.0),
            end: Point::new(0.0, -3.0),
            bulge: 1.0,
        };
        let (low, high) = half.bounds();
        assert!(is_near(low, Point::new(0.0, -3.0)));
        assert!(is_near(high, Point::new(3.0, 3.0)));
    }
}
