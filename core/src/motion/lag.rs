//! Cuts that continue into each other (007.3 SMZ = 0): the acceleration acts after the
//! interpolation. The command runs along the path at the feed, block after block, and the
//! tool follows it with a lag.
//!
//! ```text
//!   command ──────────────●          v = FL + lag / T, towards the command
//!                    lag ╱           T: 029, FL: 030
//!   tool  ──────────── ●
//! ```
//!
//! On a straight line this is the law of [`Law::Exponential`]: from rest the speed is `F -
//! (F - FL) e^(-t/T)`, the lag reaches `T (F - FL)`, and after the command has stopped the
//! tool needs `T ln(F / FL)` for the rest. At a corner the tool cuts the corner; on an arc
//! it follows a smaller one.

use serde::{Deserialize, Serialize};

use super::ramp::Law;
use crate::units::Point;

/// A lag below this counts as zero, mm.
const NOTHING: f64 = 1e-9;

/// Lag of the tool after the command.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Lag {
    /// Vector from the tool to the command, mm.
    #[serde(rename = "behind")]
    pub behind: Point,
}

impl Lag {
    /// Whether the tool is at the command.
    pub fn is_none(&self) -> bool {
        self.behind == Point::default()
    }

    /// Advances the command evenly by `way` in `time` seconds.
    pub fn follow(&mut self, law: &Law, way: Point, time: f64) {
        let Law::Exponential {
            time: constant,
            lowest,
            ..
        } = *law
        else {
            return self.behind = Point::default();
        };
        if time <= 0.0 {
            self.behind = self.behind + way;
            return;
        }
        if constant <= 0.0 {
            return self.behind = Point::default();
        }
        let speed = way * (1.0 / time);
        let mut left = time;
        // Each iteration is one direction of the lag.
        for _ in 0..4 {
            if left <= 1e-15 {
                return;
            }
            left -= self.phase(law, constant, lowest, speed, left);
        }
    }

    /// Advances until the lag in its direction is zero, at most for `left` seconds. Returns
    /// the time used.
    fn phase(&mut self, law: &Law, constant: f64, lowest: f64, speed: Point, left: f64) -> f64 {
        let distance = self.behind.length();
        let along = if distance > NOTHING {
            self.behind * (1.0 / distance)
        } else {
            self.behind = Point::default();
            let rate = speed.length();
            if rate <= lowest {
                return left;
            }
            speed * (1.0 / rate)
        };
        let distance = if distance > NOTHING { distance } else { 0.0 };
        let limit = (speed - along * lowest) * constant;
        let shrinking = -limit.dot(along);
        let mut span = left;
        let mut ends = false;
        if shrinking > 0.0 {
            let until = constant * libm::log1p(distance / shrinking);
            ends = until <= left;
            span = until.min(left);
        }
        let rest = law.decay(span);
        let behind = if ends {
            let behind = limit + (self.behind - limit) * rest;
            behind - along * behind.dot(along)
        } else {
            // FL acts along the resulting lag, so that its direction cannot oscillate.
            let whole = speed * (constant * (1.0 - rest)) + self.behind * rest;
            let length = whole.length();
            let left = (length - lowest * constant * (1.0 - rest)).max(0.0);
            whole * (left / length.max(NOTHING))
        };
        self.behind = if behind.length() > NOTHING {
            behind
        } else {
            Point::default()
        };
        span
    }

    /// Advances by `time` seconds with the command at rest. Returns the time used, which is
    /// less than `time` only when the tool has arrived.
    pub(crate) fn close_up(&mut self, law: &Law, time: f64) -> f64 {
        let until = self.time_to_close(law);
        if until <= time {
            self.behind = Point::default();
            return until;
        }
        self.follow(law, Point::default(), time);
        time
    }

    /// Time in which the tool reaches a command at rest, s.
    pub(crate) fn time_to_close(&self, law: &Law) -> f64 {
        match *law {
            Law::Exponential { time, lowest, .. } if time > 0.0 => {
                time * libm::log1p(self.behind.length() / (time * lowest))
            }
            _ => 0.0,
        }
    }
}
