//! Cuts that go over into each other (007.3 SMZ = 0): the acceleration acts after the
//! interpolation. The command runs along the path at the feed, block after block, and
//! the tool follows it at a distance.
//!
//! ```text
//!   command ──────────────●          v = FL + lag / T, towards the command
//!                    lag ╱           T: 029, FL: 030
//!   tool  ──────────── ●
//! ```
//!
//! On a straight line this is the law of [`Law::Exponential`]: from rest the speed is
//! `F - (F - FL) e^(-t/T)`, the lag comes to `T (F - FL)`, and after the command has
//! stopped the tool needs `T ln(F / FL)` for the rest. Where the path turns, the tool
//! cuts the corner; on an arc it runs on a smaller one.

use serde::{Deserialize, Serialize};

use super::ramp::Law;
use crate::units::Point;

/// A lag that counts as none, mm.
const NOTHING: f64 = 1e-9;

/// How far the tool is behind the command.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Lag {
    /// From the tool to the command, mm.
    pub behind: Point,
}

impl Lag {
    /// Whether the tool is at the command.
    pub fn is_none(&self) -> bool {
        self.behind == Point::default()
    }

    /// The command goes on by `way` in `time` seconds, evenly.
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
        // Each turn of the loop is one direction of the lag.
        for _ in 0..4 {
            if left <= 1e-15 {
                return;
            }
            left -= self.phase(law, constant, lowest, speed, left);
        }
    }

    /// Goes on until the lag has shrunk to nothing in its direction, at most for
    /// `left` seconds; the time it took.
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
            // FL along the lag as it will be: its direction cannot swing.
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

    /// The command stands: the tool closes up for `time` seconds. Returns the time
    /// it took, less than `time` only when it has arrived.
    pub(crate) fn close_up(&mut self, law: &Law, time: f64) -> f64 {
        let until = self.time_to_close(law);
        if until <= time {
            self.behind = Point::default();
            return until;
        }
        self.follow(law, Point::default(), time);
        time
    }

    /// Seconds until the tool has closed up to a standing command.
    pub(crate) fn time_to_close(&self, law: &Law) -> f64 {
        match *law {
            Law::Exponential { time, lowest, .. } if time > 0.0 => {
                time * libm::log1p(self.behind.length() / (time * lowest))
            }
            _ => 0.0,
        }
    }
}
