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

use super::spindle_follower::{FollowerTravel, FollowerWait, SpindleFollower, SpindleTick};
use crate::units::Point;

/// A tap under way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct TapMotion {
    from: Point,
    to: Point,
    lead: f64,
    follower: SpindleFollower,
    /// Turns of the way out, once it has begun.
    #[serde(rename = "out")]
    out_turns: Option<f64>,
}

impl TapMotion {
    /// A tap from `from` to the bottom `to`; `lead` in mm per turn, `degrees` after the
    /// index.
    pub fn new(from: Point, to: Point, lead: f64, degrees: f64) -> Self {
        Self {
            from,
            to,
            lead: lead.abs().max(1e-6),
            follower: SpindleFollower::waiting(FollowerWait::from_degrees(degrees)),
            out_turns: None,
        }
    }

    /// Whether the tool follows the spindle.
    pub const fn is_running(&self) -> bool {
        self.follower.is_running()
    }

    /// Whether the tool follows a spindle that turns.
    pub const fn is_moving(&self) -> bool {
        self.follower.is_moving()
    }

    /// End point of the present direction.
    pub const fn to(&self) -> Point {
        if self.out_turns.is_some() {
            self.from
        } else {
            self.to
        }
    }

    /// Whether the programmed depth is reached.
    pub(crate) fn is_at_bottom(&self) -> bool {
        let depth = (self.to.z - self.from.z).abs();
        self.out_turns.is_none()
            && self.is_running()
            && self.follower.turns_done() * self.lead >= depth
    }

    /// Reverses: the other direction of the spindle leads out.
    pub(crate) fn reverse(&mut self) {
        if self.out_turns.is_none() {
            self.out_turns = Some(self.follower.turns_done().max(0.0));
            self.follower.reverse();
        }
    }

    /// Whether the tool is back at the start.
    pub fn is_finished(&self) -> bool {
        self.out_turns
            .is_some_and(|total| self.follower.turns_done() >= total)
    }

    /// Advances by `time` seconds, the last of the tick. Returns the time used.
    pub fn advance(&mut self, tick: &SpindleTick<'_>, time: f64) -> f64 {
        let travel = FollowerTravel {
            turns: self.out_turns.unwrap_or(f64::INFINITY),
            first_lead: self.lead,
            last_lead: self.out_turns.map(|_| self.lead),
        };
        let step_time = self.follower.advance(tick, travel, time);
        step_time.waiting_s + step_time.used_s
    }

    /// Current position of the tool.
    pub fn position(&self) -> Point {
        if self.is_finished() {
            return self.from;
        }
        let depth_turns = match self.out_turns {
            Some(total) => total - self.follower.turns_done(),
            None => self.follower.turns_done().max(0.0),
        };
        let inwards = if self.to.z < self.from.z { -1.0 } else { 1.0 };
        Point::new(self.from.x, self.from.z + inwards * depth_turns * self.lead)
    }

    /// The tap shifted by a vector.
    pub fn shifted(self, by: Point) -> Self {
        Self {
            from: self.from + by,
            to: self.to + by,
            ..self
        }
    }
}
