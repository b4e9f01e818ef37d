//! Rapid traverse: both axes start together and move separately (manual I-3.1.1).

use serde::{Deserialize, Serialize};

use super::limits::MotionLimits;
use super::ramp::Ramp;
use crate::units::{Axis, PerAxis, Point};

/// A rapid that is being executed, in which each axis moves at its rate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Rapid {
    to: Point,
    ramps: PerAxis<Ramp>,
    negative: PerAxis<bool>,
}

impl Rapid {
    /// Creates a rapid that is at rest at `from` and leads to `to`, mm.
    pub fn new(from: Point, to: Point) -> Self {
        let displacement = to - from;
        Self {
            to,
            ramps: PerAxis::new(
                Ramp::new(displacement.x.abs()),
                Ramp::new(displacement.z.abs()),
            ),
            negative: PerAxis::new(displacement.x < 0.0, displacement.z < 0.0),
        }
    }

    /// Returns the end point of the rapid, mm.
    pub const fn to(&self) -> Point {
        self.to
    }

    /// Whether both axes have reached the end point.
    pub fn is_finished(&self) -> bool {
        self.ramps.x.is_finished() && self.ramps.z.is_finished()
    }

    /// Whether the speed of any axis is above 0.
    pub fn is_moving(&self) -> bool {
        self.ramps.x.speed > 0.0 || self.ramps.z.speed > 0.0
    }

    /// Advances by `dt` seconds towards the target speed of each axis, mm/s. Returns the time used,
    /// s, which is less than `dt` only if the end is reached.
    pub fn advance(&mut self, limits: &MotionLimits, target: PerAxis<f64>, dt: f64) -> f64 {
        let x = self
            .ramps
            .x
            .advance(limits.rapid_law(Axis::X), target.x, dt);
        let z = self
            .ramps
            .z
            .advance(limits.rapid_law(Axis::Z), target.z, dt);
        if self.is_finished() {
            x.used_s.max(z.used_s)
        } else {
            dt
        }
    }

    /// Position of the axes, mm, after each has moved a further distance `ahead`, mm.
    fn position_after(&self, ahead: PerAxis<f64>) -> Point {
        let coordinate = |axis| {
            let rest = (self.ramps.get(axis).remaining - ahead.get(axis)).max(0.0);
            let signed = if *self.negative.get(axis) {
                -rest
            } else {
                rest
            };
            self.to.get(axis) - signed
        };
        Point::new(coordinate(Axis::X), coordinate(Axis::Z))
    }

    /// Returns the current position of the axes, mm.
    pub fn position(&self) -> Point {
        self.position_after(PerAxis::new(0.0, 0.0))
    }

    /// Position at which the axes stop if they brake now, mm.
    pub(crate) fn stopping_point(&self, limits: &MotionLimits) -> Point {
        let braking_distance = |axis| {
            limits
                .rapid_law(axis)
                .braking_distance(self.ramps.get(axis).speed)
        };
        self.position_after(PerAxis::new(
            braking_distance(Axis::X),
            braking_distance(Axis::Z),
        ))
    }

    /// Returns the rapid shifted by a vector, mm.
    pub fn shifted(self, by: Point) -> Self {
        Self {
            to: self.to + by,
            ..self
        }
    }
}
