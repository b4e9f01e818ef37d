//! Computes the corrections of a pitch error table for a point interval and chooses the interval.
//!
//! ```text
//!            ┌──── S(2) = v[R+1] + v[R+2]         the correction is constant between two
//!       ┌────┘     S(1) = v[R+1]                  points; it is exact in the middle of each
//!   ────┘          S(0) = 0                       interval
//! ```

use gsk_core::axis::PitchCurve;
use gsk_core::units::Axis;

use crate::correction::{LAST_POINT, MAX_POINT_VALUE};
use crate::measurement::SlideTravel;
use crate::screw_fit::ScrewFit;

/// Point intervals to try, in table units, the largest first.
const INTERVALS: [i64; 8] = [20_000, 10_000, 5_000, 4_000, 2_500, 2_000, 1_500, 1_000];
/// Largest residual deviation for which no smaller interval is tried, µm.
pub(crate) const MAX_RESIDUAL_UM: f64 = 0.8;

/// The deviations that a table has to correct.
pub(crate) struct CorrectionTask<'a> {
    pub(crate) axis: Axis,
    pub(crate) fit: &'a ScrewFit,
    pub(crate) current: PitchCurve,
    /// Number of table units in a millimetre.
    pub(crate) units_per_mm: f64,
    pub(crate) factor: i64,
    /// Lowest and highest measured position, table units.
    pub(crate) range_units: (f64, f64),
    /// Measured deviation at the machine zero, µm.
    pub(crate) zero_deviation_um: f64,
}

/// The corrections of a table with one point interval, in table units.
pub(crate) struct IntervalCorrections {
    pub(crate) interval: i64,
    /// Correction sums S(1), S(2) … towards plus.
    pub(crate) plus: Vec<i64>,
    pub(crate) minus: Vec<i64>,
    /// Largest deviation that remains with these corrections, µm.
    pub(crate) max_residual_um: f64,
}

impl CorrectionTask<'_> {
    /// Returns the measured deviation relative to the machine zero, µm. `at` is in table
    /// units.
    pub(crate) fn deviation_um(&self, at: f64) -> f64 {
        self.fit.curve.at(SlideTravel(at / self.units_per_mm)).0 - self.zero_deviation_um
    }

    /// Returns the correction of the current table, table units, at a position in the same
    /// units.
    fn current_units(&self, at: f64) -> f64 {
        self.current.correction_at(at.round() as i64) as f64
    }

    /// Returns the correction that the slide needs, table units, at a position in the same
    /// units.
    fn required_units(&self, at: f64) -> f64 {
        self.current_units(at) - self.deviation_um(at) * self.units_per_mm / 1000.0
    }

    /// Returns the number of points that a table with this interval needs.
    pub(crate) fn point_count(&self, interval: f64) -> i64 {
        let side = |end: f64| (end.max(0.0) / interval + 1e-9).floor() as i64;
        side(self.range_units.1) + side(-self.range_units.0)
    }

    /// Returns the correction sums on one side of the zero. `sign` is 1 towards plus, -1
    /// towards minus.
    fn side_corrections(&self, interval: i64, sign: f64) -> Vec<i64> {
        let end = match sign > 0.0 {
            true => self.range_units.1,
            false => -self.range_units.0,
        };
        let count = (end.max(0.0) / interval as f64 + 1e-9).floor() as i64;
        (1..=count)
            .map(|index| {
                let from = (index * interval) as f64;
                let to = (from + interval as f64).min(end.max(from));
                let required = self.required_units(sign * (from + to) / 2.0);
                let factor = self.factor as f64;
                (required / factor).round() as i64 * self.factor
            })
            .collect()
    }

    pub(crate) fn corrections(&self, interval: i64) -> IntervalCorrections {
        let mut corrections = IntervalCorrections {
            interval,
            plus: self.side_corrections(interval, 1.0),
            minus: self.side_corrections(interval, -1.0),
            max_residual_um: 0.0,
        };
        let knots = self
            .fit
            .curve
            .points()
            .iter()
            .map(|(at, _)| at.0 * self.units_per_mm);
        let [plus, minus] = [&corrections.plus, &corrections.minus].map(|side| side.len() as i64);
        // The residual is largest at and just before each step.
        let edges = (-minus..=plus).flat_map(|index| {
            let edge = (index * interval) as f64;
            [edge, edge - 1.0, edge + 1.0]
        });
        let within = |at: &f64| (self.range_units.0..=self.range_units.1).contains(at);
        let left = knots
            .chain(edges)
            .filter(within)
            .map(|at| self.residual_um(&corrections, at).abs());
        corrections.max_residual_um = left.fold(0.0, f64::max);
        corrections
    }

    /// Returns the deviation that remains at a position (table units), µm.
    fn residual_um(&self, corrections: &IntervalCorrections, at: f64) -> f64 {
        let passed = (at.abs() / corrections.interval as f64 + 1e-9).floor() as usize;
        let side = if at < 0.0 {
            &corrections.minus
        } else {
            &corrections.plus
        };
        let last = passed.min(side.len());
        let made = last.checked_sub(1).and_then(|it| side.get(it));
        let made = made.copied().unwrap_or(0) as f64;
        self.deviation_um(at) + (made - self.current_units(at)) * 1000.0 / self.units_per_mm
    }

    /// Returns whether the table has enough points and each value is at most 255.
    pub(crate) fn fits(&self, corrections: &IntervalCorrections) -> bool {
        corrections.plus.len() + corrections.minus.len() <= LAST_POINT as usize
            && self
                .point_values(corrections)
                .iter()
                .all(|(_, value)| value.abs() <= MAX_POINT_VALUE)
    }

    /// Returns the number of the point that lies at the machine zero.
    pub(crate) fn origin_point(corrections: &IntervalCorrections) -> i64 {
        let (plus, minus) = (
            corrections.plus.len() as i64,
            corrections.minus.len() as i64,
        );
        match (plus, minus) {
            (_, 0) => 0,
            (0, _) => LAST_POINT,
            _ => minus + (LAST_POINT - plus - minus) / 2,
        }
    }

    /// Returns number and value of each point, the value before multiplication by 013.
    pub(crate) fn point_values(&self, corrections: &IntervalCorrections) -> Vec<(i64, i64)> {
        let origin = Self::origin_point(corrections);
        let mut values = Vec::new();
        let mut before = 0;
        for (sum, index) in corrections.plus.iter().zip(1..) {
            values.push((origin + index, (sum - before) / self.factor));
            before = *sum;
        }
        before = 0;
        for (sum, index) in corrections.minus.iter().zip(1..) {
            values.push((origin - index + 1, (before - sum) / self.factor));
            before = *sum;
        }
        values
    }
}

/// Returns the corrections for the largest interval with an acceptable residual, or else for
/// the one with the smallest residual. Returns `None` if no interval fits the table.
pub(crate) fn find_interval(task: &CorrectionTask<'_>) -> Option<IntervalCorrections> {
    let mut best: Option<IntervalCorrections> = None;
    for interval in INTERVALS {
        if task.point_count(interval as f64) > LAST_POINT {
            continue;
        }
        let corrections = task.corrections(interval);
        if !task.fits(&corrections) {
            continue;
        }
        if corrections.max_residual_um <= MAX_RESIDUAL_UM {
            return Some(corrections);
        }
        if best
            .as_ref()
            .is_none_or(|it| corrections.max_residual_um < it.max_residual_um)
        {
            best = Some(corrections);
        }
    }
    best
}
