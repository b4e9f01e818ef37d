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

use super::follower::{Follower, Handover, SpindleTick, Wait, Way};
use super::limits::MotionLimits;
use super::path::Path;
use crate::command::{Action, ThreadStart};
use crate::units::{Axis, Point};

/// A thread to cut.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ThreadMove {
    /// End point, machine coordinates.
    pub to: Point,
    /// Axis that the lead is measured along.
    #[serde(rename = "long")]
    pub long: Axis,
    /// Lead at the start, mm per turn.
    pub lead: f64,
    /// Change of the lead, mm per turn and turn.
    pub increase: f64,
    /// Spindle angle at which the thread begins.
    pub start: ThreadStart,
    /// Whether this is the run-out that leaves the thread.
    pub run_out: bool,
}

impl ThreadMove {
    /// The thread of a command; `None` for other actions.
    pub fn of(action: &Action) -> Option<Self> {
        let Action::Thread {
            to,
            long,
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
            long: *long,
            lead: *lead,
            increase: *increase,
            start: *start,
            run_out: *run_out,
        })
    }

    /// The length along which the lead is measured, mm: that of the path if the lead axis
    /// does not move.
    fn way(&self, from: Point) -> f64 {
        let displacement = self.to - from;
        let way = displacement.get(self.long).abs();
        if way > 0.0 {
            way
        } else {
            displacement.length()
        }
    }

    /// Turns of the whole thread, from `way = F n + R n² / 2`.
    pub(crate) fn turns(&self, from: Point) -> f64 {
        let (way, lead) = (self.way(from), self.lead.abs().max(1e-6));
        if self.increase == 0.0 {
            return way / lead;
        }
        let last = lead * lead + 2.0 * self.increase * way;
        2.0 * way / (lead + last.max(0.0).sqrt())
    }

    /// Distance along the path at the start, mm per turn.
    pub(crate) fn lead_along(&self, from: Point) -> f64 {
        let way = self.way(from).max(1e-9);
        self.lead.abs() * (self.to - from).length() / way
    }

    /// Lead at the end, mm per turn.
    pub(crate) fn last_lead(&self, from: Point) -> f64 {
        (self.lead + self.increase * self.turns(from)).max(1e-6)
    }

    /// Highest speed of each axis at a spindle speed, mm/min.
    pub fn top_speed(&self, from: Point, rpm: f64, limits: &MotionLimits) -> Point {
        let way = self.way(from);
        if way <= 0.0 {
            return Point::default();
        }
        let along = self.lead.max(self.last_lead(from)) * rpm.abs() / way;
        let displacement = self.to - from;
        let mut top = Point::new(displacement.x.abs(), displacement.z.abs()) * along;
        if let Some(tail) = self.tail(from, limits) {
            *top.get_mut(tail.axis) = tail.rate(rpm.abs() / 60.0) * 60.0;
        }
        top
    }

    /// Duration from standstill (or in phase from the thread before) to the end, and the
    /// further time of slowing down when no thread follows, s.
    pub fn duration(&self, from: Point, rpm: f64, limits: &MotionLimits) -> (f64, f64) {
        let (total, spin) = (self.turns(from), rpm.abs() / 60.0);
        let law = limits.gear_law();
        let first = match self.start {
            ThreadStart::Continued => 1.0,
            ThreadStart::AtIndex { .. } => law.lowest_rate(self.lead, spin),
        };
        let last = law.lowest_rate(self.last_lead(from), spin);
        let mut going_on = law.duration(total, spin, first, 1.0);
        let mut stopping = law.duration(total, spin, first, last);
        if let Some(tail) = self.tail(from, limits) {
            let leaving = tail.duration(spin);
            going_on = going_on.max(leaving);
            stopping = stopping.max(leaving);
        }
        (going_on, (stopping - going_on).max(0.0))
    }

    /// The short axis of a run-out: at its own speed (107), or at the cutting feed with the
    /// time constant of 026. Without either it stays on the straight line (`None`).
    fn tail(&self, from: Point, limits: &MotionLimits) -> Option<Tail> {
        let (axis, factor) = match self.long {
            Axis::X => (Axis::Z, 2.0),
            Axis::Z => (Axis::X, 1.0),
        };
        let way = self.to.get(axis) - from.get(axis);
        let own = limits.tail_rate() * factor;
        let time = limits.tail_time();
        let rate = if own > 0.0 {
            TailRate::Own(own)
        } else {
            TailRate::CuttingFeed {
                way_per_turn: way.abs() / self.turns(from),
            }
        };
        (self.run_out && way != 0.0 && (own > 0.0 || time > 0.0)).then(|| Tail {
            axis,
            from: from.get(axis),
            way,
            rate,
            time,
            passed: 0.0,
        })
    }
}

/// Speed of the short axis in the run-out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum TailRate {
    /// Fixed speed, mm/s: that of 107, or the cutting feed once the run-out has begun.
    #[serde(rename = "Own")]
    Own(f64),
    /// The speed of the straight line to the end at the spindle speed with which the
    /// run-out begins (107 = 0).
    CuttingFeed {
        /// Distance per turn, mm.
        #[serde(rename = "way_per_turn")]
        way_per_turn: f64,
    },
}

/// The short axis of a run-out: `x = v (t - T (1 - e^(-t/T)))`, v of 107 or the
/// cutting feed, T of 026 (manual I-3.2.4.4, III-12.5).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Tail {
    axis: Axis,
    from: f64,
    #[serde(rename = "way")]
    way: f64,
    rate: TailRate,
    time: f64,
    #[serde(rename = "passed")]
    passed: f64,
}

