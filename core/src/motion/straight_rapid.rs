//! Rapid traverse in a straight line (NC-B08): both axes arrive together. Their speed
//! follows an S-curve: the acceleration begins and ends at zero.
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
const STEEPEST: f64 = 1.5;

/// A distance to go below this counts as zero, mm.
const NOTHING: f64 = 1e-9;

/// A change of speed under way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Change {
    from: f64,
    to: f64,
    /// Target speed when the change was planned, mm/s.
    #[serde(rename = "wanted")]
    wanted: f64,
    /// Its total and its elapsed time, s.
    span: f64,
    elapsed: f64,
    /// Whether it ends at the end point: nothing interrupts it.
    #[serde(rename = "last")]
    last: bool,
}

impl Change {
    /// Speed at a fraction of its time, mm/s.
    fn speed(&self, part: f64) -> f64 {
        self.from + (self.to - self.from) * part * part * (3.0 - 2.0 * part)
    }

    /// Distance at a fraction of its time, mm.
    fn way(&self, part: f64) -> f64 {
        let s = part * part * part * (1.0 - part / 2.0);
        self.span * (self.from * part + (self.to - self.from) * s)
    }

    fn part(&self) -> f64 {
        if self.span > 0.0 {
            (self.elapsed / self.span).min(1.0)
        } else {
            1.0
        }
    }
}

/// A straight rapid under way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct StraightRapid {
    to: Point,
    /// Direction, a unit vector.
    direction: Point,
    /// Distance to the end, mm; exactly zero at the end.
    remaining: f64,
    /// Speed along the line, mm/s.
    speed: f64,
    change: Option<Change>,
}

impl StraightRapid {
    /// A rapid at rest at `from`.
    pub fn new(from: Point, to: Point) -> Self {
        let way = to - from;
        let length = way.length();
        Self {
            to,
            direction: way * (1.0 / length.max(NOTHING)),
            remaining: length,
            speed: 0.0,
            change: None,
        }
    }

    /// End point.
    pub const fn to(&self) -> Point {
        self.to
    }

    /// Whether the end is reached.
    pub fn finished(&self) -> bool {
        self.remaining <= 0.0
    }

    /// Whether the rapid has speed.
    pub fn is_moving(&self) -> bool {
        self.speed > 0.0
    }

    /// Current position of the axes.
    pub fn position(&self) -> Point {
        self.to - self.direction * self.remaining
    }

    /// Position at which the axes stop if they brake now.
    pub(crate) fn stopping_point(&self, limits: &MotionLimits) -> Point {
        let way = match &self.change {
            Some(change) if change.to <= 0.0 => change.way(1.0) - change.way(change.part()),
            _ => self.speed * self.speed / (2.0 * mean_acceleration(limits, self.direction)),
        };
        self.to - self.direction * (self.remaining - way).max(0.0)
    }

    /// The rapid shifted by a vector.
    pub fn translated(self, by: Point) -> Self {
        Self {
            to: self.to + by,
            ..self
        }
    }

    /// Advances by `dt` seconds towards the target speeds of the axes. Returns the time
    /// used.
    pub fn advance(&mut self, limits: &MotionLimits, target: PerAxis<f64>, dt: f64) -> f64 {
        let target = along(self.direction, target).min(limits.straight_rapid());
        let acceleration = mean_acceleration(limits, self.direction);
        let mut left = dt;
        // A tick contains at most the end of one change and the start of another, twice on
        // very short distances.
        for _ in 0..8 {
            if self.finished() || left <= 0.0 {
                break;
            }
            self.plan(target, acceleration);
            left -= self.go_on(left, acceleration);
        }
        if self.finished() { dt - left } else { dt }
    }

    /// Plans how the speed changes from here on.
    fn plan(&mut self, target: f64, acceleration: f64) {
        let braking = self.speed * self.speed / (2.0 * acceleration);
        // The planned change continues unless the target speed has changed.
        if let Some(change) = &self.change
            && (change.last || (change.wanted - target).abs() < 1e-9)
        {
            return;
        }
        self.change = None;
        if target > 0.0 && self.speed > 0.0 && self.remaining <= braking + NOTHING {
            self.change = Some(Change {
                from: self.speed,
                to: 0.0,
                wanted: target,
                span: 2.0 * self.remaining / self.speed,
                elapsed: 0.0,
                last: true,
            });
            return;
        }
        let goal = target.min(self.peak(acceleration));
        if (goal - self.speed).abs() > 1e-9 {
            self.change = Some(Change {
                from: self.speed,
                to: goal,
                wanted: target,
                span: (goal - self.speed).abs() / acceleration,
                elapsed: 0.0,
                last: false,
            });
        }
    }

    /// The highest speed from which the rest of the distance is enough to brake.
    fn peak(&self, acceleration: f64) -> f64 {
        (acceleration * self.remaining + self.speed * self.speed / 2.0).sqrt()
    }

