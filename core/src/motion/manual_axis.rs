//! Manual motion of one axis: jog, manual rapid, steps and handwheel (manual III-4, III-6),
//! and the approach of a reference return.

use serde::{Deserialize, Serialize};

use super::limits::MotionLimits;
use super::ramp::{Ramp, SpeedLaw};
use crate::units::Axis;

/// Rate of manual motion, which determines the speed law, too.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum JogRate {
    /// Jog feed, mm/min (X as a radius), with the exponential law of 029 and 041.
    Feed(f64),
    /// Manual rapid: the rapid rate of the axis after the rapid override, with the linear law of
    /// rapids.
    Rapid,
    /// A given rate, mm/min, with the linear law of rapids (reference return 113, 033).
    /// Overrides do not apply.
    Approach(f64),
}

impl JogRate {
    const fn is_linear(self) -> bool {
        !matches!(self, Self::Feed(_))
    }
}

/// The manual motion of one axis: jog, step or handwheel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ManualAxis {
    /// Requested jog: direction (true = positive) and rate; `None`: no jog.
    command: Option<(bool, JogRate)>,
    /// Target coordinate of a step or of the handwheel, mm, and rate; `None`: no step.
    goal: Option<(f64, JogRate)>,
    /// Speed, mm/s, never negative. `positive` is its direction; `linear` is `true` if it changes
    /// by the law of rapids.
    speed: f64,
    positive: bool,
    linear: bool,
}

impl ManualAxis {
    /// Requests a jog in a direction (true = positive) at a rate; `None` ends the jog.
    pub const fn request_jog(&mut self, command: Option<(bool, JogRate)>) {
        self.command = command;
    }

    /// Moves the target of a step or of the handwheel by `distance`, mm, counted from `position`,
    /// mm, if the axis has no target.
    pub fn step(&mut self, position: f64, distance: f64, rate: JogRate) {
        let base = self.goal.map_or(position, |(goal, _)| goal);
        self.goal = Some((base + distance, rate));
    }

    /// Sets the target of the axis to the coordinate `goal`, mm, to be reached at `rate`.
    pub const fn go_to(&mut self, goal: f64, rate: JogRate) {
        self.goal = Some((goal, rate));
    }

    /// Changes the rate of the motion to the target; without a target it does nothing.
    pub const fn set_rate(&mut self, rate: JogRate) {
        if let Some((_, goal_rate)) = &mut self.goal {
            *goal_rate = rate;
        }
    }

    /// Returns the target coordinate of the current step, mm; `None` without one.
    pub(crate) fn goal(&self) -> Option<f64> {
        self.goal.map(|(goal, _)| goal)
    }

    /// Returns the speed of the axis, mm/s, without its direction.
    pub const fn speed(&self) -> f64 {
        self.speed
    }

    /// Whether a step or handwheel motion is being executed.
    pub const fn is_stepping(&self) -> bool {
        self.goal.is_some()
    }

    /// Whether the axis is at standstill and no motion is requested.
    pub fn is_idle(&self) -> bool {
        self.speed <= 0.0 && self.command.is_none() && self.goal.is_none()
    }

    /// Whether the speed of the axis is above 0.
    pub fn is_moving(&self) -> bool {
        self.speed > 0.0
    }

    /// Ends jog and step, so that the axis decelerates.
    pub const fn release(&mut self) {
        self.command = None;
        self.goal = None;
    }

    const fn law<'a>(&self, axis: Axis, limits: &'a MotionLimits) -> &'a SpeedLaw {
        if self.linear {
            limits.rapid_law(axis)
        } else {
            limits.jog_law()
        }
    }

    /// Distance in which the axis stops if it brakes now, mm; negative towards minus.
    pub(crate) fn braking_distance(&self, axis: Axis, limits: &MotionLimits) -> f64 {
        let distance = self.law(axis, limits).braking_distance(self.speed);
        if self.positive { distance } else { -distance }
    }

    /// Shifts the target by `by`, mm, because the coordinates are shifted.
    pub(crate) fn translate(&mut self, by: f64) {
        if let Some((goal, _)) = &mut self.goal {
            *goal += by;
        }
    }

    /// Advances by `dt` seconds from `position`, mm, and returns the new position, mm. `rapid` is
    /// the rapid rate after its override, mm/s.
    pub fn advance(
        &mut self,
        axis: Axis,
        position: f64,
        limits: &MotionLimits,
        rapid: f64,
        dt: f64,
    ) -> f64 {
        let wanted = match self.goal {
            Some((goal, rate)) => Some((goal >= position, rate)),
            None => self.command,
        };
        let is_compatible = |(positive, rate): (bool, JogRate)| {
            positive == self.positive && rate.is_linear() == self.linear
        };
        let mut matches = wanted.is_some_and(is_compatible);
        // A change of direction or law begins at standstill.
        if let (false, Some((positive, rate))) = (matches, wanted)
            && self.speed <= 0.0
        {
            self.positive = positive;
            self.linear = rate.is_linear();
            matches = true;
        }
        let target = match wanted {
            Some((_, rate)) if matches => match rate {
                JogRate::Feed(rate) => (rate / 60.0).min(limits.rapid(axis)),
                JogRate::Rapid => rapid,
                JogRate::Approach(rate) => rate / 60.0,
            },
            _ => 0.0,
        };
        let rest = match self.goal {
            Some((goal, _)) if matches => (goal - position).abs(),
            _ => f64::INFINITY,
        };
        let mut ramp = Ramp {
            speed: self.speed,
            remaining: rest,
        };
        let step = ramp.advance(self.law(axis, limits), target, dt);
        self.speed = ramp.speed;
        if ramp.is_finished()
            && let Some((goal, _)) = self.goal.take()
        {
            return goal;
        }
        if self.positive {
            position + step.distance
        } else {
            position - step.distance
        }
    }
}
