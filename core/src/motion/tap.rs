//! Tapping (G33): Z follows the spindle in, through its stop and reversal, and out to its
//! start (manual I-3.2.4.3).
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

use super::follower::{Follower, SpindleTick, Wait, Way};
use crate::units::Point;

/// A tap under way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Tap {
    from: Point,
    to: Point,
    lead: f64,
    follower: Follower,
    /// Turns of the way out, once it has begun.
    #[serde(rename = "out")]
    out: Option<f64>,
}

impl Tap {
    /// A tap from `from` to the bottom `to`; `lead` in mm per turn, `degrees` after the
    /// index.
    pub fn new(from: Point, to: Point, lead: f64, degrees: f64) -> Self {
        Self {
            from,
            to,
            lead: lead.abs().max(1e-6),
            follower: Follower::waiting(Wait::degrees(degrees)),
            out: None,
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

    /// End point of the present direction.
    pub const fn to(&self) -> Point {
        if self.out.is_some() {
            self.from
        } else {
            self.to
        }
    }

    /// Whether the programmed depth is reached.
    pub(crate) fn at_bottom(&self) -> bool {
        let depth = (self.to.z - self.from.z).abs();
        self.out.is_none() && self.running() && self.follower.done() * self.lead >= depth
    }

    /// Reverses: the other direction of the spindle leads out.
    pub(crate) fn turn_back(&mut self) {
        if self.out.is_none() {
            self.out = Some(self.follower.done().max(0.0));
            self.follower.turn_back();
        }
    }

    /// Whether the tool is back at the start.
    pub fn finished(&self) -> bool {
        self.out.is_some_and(|total| self.follower.done() >= total)
    }

    /// Advances by `time` seconds, the last of the tick. Returns the time used.
    pub fn advance(&mut self, tick: &SpindleTick<'_>, time: f64) -> f64 {
        let way = Way {
            turns: self.out.unwrap_or(f64::INFINITY),
            first_lead: self.lead,
            last_lead: self.out.map(|_| self.lead),
        };
        let spent = self.follower.advance(tick, way, time);
        spent.waiting + spent.used
    }

    /// Current position of the tool.
    pub fn position(&self) -> Point {
        if self.finished() {
            return self.from;
        }
        let deep = match self.out {
            Some(total) => total - self.follower.done(),
            None => self.follower.done().max(0.0),
        };
        let inwards = if self.to.z < self.from.z { -1.0 } else { 1.0 };
        Point::new(self.from.x, self.from.z + inwards * deep * self.lead)
    }

    /// The tap shifted by a vector.
    pub fn translated(self, by: Point) -> Self {
        Self {
            from: self.from + by,
            to: self.to + by,
            ..self
        }
    }
}
