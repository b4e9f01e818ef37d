//! Durations of moves in closed form, without ticks.

use std::collections::VecDeque;

use super::lag::Lag;
use super::limits::MotionLimits;
use super::path::CutPath;
use super::straight_rapid;
use crate::command::MoveKind;
use crate::units::{Axis, Point, TICK_S};

/// Length of the path of a move, mm (X as a radius). A rapid counts as a straight line. `center` is
/// the centre of an arc.
pub(crate) fn path_length(kind: MoveKind, from: Point, to: Point, center: Option<Point>) -> f64 {
    match (kind, center) {
        (MoveKind::Clockwise | MoveKind::CounterClockwise, Some(_)) => {
            to_path(kind, from, to, center).length()
        }
        _ => (to - from).length(),
    }
}

fn to_path(kind: MoveKind, from: Point, to: Point, center: Option<Point>) -> CutPath {
    match (kind, center) {
        (MoveKind::Clockwise, Some(center)) => CutPath::arc(from, to, center, true),
        (MoveKind::CounterClockwise, Some(center)) => CutPath::arc(from, to, center, false),
        _ => CutPath::line(from, to),
    }
}

/// Number of time constants after which earlier cuts no longer affect the lag of the tool: of the
/// lag of a fast cut less than a thousandth remains, which is negligible even in a slow cut.
const MEMORY_TIME_CONSTANTS: f64 = 8.0;

/// Consecutive cuts that continue into each other (007.3 = 0), as far back as they
/// affect the lag of the tool.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CutChain {
    cuts: VecDeque<TimedCut>,
    /// Total duration of the cuts in the chain, s.
    total_s: f64,
}

/// A cut with its path, its speed in mm/s and its duration in s.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TimedCut {
    path: CutPath,
    rate: f64,
    duration_s: f64,
}

impl CutChain {
    /// Adds a cut at `feed`, mm/min; `center` is the centre of an arc. Returns the time in which
    /// the commanded position reaches the end of the cut, s; infinite without feed.
    pub fn add_cut(
        &mut self,
        kind: MoveKind,
        from: Point,
        to: Point,
        center: Option<Point>,
        feed: f64,
        limits: &MotionLimits,
    ) -> f64 {
        let path = to_path(kind, from, to, center);
        let rate = (feed / 60.0).min(limits.cutting());
        if path.length() <= 0.0 {
            return 0.0;
        }
        if rate <= 0.0 {
            return f64::INFINITY;
        }
        let time = path.length() / rate;
        self.cuts.push_back(TimedCut {
            path,
            rate,
            duration_s: time,
        });
        self.total_s += time;
        let memory = MEMORY_TIME_CONSTANTS * limits.cutting_law().time_constant();
        while let Some(oldest) = self.cuts.front().map(|made| made.duration_s)
            && self.total_s - oldest > memory
        {
            self.cuts.pop_front();
            self.total_s -= oldest;
        }
        time
    }

    /// Ends the chain and empties it. Returns the time from the arrival of the commanded position
    /// at the end of the last cut to the arrival of the tool, s. The next cut begins at rest.
    pub fn finish(&mut self, limits: &MotionLimits) -> f64 {
        let law = limits.cutting_law();
        let constant = law.time_constant();
        let mut lag = Lag::default();
        let mut before = (self.total_s - MEMORY_TIME_CONSTANTS * constant).max(0.0);
        for made in self.cuts.drain(..) {
            let from = before.min(made.duration_s);
            before -= from;
            // From rest a line is exact in one step; otherwise the direction changes.
            let steps = if lag.is_zero() && made.path.is_straight() {
                1.0
            } else {
                ((made.duration_s - from) / TICK_S).ceil().max(1.0)
            };
            let step = (made.duration_s - from) / steps;
            let mut at = made.path.point_at((made.duration_s - from) * made.rate);
            for number in 1..=steps as u32 {
                let left = (steps - f64::from(number)) * step;
                let next = made.path.point_at(left * made.rate);
                lag.follow(law, next - at, step);
                at = next;
            }
        }
        self.total_s = 0.0;
        lag.time_to_close(law)
    }
}

/// Duration of a move from rest to rest at overrides of 100 %, s. `displacement` is the
/// vector from start to end and `length` the length of the path, mm. `feed` in mm/min
/// applies to cuts. A dwell counts as 0 s, and a cut without feed as infinite.
pub fn move_duration(
    kind: MoveKind,
    displacement: Point,
    length: f64,
    feed: f64,
    limits: &MotionLimits,
) -> f64 {
    match kind {
        MoveKind::Dwell => 0.0,
        MoveKind::Rapid if limits.rapids_are_straight() => {
            straight_rapid::duration(limits, displacement)
        }
        MoveKind::Rapid => {
            let time = |axis| {
                limits
                    .rapid_law(axis)
                    .duration(displacement.get(axis).abs(), limits.rapid(axis))
            };
            time(Axis::X).max(time(Axis::Z))
        }
        _ => {
            let rate = (feed / 60.0).min(limits.cutting());
            limits.cutting_law().duration(length, rate)
        }
    }
}

/// Highest speed of each axis in a rapid or a cut, mm/min; for an arc, the speed along its path.
/// `displacement` is the vector from start to end, mm; `feed`, mm/min, applies to cuts.
pub fn top_speed(kind: MoveKind, displacement: Point, feed: f64, limits: &MotionLimits) -> Point {
    if kind == MoveKind::Rapid && limits.rapids_are_straight() {
        return straight_rapid::top_speed(limits, displacement) * 60.0;
    }
    let rate = feed.min(limits.cutting_rate());
    let axis_speed = |axis| match kind {
        MoveKind::Rapid => {
            let reached = limits
                .rapid_law(axis)
                .peak_speed(displacement.get(axis).abs());
            (reached * 60.0).min(limits.rapid_rate(axis))
        }
        MoveKind::Feed => rate * displacement.get(axis).abs() / displacement.length().max(1e-9),
        _ => rate,
    };
    Point::new(axis_speed(Axis::X), axis_speed(Axis::Z))
}
