//! One slide: drive, switches, zero signal.

use serde::{Deserialize, Serialize};

use super::config::AxisConfig;
use crate::axis::{motor_reversed, pulse_weight};
use crate::memory::Parameters;
use crate::units::{Axis, Pulses};

/// Part of a motor turn for which the zero signal stands.
const INDEX_PART: i64 = 50;

/// A slide; it follows the command pulses exactly.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct AxisDrive {
    /// Slide travel of one pulse, mm; negative with a reversed motor.
    pulse: f64,
    /// Physical place in pulses from the reference point, as the motor counts.
    place: i64,
    /// Last command count.
    last: i64,
    /// Pulses of one motor turn.
    turn: i64,
    limits: Option<(i64, i64)>,
    dog: Option<(i64, i64)>,
    /// Place and count before the last tick.
    before: (i64, i64),
}

impl AxisDrive {
    pub fn new(axis: Axis, config: &AxisConfig, parameters: &Parameters) -> Self {
        let scale = match axis {
            Axis::X => 0.5,
            Axis::Z => 1.0,
        };
        let weight = match config.pulse {
            Some(pulse) if pulse.is_finite() && pulse != 0.0 => pulse.abs(),
            _ => pulse_weight(axis, parameters),
        };
        // All switches in pulses, so that a tick compares whole numbers.
        let place = |mm: f64| (mm * scale / weight).round() as i64;
        Self {
            pulse: if motor_reversed(axis, parameters) {
                -weight
            } else {
                weight
            },
            place: place(config.start),
            last: 0,
            turn: place(config.motor_turn).max(1),
            limits: config
                .limits
                .map(|limits| (place(limits.minus), place(limits.plus))),
            dog: config.dog.map(|dog| (place(dog.from), place(dog.to))),
            before: (place(config.start), 0),
        }
    }

    /// The motor's turns towards positive coordinates.
    const fn towards_plus(&self, pulses: i64) -> i64 {
        if self.pulse < 0.0 { -pulses } else { pulses }
    }

    /// Follows the command count.
    pub const fn follow(&mut self, command: Pulses) {
        self.before = (self.place, self.last);
        self.place += self.towards_plus(command.0 - self.last);
        self.last = command.0;
    }

    /// Takes a count for the place where the slide stands, without moving.
    pub const fn stand_at(&mut self, command: Pulses) {
        self.last = command.0;
        self.before = (self.place, self.last);
    }

    /// Puts the slide elsewhere, mm from the reference point (X in radius).
    pub fn put(&mut self, place: f64) {
        self.place = (place / self.pulse.abs()).round() as i64;
        self.before = (self.place, self.last);
    }

    /// Where the slide stands, mm from the reference point (X in radius).
    pub fn place(&self) -> f64 {
        self.place as f64 * self.pulse.abs()
    }

    /// Whether a limit switch is tripped.
    pub fn over_limit(&self) -> bool {
        self.limits
            .is_some_and(|(minus, plus)| self.place < minus || self.place > plus)
    }

    /// Whether the deceleration switch is pressed.
    pub fn on_dog(&self) -> bool {
        self.dog
            .is_some_and(|(from, to)| (from..=to).contains(&self.place))
    }

    /// The one-turn signal: its rising edge is at zero going positive.
    pub const fn index(&self) -> bool {
        self.place.rem_euclid(self.turn) * INDEX_PART < self.turn
    }

    /// The command count at which the one-turn signal changed in the last tick.
    pub fn index_latch(&self) -> Option<Pulses> {
        // The signal stands on the first `width` pulses of a turn.
        let width = (self.turn + INDEX_PART - 1) / INDEX_PART;
        let starts = [0, width];
        self.first_change(|place| {
            let on_turn = |start: &i64| place - (place - start).rem_euclid(self.turn);
            starts.iter().map(on_turn).max()
        })
    }

    /// The command count at which the switch changed in the last tick.
    pub fn dog_latch(&self) -> Option<Pulses> {
        let (from, to) = self.dog?;
        self.first_change(|place| [from, to + 1].into_iter().filter(|at| *at <= place).max())
    }

    /// The command count at the first change of a signal in the last tick.
    /// `below(place)`: the last boundary at or before a place; a boundary is the
    /// first place of its stretch.
    fn first_change(&self, below: impl Fn(i64) -> Option<i64>) -> Option<Pulses> {
        let (from, count) = self.before;
        if self.place == from {
            return None;
        }
        let place = if self.place > from {
            // The first boundary ahead of where it was.
            let mut first = below(self.place).filter(|at| *at > from)?;
            while let Some(earlier) = below(first - 1).filter(|at| *at > from) {
                first = earlier;
            }
            first
        } else {
            // Going back, the place before a boundary is the first beyond it.
            below(from).filter(|at| *at > self.place)? - 1
        };
        Some(Pulses(count + self.towards_plus(place - from)))
    }
}
