//! Vectors in the plane of the part.
//!
//! ```text
//!   X (radius)        turn from a to b counter-clockwise: cross > 0
//!   ^   left(t)
//!   |     ^           left(t): t turned by a quarter counter-clockwise
//!   |     |
//!   |     +----> t
//!   +-----------------> Z
//! ```

use crate::units::Point;

pub(super) const fn dot(a: Point, b: Point) -> f64 {
    a.z * b.z + a.x * b.x
}

pub(super) const fn cross(a: Point, b: Point) -> f64 {
    a.z * b.x - a.x * b.z
}

/// A quarter turn counter-clockwise.
pub(super) const fn left(t: Point) -> Point {
    Point::new(t.z, -t.x)
}

/// The direction of a displacement; `None` without one.
pub(super) fn unit(v: Point) -> Option<Point> {
    let length = v.length();
    (length > 0.0 && length.is_finite()).then(|| v * (1.0 / length))
}

/// The angle from one direction to another in a sense of rotation (+1
/// counter-clockwise), rad, 0 up to a full turn.
pub(super) fn sweep(from: Point, to: Point, turn: f64) -> f64 {
    use core::f64::consts::TAU;
    let angle = libm::atan2(cross(from, to), dot(from, to)) * turn;
    if angle < 0.0 { angle + TAU } else { angle }
}
