//! Tapping (G33): Z follows the spindle in, through its stop and reversal, and out
//! again to where it began (manual I-3.2.4.3).
//!
//! ```text
//!  Z │ start ─.                          .─ end of the block
//!    │         '.  in phase            .'
//!    │           '.                  .'   out phase: the same lead
//!    │  end ─ ─ ─ ─'.─ ─ M05 ─ ─ ─ .'
//!    │                ' . ____ . '        the spindle runs out, stands, reverses
//!    └──────────────────────────────────► t
//! ```

use serde::{Deserialize, Serialize};

use super::gear::{Gear, GearEnd};
use super::thread::{SpindleTick, Wait};
use crate::units::{Point, TICK_S};

/// A tap under way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Tap {
    from: Point,
    to: Point,
    lead: f64,
    wait: Option<Wait>,
    begin: f64,
    direction: f64,
    turned: f64,
    gear: Gear,
    /// Turns of the way out, once it is asked for.
    out: Option<f64>,
}

impl Tap {
    /// A tap from `from` to the bottom `to`.
    pub fn new(from: Point, to: Point, lead: f64, degrees: f64) -> Self {
        Self {
            from,
            to,
            lead: lead.abs().max(1e-6),
            wait: Some(Wait::degrees(degrees)),
            begin: 0.0,
            direction: 1.0,
            turned: 0.0,
            gear: Gear::default(),
            out: None,
        }
    }

    /// Whether the tool has begun to follow.
    pub const fn running(&self) -> bool {
        self.wait.is_none()
    }

    /// Where it goes at present.
    pub const fn to(&self) -> Point {
        if self.out.is_some() {
            self.from
        } else {
            self.to
        }
    }

    /// Whether the programmed depth is reached.
    pub fn at_bottom(&self) -> bool {
        let depth = (self.to.z - self.from.z).abs();
        self.out.is_none() && self.running() && self.gear.done * self.lead >= depth
    }

    /// Turns round: the way made counts back, the other direction of the spindle
    /// leads out.
    pub fn turn_back(&mut self) {
        if self.out.is_some() {
            return;
        }
        self.out = Some(self.gear.done.max(0.0));
        self.begin += self.direction * self.turned;
        self.direction = -self.direction;
        self.turned = 0.0;
        self.gear = Gear {
            rate: 1.0,
            done: 0.0,
        };
    }

    /// Whether it is back at the start.
    pub fn finished(&self) -> bool {
        self.out.is_some_and(|total| self.gear.done >= total)
    }

    /// Goes on for `time` seconds, the last of the tick; the time used.
    pub fn advance(&mut self, tick: &SpindleTick<'_>, time: f64) -> f64 {
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
        let last = law.lowest_rate(self.lead, spin);
        let end = GearEnd {
            total: self.out.unwrap_or(f64::INFINITY),
            last: (self.out.is_some() && last < 1.0).then_some(last),
        };
        let used = self.gear.advance(law, end, turned - self.turned, time);
        self.turned = turned;
        unused + used
    }

    /// Where the tool is.
    pub fn position(&self) -> Point {
        if self.finished() {
            return self.from;
        }
        let deep = match self.out {
            Some(total) => total - self.gear.done,
            None => self.gear.done.max(0.0),
        };
        let inwards = if self.to.z < self.from.z { -1.0 } else { 1.0 };
        Point::new(self.from.x, self.from.z + inwards * deep * self.lead)
    }

    /// The same tap elsewhere.
    pub fn translated(self, by: Point) -> Self {
        Self {
            from: self.from + by,
            to: self.to + by,
            ..self
        }
    }
}
