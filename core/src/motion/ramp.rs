//! Speed along one line of travel: two speed laws, each integrated in closed form.

use core::f64::consts::LOG2_E;

use serde::{Deserialize, Serialize};

use crate::units::{TICK_S, max_not_nan, min_not_nan};

/// Greatest distance to go that counts as zero, mm.
const MIN_DISTANCE_MM: f64 = 1e-12;

/// Law by which the speed of a motion changes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum SpeedLaw {
    /// The speed changes with this constant acceleration, mm/s².
    Linear { acceleration: f64 },
    /// The speed approaches its target by an exponential function.
    Exponential {
        /// Time constant of the exponential function, s.
        time: f64,
        /// Speed at which motion starts and ends, mm/s.
        lowest: f64,
        /// Fraction of a speed difference that remains after a tick: e^(-tick / time).
        tick_decay: f64,
    },
}

impl SpeedLaw {
    /// Creates a law of constant acceleration that reaches `rate` (mm/s) in `time` seconds.
    pub fn linear(rate: f64, time: f64) -> Self {
        Self::Linear {
            acceleration: (rate / time.max(TICK_S)).max(1e-3),
        }
    }

    /// The constant acceleration, mm/s²; infinite for the exponential law.
    pub(super) const fn acceleration(&self) -> f64 {
        match *self {
            Self::Linear { acceleration } => acceleration,
            Self::Exponential { .. } => f64::INFINITY,
        }
    }

    /// Creates an exponential law with a time constant (s) and a lowest speed (mm/s). With
    /// a time constant of zero the speed changes in steps.
    pub(crate) fn exponential(time: f64, lowest: f64) -> Self {
        let tick_decay = if time > 0.0 {
            libm::exp(-TICK_S / time)
        } else {
            0.0
        };
        Self::Exponential {
            time,
            lowest,
            tick_decay,
        }
    }

    /// Time constant of the exponential law, s; 0 for the linear law.
    pub(crate) const fn time_constant(&self) -> f64 {
        match *self {
            Self::Exponential { time, .. } => time,
            Self::Linear { .. } => 0.0,
        }
    }

    /// Fraction of a speed difference that remains after `span` seconds: e^(-span / time
    /// constant); 0 for the linear law.
    pub(crate) fn decay(&self, span: f64) -> f64 {
        match *self {
            Self::Exponential {
                time, tick_decay, ..
            } => decay(span, time, tick_decay),
            Self::Linear { .. } => 0.0,
        }
    }

    /// Highest speed on a distance of `length` mm from rest to rest, mm/s; infinite for the
    /// exponential law.
    pub fn peak_speed(&self, length: f64) -> f64 {
        match *self {
            Self::Linear { acceleration } => (acceleration * length).sqrt(),
            Self::Exponential { .. } => f64::INFINITY,
        }
    }

    /// Returns the distance in which a motion at `speed` (mm/s) stops, mm.
    pub(crate) fn braking_distance(&self, speed: f64) -> f64 {
        match *self {
            Self::Linear { acceleration } => speed * speed / (2.0 * acceleration),
            Self::Exponential { time, lowest, .. } => time * (speed - lowest).max(0.0),
        }
    }

    /// Duration of a move of `length` mm from rest to rest at the target speed `rate`
    /// (mm/s), s.
    pub fn duration(&self, length: f64, rate: f64) -> f64 {
        if length <= MIN_DISTANCE_MM {
            return 0.0;
        }
        if rate <= 0.0 {
            return f64::INFINITY;
        }
        match *self {
            Self::Linear { acceleration } => {
                if length * acceleration >= rate * rate {
                    length / rate + rate / acceleration
                } else {
                    2.0 * (length / acceleration).sqrt()
                }
            }
            Self::Exponential { time, lowest, .. } => {
                let until_braking = length / rate;
                if time <= 0.0 || lowest >= rate {
                    return until_braking;
                }
                // As a power of two, because its chain of roundings is half as long and
                // each block of a program waits for it.
                let left = libm::exp2(until_braking * (-LOG2_E / time));
                let peak = rate - (rate - lowest) * left;
                until_braking + time * libm::log(peak / lowest)
            }
        }
    }
}

