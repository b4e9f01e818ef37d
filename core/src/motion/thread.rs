//! Threads: a straight line whose way along the long axis follows the angle of the
//! spindle (manual I-3.2.4).
//!
//! ```text
//!   index        begin                    begin + turns
//!  ───┴── phase ───┴──────────────────────────┴──────► spindle angle
//!      360° j / L  way = F n + R n² / 2
//! ```
//!
//! A thread begins at its angle after the one-turn signal; one that follows a thread
//! goes on at the angle where that one ended, without slowing down in between.
//! Between the ends the [`Gear`](super::gear::Gear) makes lead-in and tail.

use serde::{Deserialize, Serialize};

use super::gear::{Gear, GearEnd, GearLaw};
use super::limits::MotionLimits;
use super::path::Path;
use crate::command::ThreadStart;
use crate::spindle::SpindleTurn;
use crate::units::{Axis, Point, TICK_S};

/// A thread to cut.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ThreadMove {
    /// End point.
    pub to: Point,
    /// The axis the lead counts on.
    pub long: Axis,
    /// Lead at the start, mm per turn.
    pub lead: f64,
    /// Change of the lead, mm per turn and turn.
    pub increase: f64,
    /// Where on the turn it begins.
    pub start: ThreadStart,
    /// Whether it is the tail that leaves the thread.
    pub run_out: bool,
}

impl ThreadMove {
    /// The length the lead counts on, mm; that of the path if the long axis does
    /// not move.
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

    /// Lead at the end, mm per turn.
    pub(crate) fn last_lead(&self, from: Point) -> f64 {
        (self.lead + self.increase * self.turns(from)).max(1e-6)
    }

    /// Speed of each axis at its fastest for a spindle speed, mm/min.
    pub fn top_speed(&self, from: Point, rpm: f64) -> Point {
        let way = self.way(from);
        if way <= 0.0 {
            return Point::default();
        }
        let along = self.lead.max(self.last_lead(from)) * rpm.abs() / way;
        let displacement = self.to - from;
        Point::new(displacement.x.abs(), displacement.z.abs()) * along
    }

    /// Seconds from standstill (or in phase from the thread before) to the end;
    /// and the further seconds of slowing down when no thread follows.
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
            let leaving = tail.duration();
            going_on = going_on.max(leaving);
            stopping = stopping.max(leaving);
        }
        (going_on, (stopping - going_on).max(0.0))
    }

    /// The short axis of a run-out with a speed of its own (107).
    fn tail(&self, from: Point, limits: &MotionLimits) -> Option<Tail> {
        let (axis, factor) = match self.long {
            Axis::X => (Axis::Z, 2.0),
            Axis::Z => (Axis::X, 1.0),
        };
        let way = self.to.get(axis) - from.get(axis);
        let rate = limits.tail_rate() * factor;
        (self.run_out && rate > 0.0 && way != 0.0).then(|| Tail {
            axis,
            from: from.get(axis),
            way,
            rate,
            time: limits.tail_time(),
            passed: 0.0,
        })
    }
}

/// The short axis of a run-out: `x = v (t - T (1 - e^(-t/T)))` with 107 and 026.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Tail {
    axis: Axis,
    from: f64,
    way: f64,
    rate: f64,
    time: f64,
    passed: f64,
}

impl Tail {
    fn made(&self, passed: f64) -> f64 {
        let lag = if self.time > 0.0 {
            self.time * (1.0 - libm::exp(-passed / self.time))
        } else {
            0.0
        };
        (self.rate * (passed - lag)).clamp(0.0, self.way.abs())
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

    /// Within a thousandth of the time constant.
    fn duration(&self) -> f64 {
        let mut whole = self.way.abs() / self.rate;
        if self.time > 0.0 {
            for _ in 0..20 {
                let lag = self.time * (1.0 - libm::exp(-whole / self.time));
                whole = self.way.abs() / self.rate + lag;
            }
        }
        whole
    }
}

/// What a thread leaves to the one that goes on from it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Handover {
    /// Angle at which the next thread begins.
    begin: f64,
    direction: f64,
    /// Turns of the spindle beyond that angle already, and rate of the gear.
    turned: f64,
    rate: f64,
}

