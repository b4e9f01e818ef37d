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
//! On a straight line this is the law of [`SpeedLaw::Exponential`]: from rest the speed is `F -
//! (F - FL) e^(-t/T)`, the lag reaches `T (F - FL)`, and after the command has stopped the
//! tool needs `T ln(F / FL)` for the rest. At a corner the tool cuts the corner; on an arc
//! it follows a smaller one.

use serde::{Deserialize, Serialize};

use super::ramp::SpeedLaw;
use crate::units::Point;

/// Greatest lag that counts as zero, mm.
const MIN_LAG_MM: f64 = 1e-9;

/// Lag of the tool after the commanded position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Lag {
    /// Vector from the tool to the commanded position, mm.
    #[serde(rename = "behind")]
    pub vector: Point,
}

impl Lag {
    /// Whether the tool is at the commanded position.
    pub fn is_zero(&self) -> bool {
        self.vector == Point::default()
    }

    /// Moves the commanded position evenly by `displacement`, mm, in `time` seconds; the tool
    /// follows it by `law`, and the lag changes.
    pub fn follow(&mut self, law: &SpeedLaw, displacement: Point, time: f64) {
        let SpeedLaw::Exponential {
            time: constant,
            lowest,
            ..
        } = *law
        else {
            return self.vector = Point::default();
        };
        if time <= 0.0 {
            self.vector = self.vector + displacement;
            return;
        }
        if constant <= 0.0 {
            return self.vector = Point::default();
        }
        let speed = displacement * (1.0 / time);
        let mut left = time;
        // Each iteration is one direction of the lag.
        for _ in 0..4 {
            if left <= 1e-15 {
                return;
            }
            left -= self.advance_phase(law, constant, lowest, speed, left);
        }
    }

    /// Advances until the lag in its current direction is zero, for `left` seconds at most. Returns
    /// the time used, s. `constant` is the time constant, s, `lowest` the lowest speed, mm/s,
    /// `speed` that of the commanded position, mm/s.
    fn advance_phase(
        &mut self,
        law: &SpeedLaw,
        constant: f64,
        lowest: f64,
        speed: Point,
        left: f64,
    ) -> f64 {
        let distance = self.vector.length();
        let along = if distance > MIN_LAG_MM {
            self.vector * (1.0 / distance)
        } else {
            self.vector = Point::default();
            let rate = speed.length();
            if rate <= lowest {
                return left;
            }
            speed * (1.0 / rate)
        };
        let distance = if distance > MIN_LAG_MM { distance } else { 0.0 };
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
        let vector = if ends {
            let unclamped = limit + (self.vector - limit) * rest;
            unclamped - along * unclamped.dot(along)
        } else {
            // FL acts along the resulting lag, so that its direction cannot oscillate.
            let whole = speed * (constant * (1.0 - rest)) + self.vector * rest;
            let length = whole.length();
            let left = (length - lowest * constant * (1.0 - rest)).max(0.0);
            whole * (left / length.max(MIN_LAG_MM))
        };
        self.vector = if vector.length() > MIN_LAG_MM {
            vector
        } else {
            Point::default()
        };
        span
    }

    /// Lets the tool approach a commanded position at rest for `time` seconds. Returns the time
    /// used, s, which is less than `time` only if the tool has arrived.
    pub(crate) fn close_lag(&mut self, law: &SpeedLaw, time: f64) -> f64 {
        let until = self.time_to_close(law);
        if until <= time {
            self.vector = Point::default();
            return until;
        }
        self.follow(law, Point::default(), time);
        time
    }

    /// Time in which the tool reaches a commanded position at rest, s.
    pub(crate) fn time_to_close(&self, law: &SpeedLaw) -> f64 {
        match *law {
            SpeedLaw::Exponential { time, lowest, .. } if time > 0.0 => {
                time * libm::log1p(self.vector.length() / (time * lowest))
            }
            _ => 0.0,
        }
    }
}
