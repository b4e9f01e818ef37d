//! The grid of all geometry here: whole tenths of a micrometre.
//!
//! Boolean operations on whole numbers are exact up to one rounding of each crossing,
//! and give the same bits on every platform. In the half section Z is the first
//! coordinate and X, a radius, the second:
//!
//! ```text
//!   X (radius)  GridPoint.y
//!   ^
//!   |
//!   +----------> Z  GridPoint.x
//! ```

use gsk_units::Point;
use i_overlay::i_float::int::point::IntPoint;

/// A point of the half section, tenths of a micrometre.
pub type GridPoint = IntPoint<i32>;

/// A closed polygon; its last point is joined to its first.
pub type Contour = Vec<GridPoint>;

/// Grid units in a millimetre.
pub const PER_MM: f64 = 10_000.0;

/// Nothing lies farther out, mm: the boolean operations need the rest of the number.
const FARTHEST_MM: f64 = 50_000.0;

/// The nearest grid coordinate of a length, mm.
pub fn grid(mm: f64) -> i32 {
    // Not a number becomes 0, as in every cast.
    libm::round(mm.clamp(-FARTHEST_MM, FARTHEST_MM) * PER_MM) as i32
}

/// A grid coordinate in mm.
pub fn mm(grid: i32) -> f64 {
    f64::from(grid) / PER_MM
}

/// The nearest grid point.
pub fn to_grid(point: Point) -> GridPoint {
    GridPoint::new(grid(point.z), grid(point.x))
}

/// A grid point in mm.
pub fn from_grid(point: GridPoint) -> Point {
    Point::new(mm(point.y), mm(point.x))
}

/// Twice the area of the triangle of three points: greater than 0 when they turn
/// counter-clockwise.
pub(crate) fn turn(a: GridPoint, b: GridPoint, c: GridPoint) -> i64 {
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

/// A point moved by a displacement; saturates at the end of the grid.
pub(crate) fn moved(point: GridPoint, by: GridPoint) -> GridPoint {
    GridPoint::new(point.x.saturating_add(by.x), point.y.saturating_add(by.y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_goes_to_the_nearest_tenth_of_a_micrometre_and_back() {
        assert_eq!(grid(0.123_46), 1235);
        assert_eq!(grid(-0.000_04), 0);
        assert_eq!(mm(grid(-27.5)), -27.5);
        assert_eq!(grid(f64::NAN), 0);
        assert_eq!(grid(1e300), 500_000_000);
    }
}
