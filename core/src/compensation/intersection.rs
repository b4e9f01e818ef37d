//! Intersection of the nose-centre paths along two moves, as a displacement from the
//! programmed corner P.
//!
//! ```text
//!   line, line            line, arc                  arc, arc
//!     \  V                 q + λt on the circle       a = (Ra² - Rb² + d²)/2d
//!   ---\-*------ offset    about C: the solution      h = √(Ra² - a²)
//!   ----P.               ---*.  nearest to P          Ca + a e ± h e.left():
//!        \ \                P `.                      the one nearest to P
//! ```

use super::fault::Fault;
use super::piece::{Piece, SAME};

use crate::units::Point;

/// A smaller denominator counts as a division by zero.
const NO_ANGLE: f64 = 1e-12;
/// Radicands between this and zero count as zero: rounding.
const ROOT_OF_ZERO: f64 = -1e-9;

/// The displacement from the end of `a`, which is the start of `b`. The nose runs `rho_a`
/// left of `a` and `rho_b` left of `b`, mm.
pub(super) fn meet(a: &Piece, rho_a: f64, b: &Piece, rho_b: f64) -> Result<Point, Fault> {
    match (&a.circle, &b.circle) {
        (None, None) => of_lines(a.exit.left(), rho_a, b.entry.left(), rho_b),
        _ => meet_of_sides(a, rho_a, b, rho_b),
    }
}

/// The same for moves of any shape.
fn meet_of_sides(a: &Piece, rho_a: f64, b: &Piece, rho_b: f64) -> Result<Point, Fault> {
    let side_a = Side::of(a, a.end, a.exit.left(), rho_a);
    let side_b = Side::of(b, b.start, b.entry.left(), rho_b);
    let meeting = side_a.meet(&side_b)?;
    // The radius of an arc changes along the arc if its end is off its circle.
    let (there_a, there_b) = (side_a.at(a, meeting), side_b.at(b, meeting));
    if (there_a.radius - side_a.radius).abs() + (there_b.radius - side_b.radius).abs() < SAME {
        return Ok(meeting);
    }
    Ok(there_a.meet(&there_b).unwrap_or(meeting))
}

/// The path of the nose centre along one of the moves, relative to P.
#[derive(Clone, Copy, Debug)]
struct Side {
    /// Unit vector to the left of the move at P.
    normal: Point,
    rho: f64,
    /// Centre of an arc; `radius` is that of the path about it.
    center: Point,
    radius: f64,
    arc: bool,
}

impl Side {
    fn of(piece: &Piece, corner: Point, normal: Point, rho: f64) -> Self {
        let side = Self {
            normal,
            rho,
            center: Point::default(),
            radius: 0.0,
            arc: false,
        };
        piece.circle.as_ref().map_or(side, |circle| {
            let center = circle.center - corner;
            Self {
                center,
                radius: circle.beside(center.length(), rho),
                arc: true,
                ..side
            }
        })
    }

    /// The same path with the radius that the arc has beside a displacement from P.
    fn at(&self, piece: &Piece, place: Point) -> Self {
        piece.circle.as_ref().map_or(*self, |circle| {
            let radius = piece.radius_toward(circle, place - self.center);
            Self {
                radius: circle.beside(radius, self.rho),
                ..*self
            }
        })
    }

    fn meet(&self, next: &Self) -> Result<Point, Fault> {
        // The normal points left: the direction is a quarter turn back from it.
        let along = |side: &Self| side.normal.left() * -1.0;
        match (self.arc, next.arc) {
            (false, false) => of_lines(self.normal, self.rho, next.normal, next.rho),
            (false, true) => on_line(along(self), self.rho, next.center, next.radius)
                .ok_or(Fault::NoMeetingLineArc),
            (true, false) => on_line(along(next), next.rho, self.center, self.radius)
                .ok_or(Fault::NoMeetingArcLine),
            (true, true) => of_arcs(self.center, self.radius, next.center, next.radius),
        }
    }
}

/// Intersects two lines through P, each offset along its normal.
pub(super) fn of_lines(
    normal_a: Point,
    rho_a: f64,
    normal_b: Point,
    rho_b: f64,
) -> Result<Point, Fault> {
    let c = normal_a.dot(normal_b);
    if rho_a == rho_b {
        if 1.0 + c < NO_ANGLE {
            return Err(Fault::DivisionByZero);
        }
        return Ok((normal_a + normal_b) * (rho_a / (1.0 + c)));
    }
    let denominator = 1.0 - c * c;
    if denominator < NO_ANGLE {
        return Err(Fault::DivisionByZero);
    }
    let sum = normal_a * (rho_a - c * rho_b) + normal_b * (rho_b - c * rho_a);
    Ok(sum * (1.0 / denominator))
}

/// Intersects a line through P, offset to the left by `rho`, with a circle.
fn on_line(along: Point, rho: f64, center: Point, radius: f64) -> Option<Point> {
    let beside = along.left() * rho;
    let w = beside - center;
    let b = w.dot(along);
    let square = b * b - (w.dot(w) - radius * radius);
    if square < ROOT_OF_ZERO {
        return None;
    }
    let root = square.max(0.0).sqrt();
    // The solution closer to P is the one with the shorter distance along the line.
    let way = if b > 0.0 { root - b } else { -b - root };
    Some(beside + along * way)
}

/// Intersects two circles whose centres are relative to P.
fn of_arcs(center_a: Point, radius_a: f64, center_b: Point, radius_b: f64) -> Result<Point, Fault> {
    let between = center_b - center_a;
    let d = between.length();
    let e = between
        .unit()
        .filter(|_| d > NO_ANGLE)
        .ok_or(Fault::DivisionByZero)?;
    let a = (radius_a * radius_a - radius_b * radius_b + d * d) / (2.0 * d);
    let square = radius_a * radius_a - a * a;
    if square < ROOT_OF_ZERO {
        return Err(Fault::NoMeetingOfArcs);
    }
    let foot = center_a + e * a;
    let height = e.left() * square.max(0.0).sqrt();
    let (one, other) = (foot + height, foot - height);
    Ok(if one.length() <= other.length() {
        one
    } else {
        other
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn two_lines_meet_as_moves_of_any_kind_do(
            (x, z, rho_a, rho_b) in (
                prop::array::uniform3(-9..10_i32),
                prop::array::uniform3(-9..10_i32),
                -3..4_i32,
                -3..4_i32,
            )
        ) {
            let point = |at: usize| Point::new(f64::from(x[at]) / 7.0, f64::from(z[at]) / 3.0);
            let lines = (Piece::line(point(0), point(1)), Piece::line(point(1), point(2)));
            let (Ok(a), Ok(b)) = lines else { return Ok(()) };
            let (rho_a, rho_b) = (f64::from(rho_a) * 0.4, f64::from(rho_b) * 0.4);
            let (quick, long) = (meet(&a, rho_a, &b, rho_b), meet_of_sides(&a, rho_a, &b, rho_b));
            let bits = |met: Result<Point, Fault>| met.map(|it| (it.x.to_bits(), it.z.to_bits()));
            prop_assert_eq!(bits(quick), bits(long));
        }
    }
}
