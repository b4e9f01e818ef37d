//! Alarms of the software travel limits 045 to 048 (manual III-3.5.2).

use super::manual::Direction;
use crate::alarm::number;
use crate::units::Axis;

/// The overtravel alarm for an axis and a direction.
pub(crate) const fn travel_alarm(axis: Axis, way: Direction) -> u16 {
    match (axis, way) {
        (Axis::X, Direction::Plus) => number::X_PLUS_LIMIT,
        (Axis::X, Direction::Minus) => number::X_MINUS_LIMIT,
        (Axis::Z, Direction::Plus) => number::Z_PLUS_LIMIT,
        (Axis::Z, Direction::Minus) => number::Z_MINUS_LIMIT,
    }
}