impl Handover {
    /// The axes came to a stop in between: only the angle counts.
    pub const fn stand_still(&mut self) {
        self.rate = 0.0;
    }
}

/// What a thread or a tap waits for before it begins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Wait {
    /// For the one-turn signal after the one at `seen`, then `phase` turns more.
    Index { seen: Option<f64>, phase: f64 },
    /// For the next time that this angle comes by.
    Angle(f64),
    /// For this angle, in this direction.
    Begin { angle: f64, direction: f64 },
}

impl Wait {
    pub fn degrees(degrees: f64) -> Self {
        let phase = degrees / 360.0;
        Self::Index {
            seen: None,
            phase: phase - phase.floor(),
        }
    }

    /// One tick of waiting. At the beginning: its angle, the direction, and the part
    /// of the tick since then.
    pub fn tick(&mut self, spindle: &SpindleTurn, rpm: f64, hold: bool) -> Option<Beginning> {
        let direction = if rpm < 0.0 { -1.0 } else { 1.0 };
        if hold {
            if let Self::Index { seen, .. } = self {
                *seen = Some(spindle.index);
            }
            return None;
        }
        match *self {
            Self::Index { seen: None, phase } => {
                *self = Self::Index {
                    seen: Some(spindle.index),
                    phase,
                };
            }
            Self::Index {
                seen: Some(seen),
                phase,
            } if seen != spindle.index => {
                let angle = next(spindle.zero + direction * phase, spindle.index, direction);
                *self = Self::Begin { angle, direction };
            }
            Self::Angle(angle) => {
                let angle = next(angle, spindle.now, direction);
                *self = Self::Begin { angle, direction };
            }
            // The spindle was reversed in the meantime.
            Self::Begin {
                angle,
                direction: wanted,
            } if wanted != direction => {
                let angle = next(angle, spindle.now, direction);
                *self = Self::Begin { angle, direction };
            }
            Self::Index { .. } | Self::Begin { .. } => {}
        }
        let Self::Begin { angle, direction } = *self else {
            return None;
        };
        let since = direction * (spindle.now - angle);
        let step = direction * (spindle.now - spindle.before);
        (since > 0.0 && step > 0.0).then(|| Beginning {
            angle,
            direction,
            part: (since / step).min(1.0),
        })
    }
}

/// The first angle equal to `angle` in whole turns that comes at or after `from`.
fn next(angle: f64, from: f64, direction: f64) -> f64 {
    let turns = direction * (from - angle);
    // The signal itself is the beginning, whatever the last bits say.
    angle + direction * (turns - 1e-6).ceil()
}

/// A thread begins within a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beginning {
    pub angle: f64,
    pub direction: f64,
    /// Part of the tick since the beginning.
    pub part: f64,
}

/// What motion tied to the spindle depends on in a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpindleTick<'a> {
    pub limits: &'a MotionLimits,
    pub spindle: &'a SpindleTurn,
    /// Measured speed, r/min.
    pub rpm: f64,
    /// Nothing begins.
    pub hold: bool,
    /// A thread that goes on in phase follows.
    pub continues: bool,
}

/// A thread under way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Thread {
    path: Path,
    way: f64,
    lead: f64,
    increase: f64,
    last_lead: f64,
    total: f64,
    wait: Option<Wait>,
    begin: f64,
    direction: f64,
    /// Turns of the spindle since the beginning.
    turned: f64,
    gear: Gear,
    tail: Option<Tail>,
}

