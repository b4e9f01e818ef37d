//! Threads: a straight line whose distance along the lead axis follows the spindle angle
//! (manual I-3.2.4).
//!
//! ```text
//!   index        begin                    begin + turns
//!  ───┴── phase ───┴──────────────────────────┴──────► spindle angle
//!      360° j / L  way = F n + R n² / 2
//! ```
//!
//! A thread begins at its angle after the one-turn signal. A thread that follows another
//! continues at the angle where that one ended, without slowing down in between. At the
//! ends the [`Gear`](super::gear::Gear) makes lead-in and lead-out.

use serde::{Deserialize, Serialize};

use super::limits::MotionLimits;
use super::path::CutPath;
use super::spindle_follower::{
    FollowerTravel, FollowerWait, Handover, SpindleFollower, SpindleTick,
};
use crate::command::{Action, ThreadStart};
use crate::units::{Axis, Point};

/// A thread to cut, machine coordinates in mm, X as a radius.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ThreadMove {
    /// End point of the thread, mm.
    pub to: Point,
    /// Axis along which the lead is measured.
    #[serde(rename = "long")]
    pub lead_axis: Axis,
    /// Lead at the start, mm per turn; X as a radius.
    pub lead: f64,
    /// Change of the lead, mm per turn and turn.
    pub increase: f64,
    /// Spindle angle at which the thread begins.
    pub start: ThreadStart,
    /// Whether this is the run-out that leaves the thread.
    pub run_out: bool,
}

impl ThreadMove {
    /// Reads the thread from the action of a command; `None` for other actions.
    pub fn from_action(action: &Action) -> Option<Self> {
        let Action::Thread {
            to,
            lead_axis: long,
            lead,
            increase,
            start,
            run_out,
        } = action
        else {
            return None;
        };
        Some(Self {
            to: *to,
            lead_axis: *long,
            lead: *lead,
            increase: *increase,
            start: *start,
            run_out: *run_out,
        })
    }

    /// The distance along which the lead is measured, mm: that of the lead axis, or of the
    /// path if the lead axis does not move.
    fn lead_distance(&self, from: Point) -> f64 {
        let displacement = self.to - from;
        let distance = displacement.get(self.lead_axis).abs();
        if distance > 0.0 {
            distance
        } else {
            displacement.length()
        }
    }

    /// Number of turns `n` of the whole thread, from `distance = F n + R n² / 2`. `from` is its
    /// start point, mm.
    pub(crate) fn turns(&self, from: Point) -> f64 {
        let (distance, lead) = (self.lead_distance(from), self.lead.abs().max(1e-6));
        if self.increase == 0.0 {
            return distance / lead;
        }
        let last = lead * lead + 2.0 * self.increase * distance;
        2.0 * distance / (lead + last.max(0.0).sqrt())
    }

    /// Lead at the start, measured along the path instead of the lead axis, mm per turn.
    pub(crate) fn lead_along_path(&self, from: Point) -> f64 {
        let distance = self.lead_distance(from).max(1e-9);
        self.lead.abs() * (self.to - from).length() / distance
    }

    /// Lead at the end of the thread, mm per turn.
    pub(crate) fn last_lead(&self, from: Point) -> f64 {
        (self.lead + self.increase * self.turns(from)).max(1e-6)
    }

    /// Highest speed of each axis in the thread at the spindle speed `rpm`, r/min, in mm/min.
    /// `from` is the start point, mm.
    pub fn top_speed(&self, from: Point, rpm: f64, limits: &MotionLimits) -> Point {
        let distance = self.lead_distance(from);
        if distance <= 0.0 {
            return Point::default();
        }
        let along = self.lead.max(self.last_lead(from)) * rpm.abs() / distance;
        let displacement = self.to - from;
        let mut top = Point::new(displacement.x.abs(), displacement.z.abs()) * along;
        if let Some(tail) = self.short_axis_run_out(from, limits) {
            *top.get_mut(tail.axis) = tail.rate(rpm.abs() / 60.0) * 60.0;
        }
        top
    }

