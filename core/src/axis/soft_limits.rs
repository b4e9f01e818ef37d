//! Software travel limits 045–048 (manual III-2.5.2).

use serde::{Deserialize, Serialize};

use crate::memory::ControlParameters;
use crate::units::{Axis, PerAxis, Point};

/// The software travel limits in machine coordinates, mm; computed again when a
/// parameter changes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SoftLimits {
    plus: Point,
    minus: Point,
    /// Distance that an axis may pass its limit, mm: rapid rate in m/min divided by 5.
    tolerance: Point,
}

impl SoftLimits {
    /// Computes the limits from 045–048, 022 and 023; X is given as a diameter unless 001.2
    /// = 1.
    pub fn new(parameters: &ControlParameters) -> Self {
        let (plus_x, minus_x) = parameters.soft_limits(Axis::X);
        let (plus_z, minus_z) = parameters.soft_limits(Axis::Z);
        let tolerance = |axis| parameters.rapid_rate(axis) / 1000.0 / 5.0;
        Self {
            plus: Point::new(plus_x, plus_z),
            minus: Point::new(minus_x, minus_z),
            tolerance: Point::new(tolerance(Axis::X), tolerance(Axis::Z)),
        }
    }

    /// Whether a machine coordinate (mm) is beyond a limit of an axis: the positive one if
    /// `plus`, else the negative one. A coordinate equal to its limit is allowed.
    pub(crate) fn is_beyond(&self, axis: Axis, plus: bool, coordinate: f64) -> bool {
        if plus {
            coordinate - self.plus.get(axis) > 1e-6
        } else {
            self.minus.get(axis) - coordinate > 1e-6
        }
    }

    /// Whether all limits are farther than a distance (mm) from a point: motion within that
    /// distance cannot overrun them.
    pub(crate) fn are_farther_than(&self, point: Point, distance: f64) -> bool {
        point.x + distance <= self.plus.x
            && point.x - distance >= self.minus.x
            && point.z + distance <= self.plus.z
            && point.z - distance >= self.minus.z
    }

    /// Whether a watched axis overruns its limit, for X+, X-, Z+ and Z-: it moves outwards
    /// beyond the limit, or its stopping point `stop` is farther beyond than the tolerance.
    pub(crate) fn overrun_limits(
        &self,
        position: Point,
        stop: Point,
        watched: PerAxis<bool>,
    ) -> [bool; 4] {
        let beyond = |axis: Axis, sign: f64, limit: Point| {
            let excess = |point: Point| (point.get(axis) - limit.get(axis)) * sign;
            let outwards = excess(stop) > excess(position);
            *watched.get(axis)
                && (outwards && excess(position) > 1e-6
                    || excess(stop) > self.tolerance.get(axis) + 1e-6)
        };
        [
            beyond(Axis::X, 1.0, self.plus),
            beyond(Axis::X, -1.0, self.minus),
            beyond(Axis::Z, 1.0, self.plus),
            beyond(Axis::Z, -1.0, self.minus),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: SoftLimits = SoftLimits {
        plus: Point::new(10.0, 20.0),
        minus: Point::new(-10.0, -20.0),
        tolerance: Point::new(0.76, 1.52),
    };
    const BOTH: PerAxis<bool> = PerAxis::new(true, true);
    const NONE: [bool; 4] = [false; 4];

    #[test]
    fn a_stop_that_cannot_keep_the_tolerance_alarms_early() {
        let at = Point::new(0.0, 15.0);
        assert_eq!(LIMITS.overrun_limits(at, Point::new(0.0, 21.0), BOTH), NONE);
        assert_eq!(
            LIMITS.overrun_limits(at, Point::new(0.0, 22.0), BOTH),
            [false, false, true, false]
        );
        assert_eq!(
            LIMITS.overrun_limits(at, Point::new(0.0, 22.0), PerAxis::new(true, false)),
            NONE
        );
    }

    #[test]
    fn stops_far_from_all_limits_overrun_none() {
        let distances = [0.0, 0.5, 3.0, 12.0];
        let coordinates = [-21.0, -9.9, 0.0, 7.2, 10.0, 19.5];
        for (x, z) in coordinates
            .iter()
            .flat_map(|x| coordinates.map(|z| (*x, z)))
        {
            let at = Point::new(x, z);
            for distance in distances
                .iter()
                .filter(|way| LIMITS.are_farther_than(at, **way))
            {
                for side in [Point::new(*distance, 0.0), Point::new(0.0, *distance)] {
                    assert_eq!(
                        LIMITS.overrun_limits(at, at + side, BOTH),
                        NONE,
                        "{at:?} {distance}"
                    );
                    assert_eq!(
                        LIMITS.overrun_limits(at, at - side, BOTH),
                        NONE,
                        "{at:?} {distance}"
                    );
                }
            }
        }
        assert!(LIMITS.are_farther_than(Point::new(7.0, 17.0), 3.0));
        assert!(!LIMITS.are_farther_than(Point::new(7.1, 0.0), 3.0));
        assert!(!LIMITS.are_farther_than(Point::new(0.0, -17.1), 3.0));
    }

    #[test]
    fn only_beyond_a_limit_there_is_an_alarm() {
        let edge = Point::new(-10.0, -20.0);
        assert_eq!(LIMITS.overrun_limits(edge, edge, BOTH), NONE);
        let beyond = Point::new(-10.001, 0.0);
        let further = Point::new(-10.002, 0.0);
        let alarm = [false, true, false, false];
        assert_eq!(LIMITS.overrun_limits(beyond, further, BOTH), alarm);
        // The way back is free.
        assert_eq!(LIMITS.overrun_limits(further, beyond, BOTH), NONE);
    }
}