    /// Advances the planned change, at most by `dt` and up to the next point to plan.
    /// Returns the time used.
    fn go_on(&mut self, dt: f64, acceleration: f64) -> f64 {
        let Some(mut change) = self.change else {
            return self.cruise(dt, acceleration);
        };
        let before = change.way(change.part());
        let took = dt.min(change.span - change.elapsed).max(0.0);
        change.elapsed += took;
        let over = change.elapsed >= change.span - 1e-12;
        let part = if over { 1.0 } else { change.part() };
        self.speed = change.speed(part);
        self.remaining -= change.way(part) - before;
        self.change = (!over).then_some(change);
        // The last part of the S-curve is shorter than the rounding, and takes its time.
        if change.last && !over {
            self.remaining = self.remaining.max(f64::MIN_POSITIVE);
        }
        if (over || !change.last) && (change.last || self.remaining <= NOTHING) {
            self.arrive();
        }
        took
    }

    /// Moves at constant speed up to the point where braking begins.
    fn cruise(&mut self, dt: f64, acceleration: f64) -> f64 {
        if self.speed <= 0.0 {
            return dt;
        }
        let braking = self.speed * self.speed / (2.0 * acceleration);
        let free = (self.remaining - braking).max(0.0);
        let took = dt.min(free / self.speed);
        self.remaining -= took * self.speed;
        took
    }

    fn arrive(&mut self) {
        self.remaining = 0.0;
        self.speed = 0.0;
        self.change = None;
    }
}

/// Speed along a direction at which no axis exceeds its limit.
fn along(direction: Point, of_axes: PerAxis<f64>) -> f64 {
    [Axis::X, Axis::Z]
        .map(|axis| of_axes.get(axis) / direction.get(axis).abs().max(1e-12))
        .into_iter()
        .fold(f64::INFINITY, f64::min)
}

/// Mean acceleration along a direction, mm/s².
fn mean_acceleration(limits: &MotionLimits, direction: Point) -> f64 {
    let of_axis = |axis| limits.rapid_law(axis).acceleration();
    along(direction, PerAxis::new(of_axis(Axis::X), of_axis(Axis::Z))) / STEEPEST
}

/// Duration of a whole straight rapid at 100 %, s.
pub(super) fn duration(limits: &MotionLimits, way: Point) -> f64 {
    let length = way.length();
    if length <= NOTHING {
        return 0.0;
    }
    let (rate, acceleration) = rate_and_acceleration(limits, way);
    if length * acceleration >= rate * rate {
        length / rate + rate / acceleration
    } else {
        2.0 * (length / acceleration).sqrt()
    }
}

/// Highest speed of each axis in a straight rapid, mm/s.
pub(super) fn top_speed(limits: &MotionLimits, way: Point) -> Point {
    let length = way.length();
    if length <= NOTHING {
        return Point::default();
    }
    let (rate, acceleration) = rate_and_acceleration(limits, way);
    let reached = rate.min((acceleration * length).sqrt());
    Point::new(way.x.abs(), way.z.abs()) * (reached / length)
}

fn rate_and_acceleration(limits: &MotionLimits, way: Point) -> (f64, f64) {
    let direction = way * (1.0 / way.length());
    let rates = PerAxis::new(limits.rapid(Axis::X), limits.rapid(Axis::Z));
    (
        along(direction, rates).min(limits.straight_rapid()),
        mean_acceleration(limits, direction),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::Parameters;
    use crate::model::{ControlModel, ModelId};
    use crate::units::TICK_S;
    use proptest::prelude::*;

    fn limits() -> MotionLimits {
        MotionLimits::of(&Parameters::default(), &ControlModel::new(ModelId::Ncb08))
    }

    fn full(limits: &MotionLimits) -> PerAxis<f64> {
        PerAxis::new(limits.rapid(Axis::X), limits.rapid(Axis::Z))
    }

    /// Positions tick by tick; `share` is the fraction of the rapid rate in each tick.
    fn run(from: Point, to: Point, share: impl Fn(u32) -> f64) -> (Vec<Point>, f64) {
        let limits = limits();
        let rates = full(&limits);
        let mut rapid = StraightRapid::new(from, to);
        let mut path = vec![from];
        let mut time = 0.0;
        for tick in 0..200_000 {
            let part = share(tick);
            let target = PerAxis::new(rates.x * part, rates.z * part);
            time += rapid.advance(&limits, target, TICK_S);
            path.push(rapid.position());
            if rapid.finished() {
                return (path, time);
            }
        }
        panic!("it does not arrive: {rapid:?}");
    }

    proptest! {
        #[test]
        fn it_takes_its_time_and_keeps_to_its_line(
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
            let rates = full(&limits);
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
    fn a_hold_ends_where_it_was_said_to() {
        let limits = limits();
        let rates = full(&limits);
        let mut rapid = StraightRapid::new(Point::default(), Point::new(20.0, -150.0));
        for _ in 0..300 {
            rapid.advance(&limits, rates, TICK_S);
        }
        let stands_at = rapid.stopping_point(&limits);
        for _ in 0..2000 {
            rapid.advance(&limits, PerAxis::new(0.0, 0.0), TICK_S);
        }
        assert!(!rapid.is_moving() && !rapid.finished());
        assert!((rapid.position() - stands_at).length() < 1e-9);
    }
}
