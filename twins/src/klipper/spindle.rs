//! A spindle that the outputs of the board drive, with one pulse a turn at one of its
//! inputs.

use core::f64::consts::PI;

use super::{ConfigObject, KlipperTwin, pins};

/// Part of a turn in which the index signal is high.
const INDEX_PULSE_TURNS: f64 = 0.1;
/// Full pulse width.
const MAX_PWM: f64 = 255.0;

/// Where the spindle is wired, and how it is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleWiring<'a> {
    /// Input of the one-turn signal.
    pub index_pin: &'a str,
    /// Outputs that let it turn.
    pub forward_pin: &'a str,
    /// See `forward`.
    pub reverse_pin: &'a str,
    /// Output whose pulse width is the speed; empty: it has one speed.
    pub speed_pin: &'a str,
    /// Turns a minute at full width.
    pub full_speed_rpm: f64,
    /// Time constant of its speed, s.
    pub time_constant_s: f64,
}

/// A spindle.
#[derive(Clone, Copy, Debug)]
pub(super) struct KlipperSpindle {
    index: u32,
    /// Forward, reverse, speed; none: it turns by itself.
    output_pins: Option<[Option<u32>; 3]>,
    full_speed: f64,
    time_constant_s: f64,
    /// From here on the speed goes to its target: ns, turns, turns a second.
    since_ns: u64,
    turns: f64,
    speed: f64,
    target: f64,
    /// Part of the speed, turns a second of it, and since when, ns.
    ripple: (f64, f64, u64),
    index_lost: bool,
    index_stuck_high: bool,
}

fn seconds(from: u64, to: u64) -> f64 {
    to as f64 * 1e-9 - from as f64 * 1e-9
}

impl KlipperSpindle {
    const fn new(index: u32, now: u64) -> Self {
        Self {
            index,
            output_pins: None,
            full_speed: 0.0,
            time_constant_s: 0.0,
            since_ns: now,
            turns: 0.0,
            speed: 0.0,
            target: 0.0,
            ripple: (0.0, 1.0, now),
            index_lost: false,
            index_stuck_high: false,
        }
    }

    /// Speed without ripple, turns a second.
    fn speed(&self, now: u64) -> f64 {
        let passed = seconds(self.since_ns, now);
        if self.time_constant_s <= 0.0 {
            return self.target;
        }
        self.target + (self.speed - self.target) * (-passed / self.time_constant_s).exp()
    }

    fn turns_without_ripple(&self, now: u64) -> f64 {
        let passed = seconds(self.since_ns, now);
        let missing = if self.time_constant_s > 0.0 {
            (self.speed - self.target)
                * self.time_constant_s
                * (1.0 - (-passed / self.time_constant_s).exp())
        } else {
            0.0
        };
        self.turns + self.target * passed + missing
    }

    /// Turns since it was fitted.
    pub(super) fn turns(&self, now: u64) -> f64 {
        let (part, frequency, since) = self.ripple;
        let phase = 2.0 * PI * frequency * seconds(since, now);
        let ahead = self.speed(now) * part / (2.0 * PI * frequency) * (1.0 - phase.cos());
        self.turns_without_ripple(now) + ahead
    }

    fn set_target(&mut self, target: f64, now: u64) {
        (self.turns, self.speed) = (self.turns_without_ripple(now), self.speed(now));
        (self.since_ns, self.target) = (now, target);
    }

    /// Level of the index signal, if it is at this pin.
    pub(super) fn level(&self, pin: u32, now: u64) -> Option<bool> {
        let high = || {
            self.index_stuck_high
                || (!self.index_lost && self.turns(now).rem_euclid(1.0) < INDEX_PULSE_TURNS)
        };
        (pin == self.index).then(high)
    }
}

impl KlipperTwin {
    /// A spindle that turns by itself, with its index at this pin.
    pub fn run_spindle(&mut self, name: &str, rpm: f64) {
        self.spindle = pins::pin_number(name).map(|pin| {
            let mut spindle = KlipperSpindle::new(pin, self.now);
            spindle.target = rpm / 60.0;
            spindle.speed = spindle.target;
            spindle
        });
    }

    /// A spindle that the board's outputs drive.
    pub fn attach_spindle(&mut self, make: SpindleWiring<'_>) {
        let pin = |name: &str| pins::pin_number(name);
        self.spindle = pin(make.index_pin).map(|index| KlipperSpindle {
            output_pins: Some([
                pin(make.forward_pin),
                pin(make.reverse_pin),
                pin(make.speed_pin),
            ]),
            full_speed: make.full_speed_rpm / 60.0,
            time_constant_s: make.time_constant_s,
            ..KlipperSpindle::new(index, self.now)
        });
    }

    /// The speed of the spindle goes up and down by so many per cent, so often a
    /// second.
    pub fn set_speed_ripple(&mut self, percent: f64, frequency: f64) {
        let now = self.now;
        if let Some(spindle) = &mut self.spindle {
            let target = spindle.target;
            let turns = spindle.turns(now);
            spindle.set_target(target, now);
            spindle.turns = turns;
            spindle.ripple = (percent / 100.0, frequency.max(1e-3), now);
        }
    }

    /// The index signal stays away, or comes again.
    pub const fn set_index_lost(&mut self, index_lost: bool) {
        if let Some(spindle) = &mut self.spindle {
            spindle.index_lost = index_lost;
        }
    }

    /// The index signal is high whatever the spindle does: a disturbance.
    pub const fn set_index_stuck_high(&mut self, on: bool) {
        if let Some(spindle) = &mut self.spindle {
            spindle.index_stuck_high = on;
        }
    }

    /// Turns of the spindle at a moment, ns, since its outputs last changed; negative
    /// in reverse.
    pub fn spindle_turns(&self, at: u64) -> f64 {
        self.spindle.map_or(0.0, |spindle| spindle.turns(at))
    }

    /// Speed of the spindle without its ripple, turns a minute.
    pub fn spindle_rpm(&self) -> f64 {
        self.spindle
            .map_or(0.0, |spindle| spindle.speed(self.now) * 60.0)
    }

    /// The outputs drive the spindle.
    pub(super) fn drive_spindle(&mut self, now: u64) {
        let Some(spindle) = self.spindle else {
            return;
        };
        let Some(output_pins) = spindle.output_pins else {
            return;
        };
        let [forward, reverse, speed] =
            output_pins.map(|pin| pin.map(|pin| self.output_value(pin)));
        let part = speed.map_or(1.0, |width| f64::from(width) / MAX_PWM);
        let direction = match (forward.unwrap_or(0) != 0, reverse.unwrap_or(0) != 0) {
            (true, false) => 1.0,
            (false, true) => -1.0,
            _ => 0.0,
        };
        let target = direction * part * spindle.full_speed;
        if let Some(spindle) = &mut self.spindle
            && spindle.target != target
        {
            spindle.set_target(target, now);
        }
    }

    /// What an output pin gives; one that is not set up gives nothing.
    fn output_value(&self, wanted: u32) -> u32 {
        let given = self.oids.values().find_map(|object| match object {
            ConfigObject::Output(output, value) if output.pin == wanted => Some(*value),
            _ => None,
        });
        given.unwrap_or(0)
    }
}
