//! The curve of a screw and its play from readings of several runs, by least squares.
//!
//! A reading is the curve at its target, straight from knot to knot, and the play where it
//! was approached against the direction in which the control makes up for nothing (006, 010;
//! manual III-12.8):
//!
//! ```text
//!   deviation = curve(target) + play · [direction] + what is left
//! ```

use gsk_messages::{Message, say};
use nalgebra::{DMatrix, DVector};

use crate::measurement::{Deviation, Direction, Measurement, Travel};

/// Targets nearer to each other are one, mm.
const SAME_TARGET_MM: f64 = 0.005;
/// Most targets of a curve.
const MOST_KNOTS: usize = 1000;
/// A pivot below this part of the largest means that the readings do not settle it.
const LEAST_PIVOT: f64 = 1e-6;

/// Deviations along an axis: straight from point to point, beyond the last ones level.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    points: Vec<(Travel, Deviation)>,
}

impl Curve {
    /// Through these points, sorted by position.
    pub fn new(mut points: Vec<(Travel, Deviation)>) -> Self {
        points.sort_by(|one, other| one.0.0.total_cmp(&other.0.0));
        Self { points }
    }

    /// Its points, from minus to plus.
    pub fn points(&self) -> &[(Travel, Deviation)] {
        &self.points
    }

    /// The deviation at a position.
    pub fn at(&self, position: Travel) -> Deviation {
        let after = self.points.partition_point(|(at, _)| at.0 <= position.0);
        let before = after.checked_sub(1).and_then(|it| self.points.get(it));
        match (before, self.points.get(after)) {
            (Some((one, low)), Some((next, high))) => {
                let share = (position.0 - one.0) / (next.0 - one.0);
                Deviation(low.0 + share * (high.0 - low.0))
            }
            (Some((_, only)), None) | (None, Some((_, only))) => *only,
            (None, None) => Deviation(0.0),
        }
    }

    /// The first and the last position.
    pub fn range(&self) -> (Travel, Travel) {
        let ends = self.points.first().zip(self.points.last());
        ends.map_or((Travel(0.0), Travel(0.0)), |((one, _), (other, _))| {
            (*one, *other)
        })
    }
}

/// What readings say of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The deviation of the screw when it is approached in the direction in which the
    /// control makes up for nothing.
    pub curve: Curve,
    /// The play; none where all readings come from one side.
    pub backlash: Option<Deviation>,
    /// What is left of the readings: root of the mean square, and the largest.
    pub left: (Deviation, Deviation),
    /// How much the curve rises along the axis, µm a metre: a wrong gear or lead.
    pub slope: f64,
}

