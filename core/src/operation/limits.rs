//! Alarms of the software travel limits 045 to 048 (manual III-3.5.2).

use super::manual::AxisDirection;
use crate::alarm::number;
use crate::units::Axis;

/// Number of the overtravel alarm for an axis and a direction.
pub(crate) const fn travel_alarm(axis: Axis, direction: AxisDirection) -> u16 {
    match (axis, direction) {
        (Axis::X, AxisDirection::Plus) => number::X_PLUS_LIMIT,
        (Axis::X, AxisDirection::Minus) => number::X_MINUS_LIMIT,
        (Axis::Z, AxisDirection::Plus) => number::Z_PLUS_LIMIT,
        (Axis::Z, AxisDirection::Minus) => number::Z_MINUS_LIMIT,
    }
}
