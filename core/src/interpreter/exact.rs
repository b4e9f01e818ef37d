//! Positions as integers, so that a chain of increments never drifts.

use serde::{Deserialize, Serialize};

use crate::model::ModelRecord;
use crate::units::{Axis, Point};

/// Number of units of [`ExactPoint`] in a millimetre.
pub(crate) const UNITS_PER_MM: i64 = 1_000_000;

/// The smallest `greatest_coordinate` of all models, 9999.999 mm, in units of [`ExactPoint`]:
/// that of the GSK980TD (manual I-2.2.3).
const MIN_STROKE: i64 = 9_999_999 * (UNITS_PER_MM / 1000);

/// The data that determine the greatest coordinate that a program may command.
#[derive(Clone, Copy)]
pub(crate) struct CoordinateRange<'a> {
    /// Factor from a programmed X to a diameter: 2 under radius programming (001.2), else 1.
    pub(crate) x_factor: i64,
    /// The data of the control model that the program is for.
    pub(crate) record: &'a ModelRecord,
}

impl CoordinateRange<'_> {
    /// The greatest absolute coordinate that a program may command, units of [`ExactPoint`].
    pub(crate) fn stroke(self) -> i64 {
        self.record.greatest_coordinate * (UNITS_PER_MM / 1000)
    }
}

/// A point or displacement in millionths of a millimetre, X as a *diameter*.
///
/// Every number that a program can contain is an integer in this unit, and its radius an integer in
/// half units. So end points are exactly the programmed ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct ExactPoint {
    pub(crate) x: i64,
    pub(crate) z: i64,
}

impl ExactPoint {
    pub(crate) const fn new(x: i64, z: i64) -> Self {
        Self { x, z }
    }

    /// Converts a point in mm, X as a radius, to the nearest exact point.
    pub(crate) fn from_point(point: Point) -> Self {
        Self::new(
            round_to_units(point.x * (2 * UNITS_PER_MM) as f64),
            round_to_units(point.z * UNITS_PER_MM as f64),
        )
    }

    /// Converts to a point in mm, X as a radius.
    pub(crate) fn to_point(self) -> Point {
        Point::new(
            self.x as f64 / (2 * UNITS_PER_MM) as f64,
            self.z as f64 / UNITS_PER_MM as f64,
        )
    }

    pub(crate) const fn get(self, axis: Axis) -> i64 {
        match axis {
            Axis::X => self.x,
            Axis::Z => self.z,
        }
    }

    pub(crate) const fn set(&mut self, axis: Axis, value: i64) {
        match axis {
            Axis::X => self.x = value,
            Axis::Z => self.z = value,
        }
    }

    /// The first axis whose programmed coordinate is outside the stroke of the control; `None`
    /// if both are inside.
    pub(crate) fn axis_beyond_stroke(self, range: CoordinateRange<'_>) -> Option<Axis> {
        let find_axis_beyond = |stroke: i64| {
            if self.x.abs() > stroke * range.x_factor {
                return Some(Axis::X);
            }
            (self.z.abs() > stroke).then_some(Axis::Z)
        };
        // Almost every end point lies within the smallest stroke.
        find_axis_beyond(MIN_STROKE).and_then(|_| find_axis_beyond(range.stroke()))
    }
}

impl core::ops::Add for ExactPoint {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(
            self.x.saturating_add(other.x),
            self.z.saturating_add(other.z),
        )
    }
}

impl core::ops::Sub for ExactPoint {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(
            self.x.saturating_sub(other.x),
            self.z.saturating_sub(other.z),
        )
    }
}

/// `value * numerator / denominator`, rounded half away from zero; 0 for a denominator of 0.
pub(crate) fn scale_rounded(value: i64, numerator: i64, denominator: i64) -> i64 {
    if denominator == 0 {
        return 0;
    }
    let (product, divisor) = (
        i128::from(value) * i128::from(numerator),
        i128::from(denominator),
    );
    let half = divisor.abs() / 2 * product.signum();
    i64::try_from((product + half) / divisor).unwrap_or(i64::MAX)
}

/// Rounds to the nearest integer, half away from zero; NaN becomes 0.
pub(crate) fn round_to_units(value: f64) -> i64 {
    libm::round(value) as i64
}

/// Converts a length from units of [`ExactPoint`] to millimetres.
pub(crate) fn to_mm(units: i64) -> f64 {
    units as f64 / UNITS_PER_MM as f64
}

/// Converts a length to a displacement of an [`ExactPoint`] along `axis`, in the same units:
/// along X a length is a radius and the displacement a diameter, twice as great.
pub(crate) const fn length_on_axis(axis: Axis, length: i64) -> i64 {
    match axis {
        Axis::X => length.saturating_mul(2),
        Axis::Z => length,
    }
}