    /// Durations, s, at the spindle speed `rpm`, r/min, of a thread from `from`, mm: that of the
    /// thread, from standstill or in phase from the previous thread, if another thread continues;
    /// and the additional time of slowing down if none does.
    pub fn duration(&self, from: Point, rpm: f64, limits: &MotionLimits) -> (f64, f64) {
        let (total, spin) = (self.turns(from), rpm.abs() / 60.0);
        let law = limits.gear_law();
        let first = match self.start {
            ThreadStart::Continued => 1.0,
            ThreadStart::AtIndex { .. } => law.lowest_rate(self.lead, spin),
        };
        let last = law.lowest_rate(self.last_lead(from), spin);
        let mut continuing = law.duration(total, spin, first, 1.0);
        let mut stopping = law.duration(total, spin, first, last);
        if let Some(tail) = self.short_axis_run_out(from, limits) {
            let leaving = tail.duration(spin);
            continuing = continuing.max(leaving);
            stopping = stopping.max(leaving);
        }
        (continuing, (stopping - continuing).max(0.0))
    }

    /// The motion of the short axis in a run-out, at its own speed (107), or at the cutting feed
    /// with the time constant of 026. `None` if that axis stays on the straight line.
    fn short_axis_run_out(&self, from: Point, limits: &MotionLimits) -> Option<ShortAxisRunOut> {
        let (axis, factor) = match self.lead_axis {
            Axis::X => (Axis::Z, 2.0),
            Axis::Z => (Axis::X, 1.0),
        };
        let distance = self.to.get(axis) - from.get(axis);
        let own_rate = limits.run_out_rate() * factor;
        let time = limits.run_out_time();
        let rate = if own_rate > 0.0 {
            RunOutRate::Fixed(own_rate)
        } else {
            RunOutRate::CuttingFeed {
                distance_per_turn: distance.abs() / self.turns(from),
            }
        };
        (self.run_out && distance != 0.0 && (own_rate > 0.0 || time > 0.0)).then(|| {
            ShortAxisRunOut {
                axis,
                from: from.get(axis),
                distance,
                rate,
                time,
                elapsed_s: 0.0,
            }
        })
    }
}

/// Speed of the short axis in the run-out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum RunOutRate {
    /// Fixed speed, mm/s: that of parameter 107, or the cutting feed at the beginning of the
    /// run-out.
    #[serde(rename = "Own")]
    Fixed(f64),
    /// The speed of the straight line to the end at the spindle speed with which the
    /// run-out begins (107 = 0).
    CuttingFeed {
        /// Travel of the short axis per spindle turn, mm.
        #[serde(rename = "way_per_turn")]
        distance_per_turn: f64,
    },
}

/// The short axis of a run-out. Its travel is `x = v (t - T (1 - e^(-t/T)))`, with v of
/// 107 or the cutting feed and T of 026 (manual I-3.2.4.4, III-12.5).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct ShortAxisRunOut {
    axis: Axis,
    from: f64,
    #[serde(rename = "way")]
    distance: f64,
    rate: RunOutRate,
    time: f64,
    #[serde(rename = "passed")]
    elapsed_s: f64,
}

impl ShortAxisRunOut {
    /// Final speed of the axis at the spindle speed `spin`, turns/s, in mm/s.
    const fn rate(&self, spin: f64) -> f64 {
        match self.rate {
            RunOutRate::Fixed(rate) => rate,
            RunOutRate::CuttingFeed {
                distance_per_turn: way_per_turn,
            } => way_per_turn * spin,
        }
    }

    /// Advances by `time` seconds at `spin` spindle turns/s. The run-out begins once the
    /// spindle turns.
    fn advance(&mut self, spin: f64, time: f64) {
        if spin > 0.0 && time > 0.0 {
            self.rate = RunOutRate::Fixed(self.rate(spin));
        }
        if let RunOutRate::Fixed(_) = self.rate {
            self.elapsed_s += time;
        }
    }

    fn distance_at(&self, passed: f64) -> f64 {
        let lag = if self.time > 0.0 {
            self.time * (1.0 - libm::exp(-passed / self.time))
        } else {
            0.0
        };
        let RunOutRate::Fixed(rate) = self.rate else {
            return 0.0;
        };
        (rate * (passed - lag)).clamp(0.0, self.distance.abs())
    }

    fn is_finished(&self) -> bool {
        self.distance_at(self.elapsed_s) >= self.distance.abs()
    }

    fn position(&self) -> f64 {
        if self.is_finished() {
            return self.from + self.distance;
        }
        self.from + self.distance_at(self.elapsed_s) * self.distance.signum()
    }

    /// Duration of the run-out at `spin` spindle turns/s, s. Newton's steps approach it
    /// from above.
    fn duration(&self, spin: f64) -> f64 {
        let straight_s = self.distance.abs() / self.rate(spin);
        if self.time <= 0.0 || !straight_s.is_finite() {
            return straight_s;
        }
        let mut whole = straight_s + self.time;
        for _ in 0..8 {
            let risen = 1.0 - libm::exp(-whole / self.time);
            whole -= (whole - self.time * risen - straight_s) / risen;
        }
        whole
    }
}

