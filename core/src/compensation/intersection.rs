//! Where the paths of the nose centre along two moves meet, as a displacement
//! from the programmed corner P.
//!
//! ```text
//!   line, line            line, arc                  arc, arc
//!     \  V                 q + λt on the circle       a = (Ra² - Rb² + d²)/2d
//!   ---\-*------ offset    about C: the solution      h = √(Ra² - a²)
//!   ----P.               ---*.  nearest to P          Ca + a e ± h left(e):
//!        \ \                P `.                      the one nearest to P
//! ```

use super::fault::Fault;
use super::piece::Piece;
use super::plane::{dot, left, unit};
use crate::units::Point;

/// Denominators below this divide by zero.
const NO_ANGLE: f64 = 1e-12;
/// Square roots of so little below zero are those of zero: rounding.
const ROOT_OF_ZERO: f64 = -1e-9;

/// The displacement from the end of `a`, which is the start of `b`. The nose
/// runs `rho_a` left of the one and `rho_b` left of the other.
pub(super) fn meet(a: &Piece, rho_a: f64, b: &Piece, rho_b: f64) -> Result<Point, Fault> {
    match (&a.circle, &b.circle) {
        (None, None) => of_lines(left(a.exit), rho_a, left(b.entry), rho_b),
        (None, Some(circle)) => on_line(
            a.exit,
            rho_a,
            circle.center - b.start,
            circle.offset_radius(rho_b)?,
        )
        .ok_or(Fault::NoMeetingLineArc),
        (Some(circle), None) => on_line(
            b.entry,
            rho_b,
            circle.center - a.end,
            circle.offset_radius(rho_a)?,
        )
        .ok_or(Fault::NoMeetingArcLine),
        (Some(first), Some(second)) => of_arcs(
            first.center - a.end,
            first.offset_radius(rho_a)?,
            second.center - b.start,
            second.offset_radius(rho_b)?,
        ),
    }
}

/// Two lines with these normals, moved along them.
pub(super) fn of_lines(
    normal_a: Point,
    rho_a: f64,
    normal_b: Point,
    rho_b: f64,
) -> Result<Point, Fault> {
    let c = dot(normal_a, normal_b);
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

/// A line through P, moved left by `rho`, with a circle.
fn on_line(along: Point, rho: f64, center: Point, radius: f64) -> Option<Point> {
    let beside = left(along) * rho;
    let w = beside - center;
    let b = dot(w, along);
    let square = b * b - (dot(w, w) - radius * radius);
    if square < ROOT_OF_ZERO {
        return None;
    }
    let root = square.max(0.0).sqrt();
    // The nearer one to P is the one with the shorter way along the line.
    let way = if b > 0.0 { root - b } else { -b - root };
    Some(beside + along * way)
}

/// Two circles, their centres seen from P.
fn of_arcs(center_a: Point, radius_a: f64, center_b: Point, radius_b: f64) -> Result<Point, Fault> {
    let between = center_b - center_a;
    let d = between.length();
    let e = unit(between)
        .filter(|_| d > NO_ANGLE)
        .ok_or(Fault::DivisionByZero)?;
    let a = (radius_a * radius_a - radius_b * radius_b + d * d) / (2.0 * d);
    let square = radius_a * radius_a - a * a;
    if square < ROOT_OF_ZERO {
        return Err(Fault::NoMeetingOfArcs);
    }
    let foot = center_a + e * a;
    let height = left(e) * square.max(0.0).sqrt();
    let (one, other) = (foot + height, foot - height);
    Ok(if one.length() <= other.length() {
        one
    } else {
        other
    })
}
