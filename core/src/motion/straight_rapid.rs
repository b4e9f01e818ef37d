//! Rapid traverse in a straight line (NC-B08): both axes arrive together. Their speed
//! follows an S-curve: the acceleration begins and ends at zero. P18 = 1 makes it linear.
//!
//! ```text
//!   v ^        ______                 from v0 to v1 in T:
//!     |      /        \                 u = t / T
//!     |     |          |                v = v0 + (v1 - v0) * (3u² - 2u³)
//!     |    /            \               T = |v1 - v0| / a, a the mean acceleration
//!     +---'--------------'---> t        way = T * (v0 + v1) / 2
//! ```
//!
//! The mean acceleration is two thirds of the axes' acceleration (024, 025), because the
//! S-curve is one and a half times as steep in its middle.

use serde::{Deserialize, Serialize};

use super::limits::MotionLimits;
use crate::units::{Axis, PerAxis, Point};

/// Greatest slope of the S-curve divided by its mean slope.
const STEEPEST_RATIO: f64 = 1.5;

/// Greatest distance to go that counts as zero, mm.
const MIN_DISTANCE_MM: f64 = 1e-9;

/// A planned change of speed along an S-curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct SpeedChange {
    from: f64,
    to: f64,
    /// Target speed for which the change was planned, mm/s.
    #[serde(rename = "wanted")]
    target: f64,
    /// Total time of the change, s. `elapsed` is the part of it that has passed, s.
    span: f64,
    elapsed: f64,
    /// Whether this change of speed brakes to standstill at the end point of the rapid. Such a
    /// change is never replanned.
    #[serde(rename = "last")]
    is_last: bool,
    /// Whether the speed changes linearly instead of along an S-curve.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    linear: bool,
}

impl SpeedChange {
    /// Speed after the fraction `fraction` (0–1) of the time of the change, mm/s.
    fn speed_at(&self, fraction: f64) -> f64 {
        let part = match self.linear {
            true => fraction,
            false => fraction * fraction * (3.0 - 2.0 * fraction),
        };
        self.from + (self.to - self.from) * part
    }

    /// Distance travelled after the fraction `fraction` (0–1) of the time of the change, mm.
    fn distance_at(&self, fraction: f64) -> f64 {
        let s = match self.linear {
            true => fraction * fraction / 2.0,
            false => fraction * fraction * fraction * (1.0 - fraction / 2.0),
        };
        self.span * (self.from * fraction + (self.to - self.from) * s)
    }

    fn fraction(&self) -> f64 {
        if self.span > 0.0 {
            (self.elapsed / self.span).min(1.0)
        } else {
            1.0
        }
    }
}

/// A straight rapid that is being executed, with an S-shaped speed profile.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct StraightRapid {
    to: Point,
    /// Direction of the line, a vector of length 1.
    direction: Point,
    /// Distance to the end, mm; exactly zero at the end.
    remaining: f64,
    /// Speed along the line, mm/s.
    speed: f64,
    change: Option<SpeedChange>,
}

impl StraightRapid {
    /// Creates a straight rapid that is at rest at `from` and leads to `to`, mm.
    pub fn new(from: Point, to: Point) -> Self {
        let displacement = to - from;
        let length = displacement.length();
        Self {
            to,
            direction: displacement * (1.0 / length.max(MIN_DISTANCE_MM)),
            remaining: length,
            speed: 0.0,
            change: None,
        }
    }

    /// Returns the end point of the rapid, mm.
    pub const fn to(&self) -> Point {
        self.to
    }

    /// Whether the end point is reached.
    pub fn is_finished(&self) -> bool {
        self.remaining <= 0.0
    }

    /// Whether the speed of the rapid is above 0.
    pub fn is_moving(&self) -> bool {
        self.speed > 0.0
    }

    /// Returns the current position of the axes, mm.
    pub fn position(&self) -> Point {
        self.to - self.direction * self.remaining
    }

    /// Position at which the axes stop if they brake now, mm.
    pub(crate) fn stopping_point(&self, limits: &MotionLimits) -> Point {
        let distance = match &self.change {
            Some(change) if change.to <= 0.0 => {
                change.distance_at(1.0) - change.distance_at(change.fraction())
            }
            _ => self.speed * self.speed / (2.0 * mean_acceleration(limits, self.direction)),
        };
        self.to - self.direction * (self.remaining - distance).max(0.0)
    }

    /// Returns the rapid shifted by a vector, mm.
    pub fn shifted(self, by: Point) -> Self {
        Self {
            to: self.to + by,
            ..self
        }
    }

