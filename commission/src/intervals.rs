//! Which corrections an interval of the pitch error table makes for a curve, and which
//! interval is fine enough.
//!
//! ```text
//!            ┌──── S(2) = v[R+1] + v[R+2]         the control's correction is level between
//!       ┌────┘     S(1) = v[R+1]                  two points; it is made right in the middle
//!   ────┘          S(0) = 0                       of each interval
//! ```

use gsk_core::axis::PitchCurve;
use gsk_core::units::Axis;

use crate::correction::{LARGEST, LAST};
use crate::fit::Fit;
use crate::measurement::Travel;

/// Intervals that are tried, thousandths of a millimetre, the coarsest first.
const INTERVALS: [i64; 8] = [20_000, 10_000, 5_000, 4_000, 2_500, 2_000, 1_500, 1_000];
/// The deviation that is left may be so much, µm, before a finer interval is taken.
pub(crate) const FINE_UM: f64 = 0.8;

/// What a table has to do.
pub(crate) struct Task<'a> {
    pub(crate) axis: Axis,
    pub(crate) fit: &'a Fit,
    pub(crate) old: PitchCurve,
    /// Units in a millimetre.
    pub(crate) units: f64,
    pub(crate) factor: i64,
    /// First and last position, units.
    pub(crate) range: (f64, f64),
    /// Deviation at the machine zero, µm.
    pub(crate) zero: f64,
}

/// Corrections for an interval, in units of the table.
pub(crate) struct Steps {
    pub(crate) interval: i64,
    /// S(1), S(2) … towards plus, and towards minus.
    pub(crate) plus: Vec<i64>,
    pub(crate) minus: Vec<i64>,
    /// The largest deviation that is left, µm.
    pub(crate) left: f64,
}

impl Task<'_> {
    /// The deviation from the machine zero, µm; `at` in units.
    pub(crate) fn deviation(&self, at: f64) -> f64 {
        self.fit.curve.at(Travel(at / self.units)).0 - self.zero
    }

    /// The correction that stands there, units.
    fn old(&self, at: f64) -> f64 {
        self.old.at(at.round() as i64) as f64
    }

    /// The correction that the slide needs, units.
    fn wanted(&self, at: f64) -> f64 {
        self.old(at) - self.deviation(at) * self.units / 1000.0
    }

    /// How many points a table of this interval has.
    pub(crate) fn points(&self, interval: f64) -> i64 {
        let side = |end: f64| (end.max(0.0) / interval + 1e-9).floor() as i64;
        side(self.range.1) + side(-self.range.0)
    }

    /// Corrections of the intervals of one side; `sign`: which one.
    fn side(&self, interval: i64, sign: f64) -> Vec<i64> {
        let end = match sign > 0.0 {
            true => self.range.1,
            false => -self.range.0,
        };
        let count = (end.max(0.0) / interval as f64 + 1e-9).floor() as i64;
        (1..=count)
            .map(|index| {
                let from = (index * interval) as f64;
                let to = (from + interval as f64).min(end.max(from));
                let wanted = self.wanted(sign * (from + to) / 2.0);
                let factor = self.factor as f64;
                (wanted / factor).round() as i64 * self.factor
            })
            .collect()
    }

    pub(crate) fn steps(&self, interval: i64) -> Steps {
        let mut steps = Steps {
            interval,
            plus: self.side(interval, 1.0),
            minus: self.side(interval, -1.0),
            left: 0.0,
        };
        let knots = self
            .fit
            .curve
            .points()
            .iter()
            .map(|(at, _)| at.0 * self.units);
        let [plus, minus] = [&steps.plus, &steps.minus].map(|side| side.len() as i64);
        // At and before each step the deviation is largest.
        let edges = (-minus..=plus).flat_map(|index| {
            let edge = (index * interval) as f64;
            [edge, edge - 1.0, edge + 1.0]
        });
        let within = |at: &f64| (self.range.0..=self.range.1).contains(at);
        let left = knots
            .chain(edges)
            .filter(within)
            .map(|at| self.left(&steps, at).abs());
        steps.left = left.fold(0.0, f64::max);
        steps
    }

    /// What is left at a position, µm.
    fn left(&self, steps: &Steps, at: f64) -> f64 {
        let passed = (at.abs() / steps.interval as f64 + 1e-9).floor() as usize;
        let side = if at < 0.0 { &steps.minus } else { &steps.plus };
        let last = passed.min(side.len());
        let made = last.checked_sub(1).and_then(|it| side.get(it));
        let made = made.copied().unwrap_or(0) as f64;
        self.deviation(at) + (made - self.old(at)) * 1000.0 / self.units
    }

    /// Whether the table has room for so many points, and each value is small enough.
    pub(crate) fn fits(&self, steps: &Steps) -> bool {
        steps.plus.len() + steps.minus.len() <= LAST as usize
            && self
                .values(steps)
                .iter()
                .all(|(_, value)| value.abs() <= LARGEST)
    }

    /// The point of the machine zero.
    pub(crate) fn origin(steps: &Steps) -> i64 {
        let (plus, minus) = (steps.plus.len() as i64, steps.minus.len() as i64);
        match (plus, minus) {
            (_, 0) => 0,
            (0, _) => LAST,
            _ => minus + (LAST - plus - minus) / 2,
        }
    }

    /// Point and value.
    pub(crate) fn values(&self, steps: &Steps) -> Vec<(i64, i64)> {
        let origin = Self::origin(steps);
        let mut values = Vec::new();
        let mut before = 0;
        for (sum, index) in steps.plus.iter().zip(1..) {
            values.push((origin + index, (sum - before) / self.factor));
            before = *sum;
        }
        before = 0;
        for (sum, index) in steps.minus.iter().zip(1..) {
            values.push((origin - index + 1, (before - sum) / self.factor));
            before = *sum;
        }
        values
    }
}

/// The coarsest interval that is fine enough, else the best there is.
pub(crate) fn finest(task: &Task<'_>) -> Option<Steps> {
    let mut best: Option<Steps> = None;
    for interval in INTERVALS {
        if task.points(interval as f64) > LAST {
            continue;
        }
        let steps = task.steps(interval);
        if !task.fits(&steps) {
            continue;
        }
        if steps.left <= FINE_UM {
            return Some(steps);
        }
        if best.as_ref().is_none_or(|it| steps.left < it.left) {
            best = Some(steps);
        }
    }
    best
}