impl Tail {
    /// Final speed at `spin` turns/s of the spindle, mm/s.
    const fn rate(&self, spin: f64) -> f64 {
        match self.rate {
            TailRate::Own(rate) => rate,
            TailRate::CuttingFeed { way_per_turn } => way_per_turn * spin,
        }
    }

    /// Advances by `time` seconds at `spin` turns/s; begins with a spindle that turns.
    fn advance(&mut self, spin: f64, time: f64) {
        if spin > 0.0 && time > 0.0 {
            self.rate = TailRate::Own(self.rate(spin));
        }
        if let TailRate::Own(_) = self.rate {
            self.passed += time;
        }
    }

    fn made(&self, passed: f64) -> f64 {
        let lag = if self.time > 0.0 {
            self.time * (1.0 - libm::exp(-passed / self.time))
        } else {
            0.0
        };
        let TailRate::Own(rate) = self.rate else {
            return 0.0;
        };
        (rate * (passed - lag)).clamp(0.0, self.way.abs())
    }

    fn finished(&self) -> bool {
        self.made(self.passed) >= self.way.abs()
    }

    fn at(&self) -> f64 {
        if self.finished() {
            return self.from + self.way;
        }
        self.from + self.made(self.passed) * self.way.signum()
    }

    /// Duration of the run-out, s; Newton's steps approach it from above.
    fn duration(&self, spin: f64) -> f64 {
        let straight = self.way.abs() / self.rate(spin);
        if self.time <= 0.0 || !straight.is_finite() {
            return straight;
        }
        let mut whole = straight + self.time;
        for _ in 0..8 {
            let risen = 1.0 - libm::exp(-whole / self.time);
            whole -= (whole - self.time * risen - straight) / risen;
        }
        whole
    }
}

/// A thread under way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Thread {
    path: Path,
    #[serde(rename = "way")]
    way: f64,
    lead: f64,
    increase: f64,
    last_lead: f64,
    #[serde(rename = "total")]
    total: f64,
    follower: Follower,
    #[serde(rename = "tail")]
    tail: Option<Tail>,
}

impl Thread {
    /// A thread from `from`; `before` is the state that the thread before passed on.
    pub fn new(
        from: Point,
        thread: &ThreadMove,
        before: Option<Handover>,
        limits: &MotionLimits,
    ) -> Self {
        let follower = match (thread.start, before) {
            (ThreadStart::AtIndex { degrees }, _) => Follower::waiting(Wait::degrees(degrees)),
            (ThreadStart::Continued, None) => Follower::waiting(Wait::degrees(0.0)),
            (ThreadStart::Continued, Some(before)) => Follower::going_on(&before),
        };
        Self {
            path: Path::line(from, thread.to),
            way: thread.way(from),
            lead: thread.lead.abs().max(1e-6),
            increase: thread.increase,
            last_lead: thread.last_lead(from),
            total: thread.turns(from),
            follower,
            tail: thread.tail(from, limits),
        }
    }

    /// Whether the tool follows the spindle.
    pub const fn running(&self) -> bool {
        self.follower.running()
    }

    /// Whether the tool follows a spindle that turns.
    pub const fn is_moving(&self) -> bool {
        self.follower.is_moving()
    }

    /// End point.
    pub const fn to(&self) -> Point {
        self.path.to()
    }

    /// Whether the end is reached.
    pub fn finished(&self) -> bool {
        self.arrived() && self.tail.is_none_or(|tail| tail.finished())
    }

    fn arrived(&self) -> bool {
        self.follower.done() >= self.total
    }

    /// Whether the thread passes its speed on to a thread that follows. A run-out whose
    /// short axis has its own law stops.
    const fn passes_on(&self, continues: bool) -> bool {
        continues && self.tail.is_none()
    }

    /// Advances by `time` seconds, the last of the tick. Returns the time used.
    pub fn advance(&mut self, tick: &SpindleTick<'_>, time: f64) -> f64 {
        if self.total <= 0.0 {
            return 0.0;
        }
        let comes_down = !self.passes_on(tick.continues);
        let way = Way {
            turns: self.total,
            first_lead: self.lead,
            last_lead: comes_down.then_some(self.last_lead),
        };
        let spent = self.follower.advance(tick, way, time);
        match &mut self.tail {
            Some(tail) if !tail.finished() => {
                tail.advance(tick.rpm.abs() / 60.0, spent.offered);
                spent.waiting + spent.offered
            }
            _ => spent.waiting + spent.used,
        }
    }

    /// Current position of the tool.
    pub fn position(&self) -> Point {
        let mut at = if self.arrived() {
            self.path.to()
        } else {
            let turns = self.follower.done();
            let made = turns * (self.lead + self.increase * turns / 2.0);
            let rest = (1.0 - made / self.way).clamp(0.0, 1.0);
            self.path.at(rest * self.path.length())
        };
        if let Some(tail) = &self.tail {
            *at.get_mut(tail.axis) = tail.at();
        }
        at
    }

    /// State for a thread that continues this finished one.
    pub(crate) fn handover(&self, continues: bool) -> Handover {
        self.follower
            .handover(self.total, self.passes_on(continues))
    }

    /// The thread shifted by a vector.
    pub fn translated(self, by: Point) -> Self {
        Self {
            path: self.path.translated(by),
            tail: self.tail.map(|tail| Tail {
                from: tail.from + by.get(tail.axis),
                ..tail
            }),
            ..self
        }
    }
}
