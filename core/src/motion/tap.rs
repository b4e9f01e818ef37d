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

/// A tap that is being executed: Z follows the spindle in, and out after the reversal.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct TapMotion {
    from: Point,
    to: Point,
    lead: f64,
    follower: SpindleFollower,
    /// Number of spindle turns from the reversal back to the start; `None` before the reversal.
    #[serde(rename = "out")]
    out_turns: Option<f64>,
}

impl TapMotion {
    /// Creates a tap from `from` to the bottom `to`, mm. `lead` is in mm per turn, `degrees` is the
    /// spindle angle after the one-turn signal at which it starts.
    pub fn new(from: Point, to: Point, lead: f64, degrees: f64) -> Self {
        Self {
            from,
            to,
            lead: lead.abs().max(1e-6),
            follower: SpindleFollower::waiting(FollowerWait::from_degrees(degrees)),
            out_turns: None,
        }
    }

    /// Whether the tap has begun to follow the spindle.
    pub const fn is_running(&self) -> bool {
        self.follower.is_running()
    }

    /// Whether the tap follows the spindle and the spindle turns.
    pub const fn is_moving(&self) -> bool {
        self.follower.is_moving()
    }

    /// End point of the current direction, mm: the bottom, or the start after the reversal.
    pub const fn to(&self) -> Point {
        if self.out_turns.is_some() {
            self.from
        } else {
            self.to
        }
    }

    /// Whether the tap has reached the programmed depth and not begun to move out.
    pub(crate) fn is_at_bottom(&self) -> bool {
        let depth = (self.to.z - self.from.z).abs();
        self.out_turns.is_none()
            && self.is_running()
            && self.follower.turns_done() * self.lead >= depth
    }

    /// Reverses the tap: the other direction of the spindle moves the tool out.
    pub(crate) fn reverse(&mut self) {
        if self.out_turns.is_none() {
            self.out_turns = Some(self.follower.turns_done().max(0.0));
            self.follower.reverse();
        }
    }

    /// Whether the tool is back at the start of the tap.
    pub fn is_finished(&self) -> bool {
        self.out_turns
            .is_some_and(|total| self.follower.turns_done() >= total)
    }

    /// Advances by `time` seconds, the last part of the tick. Returns the time used, s, which is
    /// less than `time` only if the end is reached.
    pub fn advance(&mut self, tick: &SpindleTick<'_>, time: f64) -> f64 {
        let travel = FollowerTravel {
            turns: self.out_turns.unwrap_or(f64::INFINITY),
            first_lead: self.lead,
            last_lead: self.out_turns.map(|_| self.lead),
        };
        let step_time = self.follower.advance(tick, travel, time);
        step_time.waiting_s + step_time.used_s
    }

    /// Returns the current position of the tool, mm.
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

    /// Returns the tap shifted by a vector, mm.
    pub fn shifted(self, by: Point) -> Self {
        Self {
            from: self.from + by,
            to: self.to + by,
            ..self
        }
    }
}
