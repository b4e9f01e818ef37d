//! The path that the slides have made in a program run, which the handwheel retraces.
//!
//! ```text
//!   begin o───────────o────╮              path time: the time of the run in which
//!                          │  o cursor    the slides moved
//!                          ╰───────────o hold
//! ```
//!
//! The slides pass the points of the path again, in the time of the run divided by the rate. At
//! [`MAX_RATE`] the accelerations of the path itself are a quarter of those of the run. Three
//! quarters are left for the change of the rate.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use super::limits::MotionLimits;
use super::ramp::{Ramp, SpeedLaw};
use crate::units::{Axis, Point, TICK_S, max_not_nan};

/// Greatest number of stored pieces of the path; older ones are dropped.
const MAX_PIECES: usize = 20_000;
/// Difference of two steps, mm, up to which two ticks belong to one piece.
const SAME_STEP_MM: f64 = 1e-9;
/// Greatest number of ticks of a piece, which bounds the sum of these differences.
const MAX_PIECE_TICKS: u64 = 60_000;
/// Greatest speed of the slides relative to that of the run.
const MAX_RATE: f64 = 0.5;
/// Path time of one graduation of the handwheel, s.
const GRADUATION_S: f64 = 0.02;
/// Greatest path time by which the slides lag the handwheel, s.
const LAG_S: f64 = 0.15;

/// Why the stored path does not begin earlier.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum PathBegin {
    /// The run or the recording began there, or older pieces were dropped.
    Recording,
    /// An M, S or T function, a dwell or a macro.
    Function,
    /// A thread or a tap.
    Thread,
    /// A change of coordinates or a reference return.
    Coordinates,
}

/// Ticks in which the slides made the same step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct PathPiece {
    end: Point,
    /// Number of moving ticks from the begin of the recording to the end of the piece.
    end_tick: u64,
}

/// The made path and the position of the slides on it. Machine coordinates in mm, X as a radius.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Retrace {
    begin: PathBegin,
    start: Point,
    start_tick: u64,
    pieces: VecDeque<PathPiece>,
    /// Path time of the slides while they are off the end, s; `None`: they make the path.
    cursor_s: Option<f64>,
    /// Path time to which the handwheel leads, s.
    goal_s: f64,
    /// Path time per time; never negative.
    rate: f64,
    is_forwards: bool,
    /// Whether the path is forgotten at standstill.
    is_ending: bool,
    /// Whether the begin was reported since the slides have reached it.
    is_begin_reported: bool,
}

impl Retrace {
    /// Begins a recording at a position.
    pub(crate) const fn new(start: Point, begin: PathBegin) -> Self {
        Self {
            begin,
            start,
            start_tick: 0,
            pieces: VecDeque::new(),
            cursor_s: None,
            goal_s: 0.0,
            rate: 0.0,
            is_forwards: false,
            is_ending: false,
            is_begin_reported: false,
        }
    }

    /// Records the position after a tick of the run.
    pub(crate) fn record(&mut self, to: Point) {
        let (from, ticks) = (self.end(), self.end_tick());
        let step = to - from;
        if step == Point::default() {
            return;
        }
        let before = self.last_step();
        if let (Some((same, count)), Some(last)) = (before, self.pieces.back_mut())
            && count < MAX_PIECE_TICKS
            && (step - same).length() <= SAME_STEP_MM
        {
            last.end = to;
            last.end_tick += 1;
            return;
        }
        if self.pieces.len() >= MAX_PIECES
            && let Some(dropped) = self.pieces.pop_front()
        {
            self.begin = PathBegin::Recording;
            self.start = dropped.end;
            self.start_tick = dropped.end_tick;
        }
        self.pieces.push_back(PathPiece {
            end: to,
            end_tick: ticks + 1,
        });
    }

    /// The step of a tick in the last piece, and its number of ticks; `None` without a piece.
    fn last_step(&self) -> Option<(Point, u64)> {
        let last = self.pieces.back()?;
        let (from, from_tick) = self.piece_start(self.pieces.len() - 1);
        let count = last.end_tick - from_tick;
        Some(((last.end - from) * (1.0 / count as f64), count))
    }

    /// Position and tick at which a piece begins.
    fn piece_start(&self, index: usize) -> (Point, u64) {
        let before = index.checked_sub(1).and_then(|it| self.pieces.get(it));
        before.map_or((self.start, self.start_tick), |it| (it.end, it.end_tick))
    }

    /// The end of the path: where the hold has stopped the slides.
    pub(crate) fn end(&self) -> Point {
        self.pieces.back().map_or(self.start, |last| last.end)
    }

    fn end_tick(&self) -> u64 {
        self.pieces
            .back()
            .map_or(self.start_tick, |last| last.end_tick)
    }

    fn begin_s(&self) -> f64 {
        self.start_tick as f64 * TICK_S
    }

    fn end_s(&self) -> f64 {
        self.end_tick() as f64 * TICK_S
    }