/// Fits readings. `free`: the direction of motion in which the control makes up for nothing.
///
/// # Errors
/// Too few readings, too many targets, readings that do not settle curve and play.
pub fn fit(measurement: &Measurement, free: Direction) -> Result<Fit, Message> {
    let readings = &measurement.readings;
    let mut knots: Vec<f64> = readings.iter().map(|it| it.target.0).collect();
    knots.sort_by(f64::total_cmp);
    knots.dedup_by(|next, one| *next - *one < SAME_TARGET_MM);
    if knots.len() < 2 {
        return Err(say::pitch_too_few_targets());
    }
    if knots.len() > MOST_KNOTS {
        return Err(say::pitch_too_many_targets(knots.len(), MOST_KNOTS));
    }
    let both = readings.iter().any(|it| it.direction == free)
        && readings.iter().any(|it| it.direction != free);
    let size = knots.len() + usize::from(both);
    // Going minus the play shows as a deviation towards plus, and the other way round.
    let sign = match free {
        Direction::Plus => 1.0,
        Direction::Minus => -1.0,
    };
    let terms = |target: f64, direction: Direction| {
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
        if both && direction != free {
            terms[2] = (size - 1, sign);
        }
        terms
    };
    // The normal equations: a reading has three terms, so they are made by hand, and solved
    // by the library.
    let mut normal = DMatrix::<f64>::zeros(size, size);
    let mut right = DVector::<f64>::zeros(size);
    for reading in readings {
        let terms = terms(reading.target.0, reading.direction);
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
    if pivots.min() < LEAST_PIVOT * pivots.max() {
        return Err(undetermined());
    }
    let solved = cholesky.solve(&right);
    let value = |index: usize| solved.get(index).copied().unwrap_or(0.0);
    let (mut squares, mut largest) = (0.0, 0.0_f64);
    for reading in readings {
        let terms = terms(reading.target.0, reading.direction);
        let said: f64 = terms
            .iter()
            .map(|(index, weight)| weight * value(*index))
            .sum();
        let left = reading.deviation.0 - said;
        squares += left * left;
        largest = largest.max(left.abs());
    }
    let points = knots.iter().enumerate();
    let points = points.map(|(index, at)| (Travel(*at), Deviation(value(index))));
    let curve = Curve::new(points.collect());
    Ok(Fit {
        slope: slope(&curve),
        curve,
        backlash: both.then(|| Deviation(value(size - 1))),
        left: (
            Deviation((squares / readings.len() as f64).sqrt()),
            Deviation(largest),
        ),
    })
}

/// The slope of the straight line through the points, µm a metre.
fn slope(curve: &Curve) -> f64 {
    let points = curve.points();
    let count = points.len() as f64;
    let mean_at = points.iter().map(|(at, _)| at.0).sum::<f64>() / count;
    let mean = points.iter().map(|(_, value)| value.0).sum::<f64>() / count;
    let (mut both, mut squares) = (0.0, 0.0);
    for (at, value) in points {
        both += (at.0 - mean_at) * (value.0 - mean);
        squares += (at.0 - mean_at) * (at.0 - mean_at);
    }
    both / squares * 1000.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measurement::Reading;

    fn reading(target: f64, direction: Direction, deviation: f64) -> Reading {
        Reading {
            run: 1,
            target: Travel(target),
            direction,
            deviation: Deviation(deviation),
        }
    }

    /// A screw with 5 µm at -100 and play of 12 µm; one run each way, the second half of
    /// the way back missing.
    #[test]
    fn curve_and_play_are_told_apart() {
        let true_curve = |at: f64| -at * 0.05;
        for free in [Direction::Plus, Direction::Minus] {
            let mut readings = Vec::new();
            for index in 0..=10 {
                let at = -10.0 * f64::from(index);
                let against = match free {
                    Direction::Plus => 12.0,
                    Direction::Minus => -12.0,
                };
                readings.push(reading(at, free, true_curve(at)));
                if index < 6 {
                    readings.push(reading(at, free.other(), true_curve(at) + against));
                }
            }
            let measured = Measurement {
                axis: None,
                readings,
            };
            let fit = fit(&measured, free).unwrap();
            assert!((fit.backlash.unwrap().0 - 12.0).abs() < 1e-9);
            assert!((fit.curve.at(Travel(-35.0)).0 - 1.75).abs() < 1e-9);
            assert!(fit.left.1.0 < 1e-9 && (fit.slope + 50.0).abs() < 1e-9);
        }
    }

    #[test]
    fn the_mean_of_runs_counts() {
        let readings = vec![
            reading(0.0, Direction::Plus, 0.0),
            reading(10.0, Direction::Plus, 3.0),
            reading(10.0, Direction::Plus, 5.0),
        ];
        let fit = fit(
            &Measurement {
                axis: None,
                readings,
            },
            Direction::Plus,
        )
        .unwrap();
        assert_eq!(fit.backlash, None);
        assert!((fit.curve.at(Travel(10.0)).0 - 4.0).abs() < 1e-9);
        assert!((fit.left.1.0 - 1.0).abs() < 1e-9);
    }

    #[test]
    fn readings_that_settle_nothing_are_refused() {
        let none = Measurement::default();
        assert!(fit(&none, Direction::Plus).is_err());
        // No target from both sides: play and curve cannot be told apart.
        let readings = vec![
            reading(0.0, Direction::Plus, 0.0),
            reading(10.0, Direction::Minus, 3.0),
            reading(20.0, Direction::Plus, 3.0),
        ];
        assert!(
            fit(
                &Measurement {
                    axis: None,
                    readings
                },
                Direction::Plus
            )
            .is_err()
        );
    }
}
