//! A spindle that the outputs of the board drive, with one pulse a turn at one of its
//! inputs.

use core::f64::consts::PI;

use super::{KlipperTwin, Object, pins};

/// Part of a turn in which the index signal is high.
const INDEX: f64 = 0.1;
/// Full pulse width.
const FULL: f64 = 255.0;

/// Where the spindle is wired, and how it is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleMake<'a> {
    /// Input of the one-turn signal.
    pub index: &'a str,
    /// Outputs that let it turn.
    pub forward: &'a str,
    /// See `forward`.
    pub reverse: &'a str,
    /// Output whose pulse width is the speed; empty: it has one speed.
    pub speed: &'a str,
    /// Turns a minute at full width.
    pub top: f64,
    /// Time constant of its speed, s.
    pub inertia: f64,
}

/// A spindle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spindle {
    index: u32,
    /// Forward, reverse, speed; none: it turns by itself.
    outputs: Option<[Option<u32>; 3]>,
    top: f64,
    inertia: f64,
    /// From here on the speed goes to its target: ns, turns, turns a second.
    since: u64,
    turns: f64,
    speed: f64,
    target: f64,
    /// Part of the speed, turns a second of it, and since when, ns.
    ripple: (f64, f64, u64),
    lost: bool,
    spark: bool,
}

fn seconds(from: u64, to: u64) -> f64 {
    to as f64 * 1e-9 - from as f64 * 1e-9
}

impl Spindle {
    const fn new(index: u32, now: u64) -> Self {
        Self {
            index,
            outputs: None,
            top: 0.0,
            inertia: 0.0,
            since: now,
            turns: 0.0,
            speed: 0.0,
            target: 0.0,
            ripple: (0.0, 1.0, now),
            lost: false,
            spark: false,
        }
    }

    /// Speed without ripple, turns a second.
    fn speed(&self, now: u64) -> f64 {
        let passed = seconds(self.since, now);
        if self.inertia <= 0.0 {
            return self.target;
        }
        self.target + (self.speed - self.target) * (-passed / self.inertia).exp()
    }

    fn even_turns(&self, now: u64) -> f64 {
        let passed = seconds(self.since, now);
        let missing = if self.inertia > 0.0 {
            (self.speed - self.target) * self.inertia * (1.0 - (-passed / self.inertia).exp())
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
        self.even_turns(now) + ahead
    }

    fn aim(&mut self, target: f64, now: u64) {
        (self.turns, self.speed) = (self.even_turns(now), self.speed(now));
        (self.since, self.target) = (now, target);
    }

    /// Level of the index signal, if it is at this pin.
    pub(super) fn level(&self, pin: u32, now: u64) -> Option<bool> {
        let high = || self.spark || (!self.lost && self.turns(now).rem_euclid(1.0) < INDEX);
        (pin == self.index).then(high)
    }
}

impl KlipperTwin {
    /// A spindle that turns by itself, with its index at this pin.
    pub fn turn_spindle(&mut self, name: &str, rpm: f64) {
        self.spindle = pins::number(name).map(|pin| {
            let mut spindle = Spindle::new(pin, self.now);
            spindle.target = rpm / 60.0;
            spindle.speed = spindle.target;
            spindle
        });
    }

    /// A spindle that the board's outputs drive.
    pub fn fit_spindle(&mut self, make: SpindleMake<'_>) {
        let pin = |name: &str| pins::number(name);
        self.spindle = pin(make.index).map(|index| Spindle {
            outputs: Some([pin(make.forward), pin(make.reverse), pin(make.speed)]),
            top: make.top / 60.0,
            inertia: make.inertia,
            ..Spindle::new(index, self.now)
        });
    }

    /// The speed of the spindle goes up and down by so many per cent, so often a
    /// second.
    pub fn set_ripple(&mut self, percent: f64, frequency: f64) {
        let now = self.now;
        if let Some(spindle) = &mut self.spindle {
            let target = spindle.target;
            let turns = spindle.turns(now);
            spindle.aim(target, now);
            spindle.turns = turns;
            spindle.ripple = (percent / 100.0, frequency.max(1e-3), now);
        }
    }

    /// The index signal stays away, or comes again.
    pub const fn lose_index(&mut self, lost: bool) {
        if let Some(spindle) = &mut self.spindle {
            spindle.lost = lost;
        }
    }

    /// The index signal is high whatever the spindle does: a disturbance.
    pub const fn spark(&mut self, on: bool) {
        if let Some(spindle) = &mut self.spindle {
            spindle.spark = on;
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
        let Some(outputs) = spindle.outputs else {
            return;
        };
        let [forward, reverse, speed] = outputs.map(|pin| pin.map(|pin| self.driven(pin)));
        let part = speed.map_or(1.0, |width| f64::from(width) / FULL);
        let way = match (forward.unwrap_or(0) != 0, reverse.unwrap_or(0) != 0) {
            (true, false) => 1.0,
            (false, true) => -1.0,
            _ => 0.0,
        };
        let target = way * part * spindle.top;
        if let Some(spindle) = &mut self.spindle
            && spindle.target != target
        {
            spindle.aim(target, now);
        }
    }

    /// What an output pin gives; one that is not set up gives nothing.
    fn driven(&self, wanted: u32) -> u32 {
        let given = self.oids.values().find_map(|object| match object {
            Object::Output(output, value) if output.pin == wanted => Some(*value),
            _ => None,
        });
        given.unwrap_or(0)
    }
}