impl Thread {
    /// A thread from `from`; `before` is what the thread before left.
    pub fn new(
        from: Point,
        thread: &ThreadMove,
        before: Option<Handover>,
        limits: &MotionLimits,
    ) -> Self {
        let mut new = Self {
            path: Path::line(from, thread.to),
            way: thread.way(from),
            lead: thread.lead.abs().max(1e-6),
            increase: thread.increase,
            last_lead: thread.last_lead(from),
            total: thread.turns(from),
            wait: None,
            begin: 0.0,
            direction: 1.0,
            turned: 0.0,
            gear: Gear::default(),
            tail: thread.tail(from, limits),
        };
        match (thread.start, before) {
            (ThreadStart::AtIndex { degrees }, _) => new.wait = Some(Wait::degrees(degrees)),
            (ThreadStart::Continued, None) => new.wait = Some(Wait::degrees(0.0)),
            (ThreadStart::Continued, Some(before)) if before.rate <= 0.0 => {
                new.wait = Some(Wait::Angle(before.begin));
            }
            (ThreadStart::Continued, Some(before)) => {
                new.begin = before.begin;
                new.direction = before.direction;
                new.turned = before.turned;
                new.gear.rate = before.rate;
            }
        }
        new
    }

    /// Whether the tool has begun to follow.
    pub const fn running(&self) -> bool {
        self.wait.is_none()
    }

    /// End point.
    pub const fn to(&self) -> Point {
        self.path.to()
    }

    /// Whether the end is reached.
    pub fn finished(&self) -> bool {
        self.gear.done >= self.total && self.tail.is_none_or(|tail| tail.finished())
    }

    /// Goes on for `time` seconds, the last of the tick; the time used.
    pub fn advance(&mut self, tick: &SpindleTick<'_>, time: f64) -> f64 {
        if self.total <= 0.0 {
            return 0.0;
        }
        let law = tick.limits.gear_law();
        let spin = tick.rpm.abs() / 60.0;
        let mut time = time;
        let mut unused = 0.0;
        if let Some(wait) = &mut self.wait {
            let Some(beginning) = wait.tick(tick.spindle, tick.rpm, tick.hold) else {
                return time;
            };
            self.wait = None;
            self.begin = beginning.angle;
            self.direction = beginning.direction;
            self.gear.rate = law.lowest_rate(self.lead, spin);
            unused = time - (beginning.part * TICK_S).min(time);
            time -= unused;
        }
        let turned = self.direction * (tick.spindle.now - self.begin);
        let turns = turned - self.turned;
        let last = law.lowest_rate(self.last_lead, spin);
        let end = GearEnd {
            total: self.total,
            last: (!tick.continues && last < 1.0).then_some(last),
        };
        let used = self.gear.advance(law, end, turns, time);
        self.gear.done = self.gear.done.max(0.0);
        self.turned += turns * if time > 0.0 { used / time } else { 1.0 };
        match &mut self.tail {
            Some(tail) if !tail.finished() => {
                tail.passed += time;
                unused + time
            }
            _ => unused + used,
        }
    }

    /// Where the tool is.
    pub fn position(&self) -> Point {
        let mut at = if self.gear.done >= self.total {
            self.path.to()
        } else {
            let turns = self.gear.done;
            let made = turns * (self.lead + self.increase * turns / 2.0);
            let rest = (1.0 - made / self.way).clamp(0.0, 1.0);
            self.path.at(rest * self.path.length())
        };
        if let Some(tail) = &self.tail {
            *at.get_mut(tail.axis) = tail.at();
        }
        at
    }

    /// What goes to a thread that continues this finished one.
    pub fn handover(&self, continues: bool) -> Handover {
        Handover {
            begin: self.begin + self.direction * self.total,
            direction: self.direction,
            turned: self.turned - self.total,
            rate: if continues { self.gear.rate } else { 0.0 },
        }
    }

    /// The same thread elsewhere.
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

/// The law of lead-in and tail, from the parameters.
pub(super) fn gear_law(parameters: &crate::memory::Parameters) -> GearLaw {
    GearLaw {
        time: parameters.feed_time() / 1000.0,
        exponential: parameters.thread_exponential(),
        lowest: parameters.thread_floor() / 60.0,
    }
}
