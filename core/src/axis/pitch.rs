//! Pitch error compensation: the error of the screw by machine position (003.5, 013, 090,
//! 091, 094, 095, 098, 099, 102, 103; manual III-10).
//!
//! ```text
//!  point    R-2      R-1       R       R+1      R+2
//!  ──────────┴────────┴────────┴────────┴────────┴────► machine position
//!             -(v[R])           0       v[R+1]   v[R+1] + v[R+2]
//!           at and beyond      between  at and   at and beyond
//!           the point          the two  beyond
//! ```

use serde::{Deserialize, Serialize};

use crate::memory::{ControlParameters, PitchTable};
use crate::units::Axis;

const POINTS: usize = 256;

/// Pitch error corrections of one axis by machine position. Empty when the compensation
/// is off.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PitchCurve {
    /// Correction at each point of the table, increments; 0 at the reference point.
    sums: Vec<i32>,
    /// Number of the table point at the reference position, 0–255.
    origin: i64,
    /// Distance between two points of the table, increments.
    interval: i64,
}

impl PitchCurve {
    /// Builds the curve from parameters and table. `per_thousandth` is the number of least
    /// output increments in 0.001 mm (or 0.0001 inch); with 1, positions and corrections
    /// count in 0.001 mm.
    pub fn new(
        axis: Axis,
        parameters: &ControlParameters,
        table: &PitchTable,
        per_thousandth: i64,
    ) -> Self {
        let interval = parameters.pitch_interval(axis) * per_thousandth;
        if !parameters.is_pitch_compensated() || interval == 0 || table.is_flat(axis) {
            return Self::default();
        }
        let origin = parameters.pitch_origin(axis);
        let factor = parameters.pitch_factor() * per_thousandth as i32;
        let counts = parameters.pitch_points(axis);
        let table_value = |point: usize| match counts.contains(&point) {
            true => i32::from(table.value(axis, point as u8)) * factor,
            false => 0,
        };
        let reference = usize::from(origin);
        let mut sums = vec![0; POINTS];
        for point in reference + 1..POINTS {
            sums[point] = sums[point - 1] + table_value(point);
        }
        for point in (0..reference).rev() {
            sums[point] = sums[point + 1] - table_value(point + 1);
        }
        Self {
            sums,
            origin: origin.into(),
            interval,
        }
    }

    /// Whether the curve makes no correction.
    pub const fn is_off(&self) -> bool {
        self.sums.is_empty()
    }

    /// Correction at a machine position, both in increments. Beyond the table the
    /// correction of the last point stays.
    pub fn correction_at(&self, position: i64) -> i64 {
        if self.interval == 0 {
            return 0;
        }
        let point = (self.origin + position / self.interval).clamp(0, POINTS as i64 - 1);
        self.sums.get(point as usize).copied().unwrap_or(0).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Z, interval 10 mm, factor 1: the table from `first` on.
    fn curve(origin: i32, first: u8, values: &[i16]) -> PitchCurve {
        let mut parameters = ControlParameters::default();
        parameters.set(99, origin).unwrap();
        let mut table = PitchTable::default();
        for (point, value) in (first..=255).zip(values) {
            table.set(Axis::Z, point, *value).unwrap();
        }
        PitchCurve::new(Axis::Z, &parameters, &table, 1)
    }

    fn correction_between(curve: &PitchCurve, from: i64, to: i64) -> i64 {
        curve.correction_at(to * 1000) - curve.correction_at(from * 1000)
    }

    /// The three examples of the manual (III-10.4).
    #[test]
    fn examples_of_the_manual() {
        let positive = curve(0, 1, &[7, -6, 4]);
        assert_eq!(correction_between(&positive, 0, 30), 5);
        let middle = curve(127, 125, &[-7, -7, 6, 4]);
        assert_eq!(correction_between(&middle, -30, 10), -4);
        let negative = curve(255, 252, &[3, -7, 0, 2]);
        assert_eq!(correction_between(&negative, -40, 0), -2);
    }

    #[test]
    fn a_point_acts_when_it_is_reached() {
        let curve = curve(127, 127, &[6, 4]);
        assert_eq!(curve.correction_at(9_999), 0);
        assert_eq!(curve.correction_at(10_000), 4);
        assert_eq!(curve.correction_at(-9_999), 0);
        assert_eq!(curve.correction_at(-10_000), -6);
        assert_eq!(
            (
                curve.correction_at(9_000_000),
                curve.correction_at(-9_000_000)
            ),
            (4, -6)
        );
    }

    #[test]
    fn parameters_switch_and_scale_it() {
        let mut parameters = ControlParameters::default();
        let mut table = PitchTable::default();
        table.set(Axis::X, 1, 10).unwrap();
        // X counts 0.0005 mm: two increments a µm, 20000 from point to point.
        let at = |parameters: &ControlParameters| {
            PitchCurve::new(Axis::X, parameters, &table, 2).correction_at(20_000)
        };
        assert_eq!(at(&parameters), 20);
        for (bits, factor) in [(1, 2), (2, 4), (3, 8), (4, 16), (7, 16)] {
            parameters.set(13, bits).unwrap();
            assert_eq!(at(&parameters), 20 * factor);
        }
        parameters.set(13, 0).unwrap();
        parameters.set(102, 5000).unwrap();
        assert_eq!(at(&parameters), 20);
        parameters.set(102, 0).unwrap();
        assert_eq!(at(&parameters), 0);
        parameters.set(102, 10_000).unwrap();
        parameters.set_bit(3, 5, false).unwrap();
        assert_eq!(at(&parameters), 0);
    }
}
