//! Fits pitch curve and backlash of a screw to readings of several runs, by least squares.
//!
//! The curve is linear between knots. The backlash adds to readings that were approached
//! against the direction in which the control does not compensate backlash (006, 010; manual
//! III-12.8):
//!
//! ```text
//!   deviation = curve(target) + backlash · [direction] + residual
//! ```

use gsk_messages::{Message, say};
use nalgebra::{DMatrix, DVector};

use crate::measurement::{ApproachDirection, AxisDeviation, Measurement, SlideTravel};

/// Targets nearer to each other than this count as one, mm.
const SAME_TARGET_MM: f64 = 0.005;
const MAX_KNOTS: usize = 1000;
/// Smallest ratio of pivots. Below it the readings do not determine curve and backlash.
const MIN_PIVOT_RATIO: f64 = 1e-6;

/// Deviations along an axis (µm at positions in mm), linear between points and constant beyond
/// the ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DeviationCurve {
    points: Vec<(SlideTravel, AxisDeviation)>,
}

impl DeviationCurve {
    /// Builds the curve through these points, in any order.
    pub fn new(mut points: Vec<(SlideTravel, AxisDeviation)>) -> Self {
        points.sort_by(|one, other| one.0.0.total_cmp(&other.0.0));
        Self { points }
    }

    /// Returns the points of the curve, in ascending order of position.
    pub fn points(&self) -> &[(SlideTravel, AxisDeviation)] {
        &self.points
    }

    /// Returns the deviation at a position, interpolated; 0 for a curve without points.
    pub fn at(&self, position: SlideTravel) -> AxisDeviation {
        let after = self.points.partition_point(|(at, _)| at.0 <= position.0);
        let before = after.checked_sub(1).and_then(|it| self.points.get(it));
        match (before, self.points.get(after)) {
            (Some((one, low)), Some((next, high))) => {
                let share = (position.0 - one.0) / (next.0 - one.0);
                AxisDeviation(low.0 + share * (high.0 - low.0))
            }
            (Some((_, only)), None) | (None, Some((_, only))) => *only,
            (None, None) => AxisDeviation(0.0),
        }
    }

    /// Returns the lowest and highest position of the curve; 0 for a curve without points.
    pub fn range(&self) -> (SlideTravel, SlideTravel) {
        let ends = self.points.first().zip(self.points.last());
        ends.map_or(
            (SlideTravel(0.0), SlideTravel(0.0)),
            |((one, _), (other, _))| (*one, *other),
        )
    }
}

/// Pitch curve and backlash that fit the readings of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct ScrewFit {
    /// Deviation of the screw when approached in the direction without backlash compensation.
    pub curve: DeviationCurve,
    /// Backlash of the screw, µm; `None` if all readings have the same approach direction.
    pub backlash: Option<AxisDeviation>,
    /// Residuals of the readings, µm: root mean square, and largest.
    pub residual: (AxisDeviation, AxisDeviation),
    /// Slope of the curve, µm per metre. A large value means a wrong gear or lead.
    pub slope_um_per_m: f64,
}

/// Fits pitch curve and backlash to readings. `uncompensated` is the approach direction in
/// which the control does not compensate backlash.
///
/// # Errors
/// Fewer than 2 or more than 1000 targets, or readings that do not determine curve and
/// backlash.
pub fn fit_screw(
    measurement: &Measurement,
    uncompensated: ApproachDirection,
) -> Result<ScrewFit, Message> {
    let readings = &measurement.readings;
    let mut knots: Vec<f64> = readings.iter().map(|it| it.target.0).collect();
    knots.sort_by(f64::total_cmp);
    knots.dedup_by(|next, one| *next - *one < SAME_TARGET_MM);
    if knots.len() < 2 {
        return Err(say::pitch_too_few_targets());
    }
    if knots.len() > MAX_KNOTS {
        return Err(say::pitch_too_many_targets(knots.len(), MAX_KNOTS));
    }
    let has_both_directions = readings.iter().any(|it| it.direction == uncompensated)
        && readings.iter().any(|it| it.direction != uncompensated);
    let size = knots.len() + usize::from(has_both_directions);
    // Motion towards minus shows backlash as a deviation towards plus, and vice versa.
    let sign = match uncompensated {
        ApproachDirection::Plus => 1.0,
        ApproachDirection::Minus => -1.0,
    };
    let fit_terms = |target: f64, direction: ApproachDirection| {
        let after = knots.partition_point(|at| *at <= target);
        let mut terms = [(0, 0.0); 3];
        let low = after.saturating_sub(1);
        match (knots.get(low), knots.get(after)) {
            (Some(one), Some(next)) if after > 0 => {
                let share = (target - one) / (next - one);
                terms[0] = (low, 1.0 - share);
                terms[1] = (after, share);
            }
            _ => terms[0] = (low, 1.0),
        }
        if has_both_directions && direction != uncompensated {
            terms[2] = (size - 1, sign);
        }
        terms
    };
    // A reading has only three terms: the normal equations are built here, the library solves
    // them.
    let mut normal = DMatrix::<f64>::zeros(size, size);
    let mut right = DVector::<f64>::zeros(size);
    for reading in readings {
        let terms = fit_terms(reading.target.0, reading.direction);
        for (row, weight) in terms {
            right[row] += weight * reading.deviation.0;
            for (column, other) in terms {
                normal[(row, column)] += weight * other;
            }
        }
    }
    let undetermined = say::pitch_undetermined;
    let cholesky = normal.cholesky().ok_or_else(undetermined)?;
    let pivots = cholesky.l_dirty().diagonal();
    if pivots.min() < MIN_PIVOT_RATIO * pivots.max() {
        return Err(undetermined());
    }
    let solved = cholesky.solve(&right);
    let value = |index: usize| solved.get(index).copied().unwrap_or(0.0);
    let (mut squares, mut largest) = (0.0, 0.0_f64);
    for reading in readings {
        let terms = fit_terms(reading.target.0, reading.direction);
        let fitted: f64 = terms
            .iter()
            .map(|(index, weight)| weight * value(*index))
            .sum();
        let residual = reading.deviation.0 - fitted;
        squares += residual * residual;
        largest = largest.max(residual.abs());
    }
    let points = knots.iter().enumerate();
    let points = points.map(|(index, at)| (SlideTravel(*at), AxisDeviation(value(index))));
    let curve = DeviationCurve::new(points.collect());
    Ok(ScrewFit {
        slope_um_per_m: mean_slope(&curve),
        curve,
        backlash: has_both_directions.then(|| AxisDeviation(value(size - 1))),
        residual: (
            AxisDeviation((squares / readings.len() as f64).sqrt()),
            AxisDeviation(largest),
        ),
    })
}