/// A thread that is being executed and follows the spindle angle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ThreadMotion {
    path: CutPath,
    #[serde(rename = "way")]
    lead_distance: f64,
    lead: f64,
    increase: f64,
    last_lead: f64,
    #[serde(rename = "total")]
    total_turns: f64,
    follower: SpindleFollower,
    #[serde(rename = "tail")]
    run_out: Option<ShortAxisRunOut>,
}

impl ThreadMotion {
    /// Creates the motion of a thread from `from`, mm; `before` is the state that the previous
    /// thread has passed on; `None` without one.
    pub fn new(
        from: Point,
        thread: &ThreadMove,
        before: Option<Handover>,
        limits: &MotionLimits,
    ) -> Self {
        let follower = match (thread.start, before) {
            (ThreadStart::AtIndex { degrees }, _) => {
                SpindleFollower::waiting(FollowerWait::from_degrees(degrees))
            }
            (ThreadStart::Continued, None) => {
                SpindleFollower::waiting(FollowerWait::from_degrees(0.0))
            }
            (ThreadStart::Continued, Some(before)) => SpindleFollower::continuing(&before),
        };
        Self {
            path: CutPath::line(from, thread.to),
            lead_distance: thread.lead_distance(from),
            lead: thread.lead.abs().max(1e-6),
            increase: thread.increase,
            last_lead: thread.last_lead(from),
            total_turns: thread.turns(from),
            follower,
            run_out: thread.short_axis_run_out(from, limits),
        }
    }

    /// Whether the thread has begun to follow the spindle.
    pub const fn is_running(&self) -> bool {
        self.follower.is_running()
    }

    /// Whether the thread follows the spindle and the spindle turns.
    pub const fn is_moving(&self) -> bool {
        self.follower.is_moving()
    }

    /// Returns the end point of the thread, mm.
    pub const fn to(&self) -> Point {
        self.path.to()
    }

    /// Whether the end of the thread and of its run-out is reached.
    pub fn is_finished(&self) -> bool {
        self.has_arrived() && self.run_out.is_none_or(|tail| tail.is_finished())
    }

    fn has_arrived(&self) -> bool {
        self.follower.turns_done() >= self.total_turns
    }

    /// Whether the thread passes its speed on to a thread that follows. A run-out whose
    /// short axis has its own law does not, but stops.
    const fn passes_speed_on(&self, continues: bool) -> bool {
        continues && self.run_out.is_none()
    }

    /// Advances by `time` seconds, the last part of the tick. Returns the time used, s, which is
    /// less than `time` only if the end is reached.
    pub fn advance(&mut self, tick: &SpindleTick<'_>, time: f64) -> f64 {
        if self.total_turns <= 0.0 {
            return 0.0;
        }
        let slows_down = !self.passes_speed_on(tick.continues);
        let travel = FollowerTravel {
            turns: self.total_turns,
            first_lead: self.lead,
            last_lead: slows_down.then_some(self.last_lead),
        };
        let step_time = self.follower.advance(tick, travel, time);
        match &mut self.run_out {
            Some(tail) if !tail.is_finished() => {
                tail.advance(tick.rpm.abs() / 60.0, step_time.available_s);
                step_time.waiting_s + step_time.available_s
            }
            _ => step_time.waiting_s + step_time.used_s,
        }
    }

    /// Returns the current position of the tool, mm.
    pub fn position(&self) -> Point {
        let mut at = if self.has_arrived() {
            self.path.to()
        } else {
            let turns = self.follower.turns_done();
            let distance = turns * (self.lead + self.increase * turns / 2.0);
            let rest = (1.0 - distance / self.lead_distance).clamp(0.0, 1.0);
            self.path.point_at(rest * self.path.length())
        };
        if let Some(tail) = &self.run_out {
            *at.get_mut(tail.axis) = tail.position();
        }
        at
    }

    /// Returns the state for a thread that continues this finished one; `continues` is `true` if
    /// such a thread follows without a stop.
    pub(crate) fn handover(&self, continues: bool) -> Handover {
        self.follower
            .handover(self.total_turns, self.passes_speed_on(continues))
    }

    /// Returns the thread shifted by a vector, mm.
    pub fn shifted(self, by: Point) -> Self {
        Self {
            path: self.path.shifted(by),
            run_out: self.run_out.map(|tail| ShortAxisRunOut {
                from: tail.from + by.get(tail.axis),
                ..tail
            }),
            ..self
        }
    }
}
