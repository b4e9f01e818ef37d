//! The correction that the pitch error table of a control makes (003.5, 013, 090–103; manual
//! III-10).

use gsk_core::axis::PitchCurve;
use gsk_core::memory::{Parameters, PitchTable};
use gsk_core::units::Axis;

use crate::fit::Curve;
use crate::measurement::{Deviation, Travel};

/// The last point of the table.
pub(crate) const LAST: i64 = 255;
/// The largest value of a point.
pub(crate) const LARGEST: i64 = 255;
/// The largest backlash, 034 and 035.
pub(crate) const LARGEST_BACKLASH: f64 = 2000.0;

/// Units of the table in a millimetre: 0.001 mm, or 0.0001 inch.
pub(crate) fn units_a_mm(parameters: &Parameters) -> f64 {
    1.0 / parameters.least_increment()
}

/// The interval of an axis as it stands; none: there is no compensation.
pub fn interval_of(axis: Axis, parameters: &Parameters) -> Option<Travel> {
    let interval = parameters.pitch_interval(axis);
    (interval > 0).then(|| Travel(interval as f64 / units_a_mm(parameters)))
}

/// The correction that is in force, at each of these positions.
pub fn correction(
    axis: Axis,
    parameters: &Parameters,
    pitch: &PitchTable,
    positions: impl IntoIterator<Item = Travel>,
) -> Curve {
    let curve = PitchCurve::new(axis, parameters, pitch, 1);
    let units = units_a_mm(parameters);
    let points = positions.into_iter().map(|at| {
        let value = curve.at((at.0 * units).round() as i64) as f64;
        (at, Deviation(value * 1000.0 / units))
    });
    Curve::new(points.collect())
}