/// Returns the slope of the regression line through the points, µm per metre.
fn mean_slope(curve: &DeviationCurve) -> f64 {
    let points = curve.points();
    let count = points.len() as f64;
    let mean_at = points.iter().map(|(at, _)| at.0).sum::<f64>() / count;
    let mean = points.iter().map(|(_, value)| value.0).sum::<f64>() / count;
    let (mut products, mut squares) = (0.0, 0.0);
    for (at, value) in points {
        products += (at.0 - mean_at) * (value.0 - mean);
        squares += (at.0 - mean_at) * (at.0 - mean_at);
    }
    products / squares * 1000.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measurement::AxisReading;

    fn reading(target: f64, direction: ApproachDirection, deviation: f64) -> AxisReading {
        AxisReading {
            run: 1,
            target: SlideTravel(target),
            direction,
            deviation: AxisDeviation(deviation),
        }
    }

    /// A screw with 5 µm at -100 mm and 12 µm backlash. One run each way; the second half of
    /// the return is missing.
    #[test]
    fn fit_separates_curve_and_backlash() {
        let true_curve = |at: f64| -at * 0.05;
        for uncompensated in [ApproachDirection::Plus, ApproachDirection::Minus] {
            let mut readings = Vec::new();
            for index in 0..=10 {
                let at = -10.0 * f64::from(index);
                let against = match uncompensated {
                    ApproachDirection::Plus => 12.0,
                    ApproachDirection::Minus => -12.0,
                };
                readings.push(reading(at, uncompensated, true_curve(at)));
                if index < 6 {
                    readings.push(reading(at, uncompensated.other(), true_curve(at) + against));
                }
            }
            let measured = Measurement {
                axis: None,
                readings,
            };
            let fit = fit_screw(&measured, uncompensated).unwrap();
            assert!((fit.backlash.unwrap().0 - 12.0).abs() < 1e-9);
            assert!((fit.curve.at(SlideTravel(-35.0)).0 - 1.75).abs() < 1e-9);
            assert!(fit.residual.1.0 < 1e-9 && (fit.slope_um_per_m + 50.0).abs() < 1e-9);
        }
    }

    #[test]
    fn fit_averages_runs() {
        let readings = vec![
            reading(0.0, ApproachDirection::Plus, 0.0),
            reading(10.0, ApproachDirection::Plus, 3.0),
            reading(10.0, ApproachDirection::Plus, 5.0),
        ];
        let fit = fit_screw(
            &Measurement {
                axis: None,
                readings,
            },
            ApproachDirection::Plus,
        )
        .unwrap();
        assert_eq!(fit.backlash, None);
        assert!((fit.curve.at(SlideTravel(10.0)).0 - 4.0).abs() < 1e-9);
        assert!((fit.residual.1.0 - 1.0).abs() < 1e-9);
    }

    #[test]
    fn undetermined_readings_are_refused() {
        let none = Measurement::default();
        assert!(fit_screw(&none, ApproachDirection::Plus).is_err());
        // No target is approached from both sides: backlash and curve are not separable.
        let readings = vec![
            reading(0.0, ApproachDirection::Plus, 0.0),
            reading(10.0, ApproachDirection::Minus, 3.0),
            reading(20.0, ApproachDirection::Plus, 3.0),
        ];
        assert!(
            fit_screw(
                &Measurement {
                    axis: None,
                    readings
                },
                ApproachDirection::Plus
            )
            .is_err()
        );
    }
}