/// The result of advancing a ramp by a time: distance and speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RampStep {
    /// Distance that the step covers, mm.
    pub distance: f64,
    /// Time used, s; less than the given time only if the end was reached.
    pub used_s: f64,
}

impl RampStep {
    const NONE: Self = Self {
        distance: 0.0,
        used_s: 0.0,
    };
}

/// Speed and distance to go along one line; the distance is infinite for a jog.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Ramp {
    /// Current speed, mm/s, never negative.
    pub speed: f64,
    /// Distance to the end, mm; exactly zero at the end.
    pub remaining: f64,
}

impl Ramp {
    /// Creates a ramp at rest, with a distance of `length` mm to go.
    pub const fn new(length: f64) -> Self {
        Self {
            speed: 0.0,
            remaining: length,
        }
    }

    /// Whether the ramp has covered its whole distance.
    pub fn is_finished(&self) -> bool {
        self.remaining <= 0.0
    }

    /// Advances by `dt` seconds towards the speed `target` (mm/s), braking in time for the
    /// end.
    pub fn advance(&mut self, law: &SpeedLaw, target: f64, dt: f64) -> RampStep {
        let target = if target > 0.0 { target } else { 0.0 };
        let mut step = RampStep::NONE;
        if self.is_running(dt) {
            step = self.advance_phase(law, target, dt);
            if self.is_running(dt - step.used_s) {
                step = self.advance_further_phases(law, target, dt, step);
            }
        }
        if self.remaining <= MIN_DISTANCE_MM {
            step.distance += self.remaining;
            *self = Self::new(0.0);
        } else {
            step.used_s = dt;
        }
        step
    }

    /// Whether distance to go and `time` (s) are left.
    fn is_running(&self, time: f64) -> bool {
        !self.is_finished() && time > 1e-15
    }

    /// Advances the rest of a tick after its first phase and returns the sum of all phases. A tick
    /// seldom has more than one phase.
    #[cold]
    fn advance_further_phases(
        &mut self,
        law: &SpeedLaw,
        target: f64,
        dt: f64,
        first: RampStep,
    ) -> RampStep {
        let mut step = first;
        for _ in 1..8 {
            let time = dt - step.used_s;
            if !self.is_running(time) {
                break;
            }
            let phase = self.advance_phase(law, target, time);
            step.distance += phase.distance;
            step.used_s += phase.used_s;
        }
        step
    }

    /// Advances one phase, in which the speed rises, falls or stays constant, for `time` seconds at
    /// most.
    fn advance_phase(&mut self, law: &SpeedLaw, target: f64, time: f64) -> RampStep {
        match *law {
            SpeedLaw::Linear { acceleration } => self.linear_phase(acceleration, target, time),
            SpeedLaw::Exponential {
                time: constant,
                lowest,
                tick_decay,
            } => self.exponential_phase(constant, lowest, tick_decay, target, time),
        }
    }

    /// Reduces the distance to go by `moved`, mm, and sets the speed to `speed`, mm/s. Returns the
    /// step with its distance and the time `used`, s.
    fn move_by(&mut self, moved: f64, used: f64, speed: f64) -> RampStep {
        let moved = min_not_nan(moved, self.remaining);
        self.remaining -= moved;
        self.speed = speed;
        RampStep {
            distance: moved,
            used_s: used,
        }
    }

    /// Moves to the end, with the speed 0 there, and returns the step with the time `used`, s.
    fn move_to_end(&mut self, used: f64) -> RampStep {
        self.move_by(self.remaining, used, 0.0)
    }

    /// Moves at constant speed for `distance`, mm, but not beyond the end and not longer than
    /// `time` seconds.
    fn cruise(&mut self, distance: f64, time: f64) -> RampStep {
        let until = distance / self.speed;
        if until > time {
            return self.move_by(self.speed * time, time, self.speed);
        }
        if distance >= self.remaining {
            return self.move_to_end(until);
        }
        self.move_by(distance, until, self.speed)
    }

