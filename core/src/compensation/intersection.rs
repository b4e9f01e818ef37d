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

use super::fault::CompensationFault;
use super::segment::{ContourSegment, SAME_POINT_MM};

use crate::units::Point;

/// Least denominator that does not count as zero: with a smaller one there is no intersection.
const LEAST_DENOMINATOR: f64 = 1e-12;
/// Radicands between this and zero are a rounding error and count as zero.
const LEAST_RADICAND: f64 = -1e-9;

/// The vector from the end of `a`, which is the start of `b`, to the intersection of the paths of
/// the nose centre, mm. The nose centre is `rho_a` to the left of `a` and `rho_b` to the left of
/// `b`, mm.
///
/// # Errors
/// The paths do not meet.
pub(super) fn intersect(
    a: &ContourSegment,
    rho_a: f64,
    b: &ContourSegment,
    rho_b: f64,
) -> Result<Point, CompensationFault> {
    match (&a.circle, &b.circle) {
        (None, None) => intersect_lines(a.exit.left(), rho_a, b.entry.left(), rho_b),
        _ => intersect_paths(a, rho_a, b, rho_b),
    }
}

/// Does the work of [`intersect`] for lines and arcs in any combination.
fn intersect_paths(
    a: &ContourSegment,
    rho_a: f64,
    b: &ContourSegment,
    rho_b: f64,
) -> Result<Point, CompensationFault> {
    let side_a = OffsetPath::new(a, a.end, a.exit.left(), rho_a);
    let side_b = OffsetPath::new(b, b.start, b.entry.left(), rho_b);
    let meeting = side_a.intersect(&side_b)?;
    // The radius of an arc changes along the arc if its end is off its circle.
    let (path_a, path_b) = (
        side_a.with_radius_at(a, meeting),
        side_b.with_radius_at(b, meeting),
    );
    if (path_a.radius - side_a.radius).abs() + (path_b.radius - side_b.radius).abs() < SAME_POINT_MM
    {
        return Ok(meeting);
    }
    Ok(path_a.intersect(&path_b).unwrap_or(meeting))
}

/// The path of the nose centre along a move, relative to the corner P.
#[derive(Clone, Copy, Debug)]
struct OffsetPath {
    /// Unit vector to the left of the move, at P.
    normal: Point,
    rho: f64,
    /// Centre of the arc relative to P, and in `radius` the radius of the nose path about it,
    /// mm; zero for a line.
    center: Point,
    radius: f64,
    arc: bool,
}

impl OffsetPath {
    fn new(piece: &ContourSegment, corner: Point, normal: Point, rho: f64) -> Self {
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
                radius: circle.path_radius(center.length(), rho),
                arc: true,
                ..side
            }
        })
    }

    /// A copy with the radius of the nose path at `displacement` from P, mm, for an arc `piece`
    /// whose radius changes.
    fn with_radius_at(&self, piece: &ContourSegment, displacement: Point) -> Self {
        piece.circle.as_ref().map_or(*self, |circle| {
            let radius = piece.radius_toward(circle, displacement - self.center);
            Self {
                radius: circle.path_radius(radius, self.rho),
                ..*self
            }
        })
    }

    fn intersect(&self, next: &Self) -> Result<Point, CompensationFault> {
        // The normal points left: the direction is a quarter turn back from it.
        let along = |side: &Self| side.normal.left() * -1.0;
        match (self.arc, next.arc) {
            (false, false) => intersect_lines(self.normal, self.rho, next.normal, next.rho),
            (false, true) => intersect_line_circle(along(self), self.rho, next.center, next.radius)
                .ok_or(CompensationFault::NoMeetingLineArc),
            (true, false) => intersect_line_circle(along(next), next.rho, self.center, self.radius)
                .ok_or(CompensationFault::NoMeetingArcLine),
            (true, true) => intersect_circles(self.center, self.radius, next.center, next.radius),
        }
    }
}

/// Returns the intersection, relative to P, of two lines through P that are each offset along their
/// unit normal by their `rho`, mm.
///
/// # Errors
/// The lines are parallel.
pub(super) fn intersect_lines(
    normal_a: Point,
    rho_a: f64,
    normal_b: Point,
    rho_b: f64,
) -> Result<Point, CompensationFault> {
    let c = normal_a.dot(normal_b);
    if rho_a == rho_b {
        if 1.0 + c < LEAST_DENOMINATOR {
            return Err(CompensationFault::DivisionByZero);
        }
        return Ok((normal_a + normal_b) * (rho_a / (1.0 + c)));
    }
    let denominator = 1.0 - c * c;
    if denominator < LEAST_DENOMINATOR {
        return Err(CompensationFault::DivisionByZero);
    }
    let sum = normal_a * (rho_a - c * rho_b) + normal_b * (rho_b - c * rho_a);
    Ok(sum * (1.0 / denominator))
}

/// Returns the intersection closest to P, mm, of a circle about `center` with a line through P that
/// is offset to the left by `rho`; `None` if they do not meet. `along` is the unit vector of the
/// line.
fn intersect_line_circle(along: Point, rho: f64, center: Point, radius: f64) -> Option<Point> {
    let beside = along.left() * rho;
    let w = beside - center;
    let b = w.dot(along);
    let square = b * b - (w.dot(w) - radius * radius);
    if square < LEAST_RADICAND {
        return None;
    }
    let root = square.max(0.0).sqrt();
    // The solution closer to P is the one with the shorter distance along the line.
    let distance = if b > 0.0 { root - b } else { -b - root };
    Some(beside + along * distance)
}

/// Returns the intersection of two circles that is closest to P, mm; their centres are relative to
/// P.
///
/// # Errors
/// The circles have the same centre or do not meet.
fn intersect_circles(
    center_a: Point,
    radius_a: f64,
    center_b: Point,
    radius_b: f64,
) -> Result<Point, CompensationFault> {
    let between = center_b - center_a;
    let d = between.length();
    let e = between
        .unit()
        .filter(|_| d > LEAST_DENOMINATOR)
        .ok_or(CompensationFault::DivisionByZero)?;
    let a = (radius_a * radius_a - radius_b * radius_b + d * d) / (2.0 * d);
    let square = radius_a * radius_a - a * a;
    if square < LEAST_RADICAND {
        return Err(CompensationFault::NoMeetingOfArcs);
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
        fn lines_meet_like_moves_of_any_shape(
            (x, z, rho_a, rho_b) in (
                prop::array::uniform3(-9..10_i32),
                prop::array::uniform3(-9..10_i32),
                -3..4_i32,
                -3..4_i32,
            )
        ) {
            let point = |at: usize| Point::new(f64::from(x[at]) / 7.0, f64::from(z[at]) / 3.0);
            let lines = (ContourSegment::line(point(0), point(1)), ContourSegment::line(point(1), point(2)));
            let (Ok(a), Ok(b)) = lines else { return Ok(()) };
            let (rho_a, rho_b) = (f64::from(rho_a) * 0.4, f64::from(rho_b) * 0.4);
            let (quick, long) = (intersect(&a, rho_a, &b, rho_b), intersect_paths(&a, rho_a, &b, rho_b));
            let bits = |met: Result<Point, CompensationFault>| met.map(|it| (it.x.to_bits(), it.z.to_bits()));
            prop_assert_eq!(bits(quick), bits(long));
        }
    }
}
