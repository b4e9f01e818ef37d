//! Angles in the plane of the part.

use crate::units::Point;

/// The angle from one direction to another, rad, 0 up to a full turn. `turn` is the sense of
/// rotation: +1 counter-clockwise, -1 clockwise.
pub(super) fn sweep(from: Point, to: Point, turn: f64) -> f64 {
    use core::f64::consts::TAU;
    let angle = libm::atan2(from.cross(to), from.dot(to)) * turn;
    if angle < 0.0 { angle + TAU } else { angle }
}
