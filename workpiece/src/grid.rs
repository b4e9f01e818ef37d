//! The integer grid of the geometry; one unit is a tenth of a micrometre.
//!
//! Boolean operations on integers round each crossing once and give the same bits on
//! every platform. In the half section Z is the first coordinate; X, a radius, is the
//! second:
//!
//! ```text
//!   X (radius)  GridPoint.y
//!   ^
//!   |
//!   +----------> Z  GridPoint.x
//! ```

use gsk_units::Point;
use i_overlay::i_float::int::point::IntPoint;

/// A point of the half section in grid units: `x` holds Z, `y` holds X as a radius.
pub type GridPoint = IntPoint<i32>;

/// A closed polygon; an edge joins its last point to its first.
pub type GridContour = Vec<GridPoint>;

/// Number of grid units per millimetre.
pub const PER_MM: f64 = 10_000.0;

/// Greatest coordinate, mm: the boolean operations need the upper bits of the integer.
const MAX_COORDINATE_MM: f64 = 50_000.0;

/// Rounds a length in mm to grid units. Lengths beyond ±50 m are clamped, NaN gives 0.
pub fn grid(mm: f64) -> i32 {
    libm::round(mm.clamp(-MAX_COORDINATE_MM, MAX_COORDINATE_MM) * PER_MM) as i32
}

/// Converts grid units to mm.
pub fn mm(grid: i32) -> f64 {
    f64::from(grid) / PER_MM
}

/// Rounds a point in mm to grid units.
pub fn to_grid(point: Point) -> GridPoint {
    GridPoint::new(grid(point.z), grid(point.x))
}

/// Converts a point in grid units to mm.
pub fn from_grid(point: GridPoint) -> Point {
    Point::new(mm(point.y), mm(point.x))
}

/// Twice the signed area of the triangle of three points: positive if they turn
/// counter-clockwise.
pub(crate) fn orientation(a: GridPoint, b: GridPoint, c: GridPoint) -> i64 {
    let (bx, by) = (
        i64::from(b.x) - i64::from(a.x),
        i64::from(b.y) - i64::from(a.y),
    );
    let (cx, cy) = (
        i64::from(c.x) - i64::from(a.x),
        i64::from(c.y) - i64::from(a.y),
    );
    bx * cy - by * cx
}

/// Adds a displacement to a point; saturates at the limits of the integer.
pub(crate) fn translated(point: GridPoint, by: GridPoint) -> GridPoint {
    GridPoint::new(point.x.saturating_add(by.x), point.y.saturating_add(by.y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_is_rounded_to_the_nearest_tenth_of_a_micrometre() {
        assert_eq!(grid(0.123_46), 1235);
        assert_eq!(grid(-0.000_04), 0);
        assert_eq!(mm(grid(-27.5)), -27.5);
        assert_eq!(grid(f64::NAN), 0);
        assert_eq!(grid(1e300), 500_000_000);
    }
}