    /// Advances by `dt` seconds towards the target speed of each axis, mm/s. Returns the time used,
    /// s, which is less than `dt` only if the end is reached.
    pub fn advance(&mut self, limits: &MotionLimits, target: PerAxis<f64>, dt: f64) -> f64 {
        let target = speed_along(self.direction, target).min(limits.straight_rapid());
        let acceleration = mean_acceleration(limits, self.direction);
        let mut left = dt;
        // A tick contains at most the end of one change and the start of another, twice on
        // very short distances.
        for _ in 0..8 {
            if self.is_finished() || left <= 0.0 {
                break;
            }
            self.plan(target, acceleration, limits.has_linear_rapids());
            left -= self.follow_change(left, acceleration);
        }
        if self.is_finished() { dt - left } else { dt }
    }

    /// Plans the next change of speed towards `target`, mm/s, with the mean acceleration
    /// `acceleration`, mm/s², unless the planned change is still valid.
    fn plan(&mut self, target: f64, acceleration: f64, linear: bool) {
        let braking = self.speed * self.speed / (2.0 * acceleration);
        // The planned change continues unless the target speed has changed.
        if let Some(change) = &self.change
            && (change.is_last || (change.target - target).abs() < 1e-9)
        {
            return;
        }
        self.change = None;
        if target > 0.0 && self.speed > 0.0 && self.remaining <= braking + MIN_DISTANCE_MM {
            self.change = Some(SpeedChange {
                from: self.speed,
                to: 0.0,
                target,
                span: 2.0 * self.remaining / self.speed,
                elapsed: 0.0,
                is_last: true,
                linear,
            });
            return;
        }
        let goal = target.min(self.peak_speed(acceleration));
        if (goal - self.speed).abs() > 1e-9 {
            self.change = Some(SpeedChange {
                from: self.speed,
                to: goal,
                target,
                span: (goal - self.speed).abs() / acceleration,
                elapsed: 0.0,
                is_last: false,
                linear,
            });
        }
    }

    /// The highest speed from which the rest of the distance is enough to brake, mm/s.
    fn peak_speed(&self, acceleration: f64) -> f64 {
        (acceleration * self.remaining + self.speed * self.speed / 2.0).sqrt()
    }

    /// Advances the planned change of speed by at most `dt` seconds, up to its end, or the cruise
    /// up to the start of braking. Returns the time used, s.
    fn follow_change(&mut self, dt: f64, acceleration: f64) -> f64 {
        let Some(mut change) = self.change else {
            return self.cruise(dt, acceleration);
        };
        let before = change.distance_at(change.fraction());
        let used = dt.min(change.span - change.elapsed).max(0.0);
        change.elapsed += used;
        let is_done = change.elapsed >= change.span - 1e-12;
        let fraction = if is_done { 1.0 } else { change.fraction() };
        self.speed = change.speed_at(fraction);
        self.remaining -= change.distance_at(fraction) - before;
        self.change = (!is_done).then_some(change);
        // The last part of the S-curve is shorter than the rounding, and takes its time.
        if change.is_last && !is_done {
            self.remaining = self.remaining.max(f64::MIN_POSITIVE);
        }
        if (is_done || !change.is_last) && (change.is_last || self.remaining <= MIN_DISTANCE_MM) {
            self.finish();
        }
        used
    }

    /// Moves at constant speed for at most `dt` seconds, up to the point where braking
    /// begins. Returns the time used, s.
    fn cruise(&mut self, dt: f64, acceleration: f64) -> f64 {
        if self.speed <= 0.0 {
            return dt;
        }
        let braking = self.speed * self.speed / (2.0 * acceleration);
        let free = (self.remaining - braking).max(0.0);
        let used = dt.min(free / self.speed);
        self.remaining -= used * self.speed;
        used
    }

    fn finish(&mut self) {
        self.remaining = 0.0;
        self.speed = 0.0;
        self.change = None;
    }
}

/// Highest speed along a unit vector at which no axis exceeds its own one of `axis_speeds`, in the
/// same unit; applies to accelerations, too.
fn speed_along(direction: Point, axis_speeds: PerAxis<f64>) -> f64 {
    [Axis::X, Axis::Z]
        .map(|axis| axis_speeds.get(axis) / direction.get(axis).abs().max(1e-12))
        .into_iter()
        .fold(f64::INFINITY, f64::min)
}

/// Highest mean acceleration along a unit vector at which no axis exceeds its acceleration,
/// mm/s².
fn mean_acceleration(limits: &MotionLimits, direction: Point) -> f64 {
    let axis_acceleration = |axis| limits.rapid_law(axis).acceleration();
    let steepest = speed_along(
        direction,
        PerAxis::new(axis_acceleration(Axis::X), axis_acceleration(Axis::Z)),
    );
    match limits.has_linear_rapids() {
        true => steepest,
        false => steepest / STEEPEST_RATIO,
    }
}

/// Duration of a straight rapid by `displacement`, mm, from rest to rest at an override of 100 %,
/// s.
pub(super) fn duration(limits: &MotionLimits, displacement: Point) -> f64 {
    let length = displacement.length();
    if length <= MIN_DISTANCE_MM {
        return 0.0;
    }
    let (rate, acceleration) = rate_and_acceleration(limits, displacement);
    if length * acceleration >= rate * rate {
        length / rate + rate / acceleration
    } else {
        2.0 * (length / acceleration).sqrt()
    }
}