    fn linear_phase(&mut self, acceleration: f64, target: f64, time: f64) -> RampStep {
        let speed = self.speed;
        let braking = speed * speed / (2.0 * acceleration);
        if speed > 0.0 && self.remaining <= braking * (1.0 + 1e-9) {
            // On the braking curve: the acceleration that ends exactly at the end point.
            let until_end = 2.0 * self.remaining / speed;
            if until_end <= time {
                return self.move_to_end(until_end);
            }
            let end_speed = speed * (1.0 - time / until_end);
            return self.move_by((speed + end_speed) / 2.0 * time, time, end_speed);
        }
        if speed > target {
            let span = ((speed - target) / acceleration).min(time);
            let end_speed = if span < time {
                target
            } else {
                speed - acceleration * span
            };
            return self.move_by(
                (speed + end_speed) / 2.0 * span,
                span,
                end_speed.max(target),
            );
        }
        if speed < target {
            let peak = (acceleration * self.remaining + speed * speed / 2.0)
                .sqrt()
                .min(target);
            let whole = (peak - speed) / acceleration;
            let (span, end_speed) = if whole <= time {
                (whole, peak)
            } else {
                (time, speed + acceleration * time)
            };
            return self.move_by((speed + end_speed) / 2.0 * span, span, end_speed);
        }
        if speed <= 0.0 {
            return RampStep {
                distance: 0.0,
                used_s: time,
            };
        }
        self.cruise(self.remaining - braking, time)
    }

    fn exponential_phase(
        &mut self,
        constant: f64,
        lowest: f64,
        tick_decay: f64,
        target: f64,
        time: f64,
    ) -> RampStep {
        // Below the lowest speed, or without a time constant, the speed follows at once.
        self.speed = max_not_nan(self.speed, min_not_nan(lowest, target));
        if constant <= 0.0 || (self.speed <= lowest && target <= lowest) {
            self.speed = target;
            if target <= 0.0 {
                return RampStep {
                    distance: 0.0,
                    used_s: time,
                };
            }
            return self.cruise(self.remaining, time);
        }
        let speed = self.speed;
        let distance_to_braking = self.remaining - constant * (speed - lowest);
        if speed > lowest && distance_to_braking <= 1e-9 * constant * speed {
            return self.brake_exponentially(constant, lowest, tick_decay, time);
        }
        // Until the braking curve is met: the distance at `target` is `room`. Far from it
        // no division is needed.
        let mut span = if target > 0.0 && distance_to_braking < 2.0 * target * time {
            min_not_nan(distance_to_braking / target, time)
        } else {
            time
        };
        let mut final_speed = None;
        if target < lowest {
            let until_lowest = constant * libm::log((speed - target) / (lowest - target));
            if until_lowest <= span {
                span = until_lowest;
                final_speed = Some(target);
            }
        }
        let end_speed = target + (speed - target) * decay(span, constant, tick_decay);
        let moved = target * span + constant * (speed - end_speed);
        self.move_by(moved, span, final_speed.unwrap_or(end_speed))
    }

    /// Brakes so that the lowest speed is reached at the end point. The time constant
    /// follows from the distance to go, so that the end is met even if the parameter
    /// changes.
    fn brake_exponentially(
        &mut self,
        constant: f64,
        lowest: f64,
        tick_decay: f64,
        time: f64,
    ) -> RampStep {
        let speed = self.speed;
        let time_constant = self.remaining / (speed - lowest);
        let factor = if (time_constant - constant).abs() <= 1e-6 * constant {
            decay(time, constant, tick_decay)
        } else {
            libm::exp(-time / time_constant)
        };
        let end_speed = speed * factor;
        if end_speed > lowest {
            let left = time_constant * (end_speed - lowest);
            return self.move_by(self.remaining - left, time, end_speed);
        }
        self.move_to_end((time_constant * libm::log(speed / lowest)).min(time))
    }
}

/// e^(-span / constant), where `tick_decay` is the known value for a span of one tick.
fn decay(span: f64, constant: f64, tick_decay: f64) -> f64 {
    if span == TICK_S {
        tick_decay
    } else {
        libm::exp(-span / constant)
    }
}
