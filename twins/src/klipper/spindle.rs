//! A spindle driven by the outputs of the board, with an index signal at one of its inputs.

use core::f64::consts::PI;

use super::{ConfigObject, KlipperTwin, pins};

/// Fraction of a turn in which the index signal is high.
const INDEX_PULSE_TURNS: f64 = 0.1;
/// PWM value at which the spindle turns at full speed.
const MAX_PWM: f64 = 255.0;

/// The pins and the speed behaviour of a spindle on a Klipper board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleWiring<'a> {
    /// Name of the input pin of the index signal, one pulse per turn.
    pub index_pin: &'a str,
    /// Name of the output pin that turns the spindle forward.
    pub forward_pin: &'a str,
    /// Name of the output pin that turns the spindle in reverse.
    pub reverse_pin: &'a str,
    /// Name of the PWM output pin of the speed; empty for a spindle with one speed.
    pub speed_pin: &'a str,
    /// Spindle speed at full PWM value, r/min.
    pub full_speed_rpm: f64,
    /// Time constant with which the spindle changes its speed, s.
    pub time_constant_s: f64,
}

/// The speed and angle of a simulated spindle over time.
#[derive(Clone, Copy, Debug)]
pub(super) struct KlipperSpindle {
    index: u32,
    /// Numbers of the pins forward, reverse and speed; `None` for a spindle that always turns.
    output_pins: Option<[Option<u32>; 3]>,
    full_speed: f64,
    time_constant_s: f64,
    /// Time of the last speed change, ns. From this time on the speed, r/s, approaches its
    /// target.
    since_ns: u64,
    turns: f64,
    speed: f64,
    target: f64,
    /// Ripple of the speed: relative amplitude, frequency in Hz, and start time in ns.
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

    /// Returns the spindle speed without ripple at time `now` (ns), turns per second.
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

    /// Returns the number of spindle turns from the attachment of the spindle to time `now` (ns).
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

    /// Returns the level of the index signal at time `now` (ns); `None` if `pin` is another
    /// pin.
    pub(super) fn level(&self, pin: u32, now: u64) -> Option<bool> {
        let high = || {
            self.index_stuck_high
                || (!self.index_lost && self.turns(now).rem_euclid(1.0) < INDEX_PULSE_TURNS)
        };
        (pin == self.index).then(high)
    }
}

impl KlipperTwin {
    /// Attaches a spindle that always turns at `rpm`. Its index signal is at the pin `name`.
    pub fn run_spindle(&mut self, name: &str, rpm: f64) {
        self.spindle = pins::pin_number(name).map(|pin| {
            let mut spindle = KlipperSpindle::new(pin, self.now);
            spindle.target = rpm / 60.0;
            spindle.speed = spindle.target;
            spindle
        });
    }

    /// Attaches a simulated spindle to the outputs that switch and control it.
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

    /// Adds a periodic ripple to the spindle speed: amplitude in per cent, frequency in Hz.
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

    /// Suppresses the index signal (`true`), or restores it (`false`).
    pub const fn set_index_lost(&mut self, index_lost: bool) {
        if let Some(spindle) = &mut self.spindle {
            spindle.index_lost = index_lost;
        }
    }

    /// Holds the index signal high, like a disturbance, or ends that with `on` false.
    pub const fn set_index_stuck_high(&mut self, on: bool) {
        if let Some(spindle) = &mut self.spindle {
            spindle.index_stuck_high = on;
        }
    }

    /// Returns the number of spindle turns at time `at`, ns, negative in reverse.
    pub fn spindle_turns(&self, at: u64) -> f64 {
        self.spindle.map_or(0.0, |spindle| spindle.turns(at))
    }

    /// Returns the current spindle speed without ripple, r/min.
    pub fn spindle_rpm(&self) -> f64 {
        self.spindle
            .map_or(0.0, |spindle| spindle.speed(self.now) * 60.0)
    }

    /// Sets the target speed of the spindle from the board's outputs at time `now` (ns).
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

    /// Returns the value of the output pin `wanted`; 0 if it is not configured.
    fn output_value(&self, wanted: u32) -> u32 {
        let given = self.oids.values().find_map(|object| match object {
            ConfigObject::Output(output, value) if output.pin == wanted => Some(*value),
            _ => None,
        });
        given.unwrap_or(0)
    }
}