/// Highest speed of each axis in a straight rapid by `displacement`, mm, in mm/s.
pub(super) fn top_speed(limits: &MotionLimits, displacement: Point) -> Point {
    let length = displacement.length();
    if length <= MIN_DISTANCE_MM {
        return Point::default();
    }
    let (rate, acceleration) = rate_and_acceleration(limits, displacement);
    let reached = rate.min((acceleration * length).sqrt());
    Point::new(displacement.x.abs(), displacement.z.abs()) * (reached / length)
}

fn rate_and_acceleration(limits: &MotionLimits, displacement: Point) -> (f64, f64) {
    let direction = displacement * (1.0 / displacement.length());
    let rates = PerAxis::new(limits.rapid(Axis::X), limits.rapid(Axis::Z));
    (
        speed_along(direction, rates).min(limits.straight_rapid()),
        mean_acceleration(limits, direction),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::ControlParameters;
    use crate::model::{ControlModel, ModelId};
    use crate::units::TICK_S;
    use proptest::prelude::*;

    fn limits() -> MotionLimits {
        MotionLimits::from_model(
            &ControlParameters::default(),
            &ControlModel::new(ModelId::Ncb08),
        )
    }

    fn full_rates(limits: &MotionLimits) -> PerAxis<f64> {
        PerAxis::new(limits.rapid(Axis::X), limits.rapid(Axis::Z))
    }

    /// Runs a rapid to its end; `share` is the fraction of the rapid rate in each tick.
    /// Returns the positions tick by tick and the duration, s.
    fn run(from: Point, to: Point, share: impl Fn(u32) -> f64) -> (Vec<Point>, f64) {
        let limits = limits();
        let rates = full_rates(&limits);
        let mut rapid = StraightRapid::new(from, to);
        let mut path = vec![from];
        let mut time = 0.0;
        for tick in 0..200_000 {
            let part = share(tick);
            let target = PerAxis::new(rates.x * part, rates.z * part);
            time += rapid.advance(&limits, target, TICK_S);
            path.push(rapid.position());
            if rapid.is_finished() {
                return (path, time);
            }
        }
        panic!("it does not arrive: {rapid:?}");
    }

    proptest! {
        #[test]
        fn duration_and_line_are_exact(
            x in -200.0_f64..200.0, z in -400.0_f64..400.0
        ) {
            let (from, to) = (Point::default(), Point::new(x, z));
            let (path, time) = run(from, to, |_| 1.0);
            prop_assert_eq!(path.last(), Some(&to));
            let whole = duration(&limits(), to);
            prop_assert!((time - whole).abs() < 1e-6, "{time} s, not {whole} s");
            for point in &path {
                let off = (point.x * z - point.z * x).abs() / to.length().max(1e-9);
                prop_assert!(off < 1e-9, "{point:?} is {off} off the line");
            }
        }

        #[test]
        fn speed_and_acceleration_stay_within_those_of_the_axes(
            x in -200.0_f64..200.0, z in -400.0_f64..400.0, seed in 0_u32..1000
        ) {
            // The override changes every 50 ms, to standstill too.
            let steps = [1.0, 0.25, 0.5, 0.0, 0.1, 1.0, 0.0, 0.75];
            let share = |tick: u32| {
                if tick > 20_000 { 1.0 } else { steps[((tick / 50 + seed) % 8) as usize] }
            };
            let limits = limits();
            let rates = full_rates(&limits);
            let (path, _) = run(Point::default(), Point::new(x, z), share);
            let speeds: Vec<Point> = path.windows(2).map(|it| (it[1] - it[0]) * (1.0 / TICK_S)).collect();
            for axis in [Axis::X, Axis::Z] {
                let most = limits.rapid_law(axis).acceleration();
                for pair in speeds.windows(2) {
                    let (before, after) = (pair[0].get(axis), pair[1].get(axis));
                    prop_assert!(after.abs() <= rates.get(axis) + 1e-6);
                    // If an override ends while the rapid brakes for the end, the rest of
                    // the distance may be a third too short.
                    let change = (after - before).abs() / TICK_S;
                    prop_assert!(change <= most * 1.4 + 1e-6, "{change} mm/s² of {most}");
                }
            }
        }
    }

    #[test]
    fn a_hold_ends_at_the_predicted_point() {
        let limits = limits();
        let rates = full_rates(&limits);
        let mut rapid = StraightRapid::new(Point::default(), Point::new(20.0, -150.0));
        for _ in 0..300 {
            rapid.advance(&limits, rates, TICK_S);
        }
        let predicted = rapid.stopping_point(&limits);
        for _ in 0..2000 {
            rapid.advance(&limits, PerAxis::new(0.0, 0.0), TICK_S);
        }
        assert!(!rapid.is_moving() && !rapid.is_finished());
        assert!((rapid.position() - predicted).length() < 1e-9);
    }
}
