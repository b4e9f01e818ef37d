//! G90 and G94 under G41 or G42: the four legs of the box are offset from the tip towards
//! the nose centre, on either side (manual II, C compensation).
//!
//! ```text
//!   C . . . . . . . . A        u = from the tip to the centre
//!   . D-------------A .        a leg moves by r along its normal m with
//!   . |             | .        m·u > 0; a leg along u stays
//!   . C-------------B .        the tip: the corner of the moved legs + tip
//! ```
//!
//! Legs along the axes leave the tip on the programmed path: only tapers differ.

use super::intersection::intersect_lines;
use super::nose::Nose;

use super::round_to_increment;
use crate::units::Point;

/// Dot product of the unit normal of a leg with the direction to the tip below which the leg counts
/// as parallel to that direction.
const PARALLEL: f64 = 1e-9;

/// Returns the tip positions at the corners B, C, D and A (again) of a box that begins at `start`
/// (A), mm. `corners` are the programmed corners, in the same order; the last one is returned
/// unchanged.
pub(crate) fn box_corners(start: Point, corners: [Point; 4], nose: Nose) -> [Point; 4] {
    if nose.radius == 0.0 {
        return corners;
    }
    let mut tips = corners;
    let mut from = start;
    for (index, tip) in tips.iter_mut().enumerate().take(3) {
        let corner = corners[index];
        let next = corners[index + 1];
        *tip = leg_corner(from, corner, next, nose);
        from = corner;
    }
    tips
}

fn leg_corner(from: Point, corner: Point, next: Point, nose: Nose) -> Point {
    let before = leg_offset(corner - from, nose);
    let after = leg_offset(next - corner, nose);
    let moved = match (before, after) {
        (Some((normal_a, by_a)), Some((normal_b, by_b))) => {
            intersect_lines(normal_a, by_a, normal_b, by_b).unwrap_or(normal_a * by_a)
        }
        (Some((normal, by)), None) | (None, Some((normal, by))) => normal * by,
        (None, None) => return corner,
    };
    round_to_increment(corner + moved + nose.tip_vector())
}

/// The unit normal of a leg on the side of the nose centre, and the distance by which the leg is
/// offset along it, mm; `None` for a leg without length.
fn leg_offset(leg: Point, nose: Nose) -> Option<(Point, f64)> {
    let normal = leg.unit()?.left();
    let toward = -normal.dot(nose.tip_signs());
    if toward.abs() < PARALLEL {
        return Some((normal, 0.0));
    }
    Some((normal * toward.signum(), nose.radius.abs()))
}
