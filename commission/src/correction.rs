//! Computes the correction of the current pitch error table (parameters 003.5, 013, 090 to 103;
//! manual III-10).

use gsk_core::axis::PitchCurve;
use gsk_core::memory::{ControlParameters, PitchTable};
use gsk_core::units::Axis;

use crate::measurement::{AxisDeviation, SlideTravel};
use crate::screw_fit::DeviationCurve;

/// Number of the last point in the pitch error table.
pub(crate) const LAST_POINT: i64 = 255;
/// Largest absolute value of a point, in table units.
pub(crate) const MAX_POINT_VALUE: i64 = 255;
/// Largest value of the backlash parameters 034 and 035, in table units.
pub(crate) const MAX_BACKLASH: f64 = 2000.0;

/// Returns the number of table units in a millimetre. A unit is 0.001 mm or 0.0001 inch.
pub(crate) fn units_per_mm(parameters: &ControlParameters) -> f64 {
    1.0 / parameters.least_increment_mm()
}

/// Returns the distance between two points of an axis's pitch error table; `None` if it is 0,
/// which turns the compensation off.
pub fn pitch_interval(axis: Axis, parameters: &ControlParameters) -> Option<SlideTravel> {
    let interval = parameters.pitch_interval(axis);
    (interval > 0).then(|| SlideTravel(interval as f64 / units_per_mm(parameters)))
}

/// Returns the correction that the control applies at each of these positions.
pub fn compute_correction(
    axis: Axis,
    parameters: &ControlParameters,
    pitch: &PitchTable,
    positions: impl IntoIterator<Item = SlideTravel>,
) -> DeviationCurve {
    let curve = PitchCurve::new(axis, parameters, pitch, 1);
    let units = units_per_mm(parameters);
    let points = positions.into_iter().map(|at| {
        let value = curve.correction_at((at.0 * units).round() as i64) as f64;
        (at, AxisDeviation(value * 1000.0 / units))
    });
    DeviationCurve::new(points.collect())
}