    /// The point of the path at a path time, s; exact at both ends of a piece.
    fn point_at(&self, time_s: f64) -> Point {
        if time_s >= self.end_s() {
            return self.end();
        }
        let ticks = time_s / TICK_S;
        let index = (self.pieces).partition_point(|piece| (piece.end_tick as f64) < ticks);
        let Some(piece) = self.pieces.get(index) else {
            return self.end();
        };
        let (from, from_tick) = self.piece_start(index);
        let left = piece.end_tick as f64 - ticks;
        let share = left / (piece.end_tick - from_tick) as f64;
        match share {
            _ if share <= 0.0 => piece.end,
            _ if share >= 1.0 => from,
            _ => piece.end - (piece.end - from) * share,
        }
    }

    /// The position of the slides on the path.
    pub(crate) fn position(&self) -> Point {
        self.cursor_s.map_or(self.end(), |time| self.point_at(time))
    }

    /// Whether the handwheel has taken the slides over.
    pub(crate) const fn is_engaged(&self) -> bool {
        self.cursor_s.is_some()
    }

    /// Whether the slides move or have a point of the path to go to.
    pub(crate) fn is_moving(&self) -> bool {
        let is_under_way = |cursor: f64| self.rate > 0.0 || cursor != self.goal_s;
        self.cursor_s.is_some_and(is_under_way)
    }

    /// Turns the handwheel by graduations: clockwise is forwards. Returns why the path does not
    /// lead further back, once when the slides stand at its begin.
    pub(crate) fn turn(&mut self, graduations: i32) -> Option<PathBegin> {
        let (begin, end) = (self.begin_s(), self.end_s());
        let cursor = *self.cursor_s.get_or_insert(end);
        if !self.is_moving() {
            self.goal_s = cursor;
        }
        let goal = self.goal_s + f64::from(graduations) * GRADUATION_S;
        self.goal_s = goal.clamp(cursor - LAG_S, cursor + LAG_S).clamp(begin, end);
        let is_at_begin = cursor <= begin;
        let was_reported = self.is_begin_reported && is_at_begin;
        self.is_begin_reported = is_at_begin && (was_reported || graduations < 0);
        (self.is_begin_reported && !was_reported).then_some(self.begin)
    }

    /// Drops the turns of the handwheel that the slides have not followed: they brake.
    pub(crate) fn drop_turns(&mut self, limits: &MotionLimits) {
        if let Some(cursor) = self.cursor_s {
            let distance = rate_law(limits).braking_distance(self.rate);
            let distance = if self.is_forwards {
                distance
            } else {
                -distance
            };
            self.goal_s = (cursor + distance).clamp(self.begin_s(), self.end_s());
        }
    }

    /// Forgets the path as soon as the slides stand. Returns whether they stand now.
    pub(crate) fn end_at_standstill(&mut self, limits: &MotionLimits) -> bool {
        self.drop_turns(limits);
        self.is_ending = true;
        self.rate <= 0.0
    }

    /// Whether the path is to be forgotten now.
    pub(crate) fn has_ended(&self) -> bool {
        self.is_ending && self.rate <= 0.0
    }

    /// Gives the slides back to the run, which continues at the end of the path.
    pub(crate) const fn release(&mut self) {
        self.cursor_s = None;
        self.rate = 0.0;
    }

    /// Advances the slides by one tick along the path and returns their position.
    pub(crate) fn advance(&mut self, limits: &MotionLimits) -> Point {
        let Some(cursor) = self.cursor_s else {
            return self.end();
        };
        let is_forwards = self.goal_s >= cursor;
        if self.rate <= 0.0 {
            self.is_forwards = is_forwards;
        }
        let leads_there = self.is_forwards == is_forwards;
        let mut ramp = Ramp {
            speed: self.rate,
            remaining: match leads_there {
                true => (self.goal_s - cursor).abs(),
                false => f64::INFINITY,
            },
        };
        let target = if leads_there { MAX_RATE } else { 0.0 };
        let step = ramp.advance(&rate_law(limits), target, TICK_S);
        self.rate = ramp.speed;
        let moved = match self.is_forwards {
            _ if ramp.is_finished() => self.goal_s,
            true => cursor + step.distance,
            false => cursor - step.distance,
        };
        let moved = moved.clamp(self.begin_s(), self.end_s());
        self.cursor_s = Some(moved);
        self.point_at(moved)
    }
}

/// The law by which the rate changes: by three quarters in the time in which the slower axis
/// reaches its rapid rate, or a cut its feed.
fn rate_law(limits: &MotionLimits) -> SpeedLaw {
    let time = |axis| limits.rapid(axis) / limits.rapid_law(axis).acceleration();
    let rapid = max_not_nan(time(Axis::X), time(Axis::Z));
    let slower = max_not_nan(rapid, limits.cutting_law().time_constant());
    SpeedLaw::linear(1.0 - MAX_RATE * MAX_RATE, slower)
}
