//! One slide: drive, screw, switches, zero signal.
//!
//! ```text
//!  pulses ─► servo ─► motor ─► screw with its play ─► slide
//!            v = gain · lag    zero signal            dog, limit switches, ends
//! ```

use serde::{Deserialize, Serialize};

use super::config::{AxisConfig, ScrewError};
use super::io::OverLimit;
use crate::axis::{motor_reversed, pulse_weight};
use crate::memory::Parameters;
use crate::units::{Axis, Pulses, TICK_S, round_to_i64};

/// Part of a motor turn for which the zero signal stands.
const INDEX_PART: i64 = 50;

/// The position loop of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Servo {
    /// Seconds of way that the motor is behind at a steady speed.
    lag_s: f64,
    /// What is left of a deviation after a tick.
    tick_decay: f64,
    /// Following error that trips the drive, pulses.
    largest: f64,
}

/// A stretch of the motor's way, to the place before its end, on which the one-turn
/// signal does not change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct IndexStretch {
    from: i64,
    end: i64,
    /// The signal stands.
    on: bool,
}

impl IndexStretch {
    const fn holds(&self, place: i64) -> bool {
        self.from <= place && place < self.end
    }
}

/// A slide with its drive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct AxisDrive {
    /// Slide travel of one pulse, mm; negative with a reversed motor.
    pulse: f64,
    /// Where the command is, in pulses from the reference point towards plus.
    commanded: i64,
    /// How far the motor is behind it, pulses: the following error.
    behind: f64,
    /// Physical place of the slide, pulses; it lies between the motor's and that
    /// plus the play of the screw.
    slide: i64,
    play: i64,
    /// Last command count.
    last: i64,
    servo: Option<Servo>,
    /// The following error became too large, or a stepper met the end of its slide:
    /// the drive is off.
    tripped: bool,
    /// The slide does not move.
    pub blocked: bool,
    /// Pulses of one motor turn.
    turn: i64,
    limits: Option<(i64, i64)>,
    /// Where the slide can go no farther.
    ends: (i64, i64),
    /// A real slide follows the pulses, whose ends nobody knows.
    #[serde(default)]
    pub real: bool,
    dog: Option<(i64, i64)>,
    /// Places of motor and slide before the last tick.
    before: (i64, i64),
    /// It gives a one-turn signal.
    has_index: bool,
    /// Where the motor was on its turn when it was last looked for: it stays there for
    /// many ticks.
    #[serde(default)]
    index_stretch: IndexStretch,
    /// Errors of the screw, mm (X in radius): by how much the slide is beyond the place
    /// that the pulses say. Switches and ends are met by the pulses.
    #[serde(default)]
    screw: Vec<ScrewError>,
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
        // All places in pulses, so that a tick compares whole numbers.
        let place = |mm: f64| (mm * scale / weight).round() as i64;
        let ends = config.slide_ends(axis);
        let servo = config.servo.as_ref().map(|servo| {
            let gain = servo.gain.clamp(1.0, 1000.0);
            Servo {
                lag_s: 1.0 / gain,
                tick_decay: libm::exp(-gain * TICK_S),
                largest: (servo.largest_error.abs() * scale / weight).max(1.0),
            }
        });
        Self {
            pulse: if motor_reversed(axis, parameters) != config.reversed {
                -weight
            } else {
                weight
            },
            commanded: place(config.start),
            behind: 0.0,
            slide: place(config.start),
            play: place(config.backlash).max(0),
            last: 0,
            servo,
            tripped: false,
            blocked: false,
            turn: place(config.motor_turn).max(1),
            limits: config
                .limits
                .map(|limits| (place(limits.minus), place(limits.plus))),
            ends: (place(ends.minus), place(ends.plus)),
            real: false,
            dog: config.dog.map(|dog| (place(dog.from), place(dog.to))),
            before: (place(config.start), place(config.start)),
            has_index: config.one_turn_signal,
            index_stretch: IndexStretch::default(),
            screw: config
                .pitch_errors
                .iter()
                .map(|point| ScrewError {
                    at: point.at * scale,
                    error: point.error * scale,
                })
                .collect(),
        }
    }

    /// By how much the slide is beyond a place that the pulses say, mm.
    fn screw_error(&self, place: f64) -> f64 {
        if self.real {
            return 0.0;
        }
        let after = self.screw.partition_point(|point| point.at <= place);
        match (
            after.checked_sub(1).and_then(|it| self.screw.get(it)),
            self.screw.get(after),
        ) {
            (Some(one), Some(next)) => {
                let share = (place - one.at) / (next.at - one.at);
                one.error + share * (next.error - one.error)
            }
            (Some(only), None) | (None, Some(only)) => only.error,
            (None, None) => 0.0,
        }
    }

    /// The motor's turns towards positive coordinates.
    const fn towards_plus(&self, pulses: i64) -> i64 {
        if self.pulse < 0.0 { -pulses } else { pulses }
    }

    /// Where the motor stands.
    fn motor(&self) -> i64 {
        if self.behind == 0.0 {
            return self.commanded;
        }
        self.commanded - round_to_i64(self.behind)
    }

    /// Follows the command count for a tick. A drive that is not enabled, or has
    /// tripped, lets the pulses go by.
    pub fn follow(&mut self, command: Pulses, enabled: bool) {
        let way = self.towards_plus(command.0 - self.last);
        self.last = command.0;
        let before = self.motor();
        self.before = (before, self.slide);
        if !enabled || self.tripped {
            self.tripped &= enabled;
            self.commanded = before;
            self.behind = 0.0;
            return;
        }
        if way == 0 && self.behind == 0.0 {
            return;
        }
        match self.servo {
            // A stepper that is blocked loses its steps.
            None if self.blocked => {}
            None => self.commanded += way,
            Some(servo) => {
                self.commanded += way;
                self.fall_behind(&servo, way);
            }
        }
        let motor = self.meet_ends();
        self.slide = motor.max(self.slide.min(motor + self.play));
        if self.has_index && !self.index_stretch.holds(motor) {
            self.index_stretch = self.stretch_around(motor);
        }
    }

    /// A servo after a tick in which its command went this way.
    fn fall_behind(&mut self, servo: &Servo, way: i64) {
        let settled = way as f64 / TICK_S * servo.lag_s;
        self.behind = if self.blocked {
            self.behind + way as f64
        } else {
            settled + (self.behind - settled) * servo.tick_decay
        };
        if way == 0 && self.behind.abs() < 1e-3 {
            self.behind = 0.0;
        }
        self.tripped = self.behind.abs() > servo.largest;
    }

    /// A motor that would push the slide past its end stands: a servo falls behind
    /// its command until that trips it, a stepper's drive switches off at once. Where it
    /// stands then.
    fn meet_ends(&mut self) -> i64 {
        let ((minus, plus), before) = (self.ends, self.before.0);
        let motor = self.motor();
        // A slide that was put beyond its end goes no farther, and comes back.
        let stands = motor
            .max((minus - self.play).min(before))
            .min(plus.max(before));
        if stands == motor || self.real {
            return motor;
        }
        match &self.servo {
            Some(servo) => {
                self.behind = (self.commanded - stands) as f64;
                self.tripped = self.behind.abs() > servo.largest;
            }
            None => {
                self.commanded = stands;
                self.tripped = true;
            }
        }
        stands
    }

    /// Takes a count for the place where the slide stands, without moving.
    pub fn stand_at(&mut self, command: Pulses) {
        self.last = command.0;
        self.before = (self.motor(), self.slide);
    }

    /// Puts the slide elsewhere, mm from the reference point (X in radius).
    pub fn put(&mut self, place: f64) {
        // What the screw must say for it: its errors change little from place to place.
        let mut said = place;
        for _ in 0..4 {
            said = place - self.screw_error(said);
        }
        self.commanded = (said / self.pulse.abs()).round() as i64;
        self.behind = 0.0;
        self.slide = self.commanded;
        self.before = (self.commanded, self.slide);
    }

    /// Where the slide stands, mm from the reference point (X in radius).
    pub fn place(&self) -> f64 {
        let said = self.slide as f64 * self.pulse.abs();
        said + self.screw_error(said)
    }

    /// How far the motor is behind the command, mm (X in radius).
    pub fn following_error(&self) -> f64 {
        self.behind * self.pulse.abs()
    }

    /// The following error has become too large.
    pub const fn tripped(&self) -> bool {
        self.tripped
    }

    /// The limit switch that is tripped.
    pub fn over_limit(&self) -> Option<OverLimit> {
        let (minus, plus) = self.limits?;
        if self.slide < minus {
            return Some(OverLimit::Minus);
        }
        (self.slide > plus).then_some(OverLimit::Plus)
    }

    /// Whether the deceleration switch is pressed.
    pub(crate) fn on_dog(&self) -> bool {
        self.dog
            .is_some_and(|(from, to)| (from..=to).contains(&self.slide))
    }

    /// Pulses of a turn on which the one-turn signal stands: it begins at zero.
    const fn index_width(&self) -> i64 {
        (self.turn + INDEX_PART - 1) / INDEX_PART
    }

    /// The one-turn signal, whose rising edge is at zero going positive, and the command
    /// count at which it changed in the last tick.
    #[inline]
    pub fn index(&self) -> (bool, Option<Pulses>) {
        if !self.has_index {
            return (false, None);
        }
        let (from, to) = (self.before.0, self.motor());
        let stretch = &self.index_stretch;
        if stretch.holds(from) && stretch.holds(to) {
            return (stretch.on, None);
        }
        let change = self.index_change((from, to));
        (self.stretch_around(to).on, change)
    }

    /// The stretch between two changes of the one-turn signal around a place.
    #[cold]
    const fn stretch_around(&self, place: i64) -> IndexStretch {
        let (on_turn, width) = (place.rem_euclid(self.turn), self.index_width());
        let on = on_turn < width;
        let (first, next) = if on { (0, width) } else { (width, self.turn) };
        IndexStretch {
            from: place - on_turn + first,
            end: place - on_turn + next,
            on,
        }
    }

    /// The command count at the first change of the one-turn signal on a way.
    #[cold]
    fn index_change(&self, way: (i64, i64)) -> Option<Pulses> {
        let starts = [0, self.index_width()];
        self.first_change(way, |place| {
            let on_turn = |start: &i64| place - (place - start).rem_euclid(self.turn);
            starts.iter().map(on_turn).max()
        })
    }

    /// The command count at which the switch changed in the last tick.
    pub(crate) fn dog_latch(&self) -> Option<Pulses> {
        let (from, to) = self.dog?;
        let way = (self.before.1, self.slide);
        self.first_change(way, |place| {
            [from, to + 1].into_iter().filter(|at| *at <= place).max()
        })
    }

    /// The command count at the first change of a signal in the last tick, on the
    /// way of motor or slide. `below(place)`: the last boundary at or before a place;
    /// a boundary is the first place of its stretch.
    fn first_change(
        &self,
        (from, to): (i64, i64),
        below: impl Fn(i64) -> Option<i64>,
    ) -> Option<Pulses> {
        if to == from {
            return None;
        }
        let place = if to > from {
            // The first boundary ahead of where it was.
            let mut first = below(to).filter(|at| *at > from)?;
            while let Some(earlier) = below(first - 1).filter(|at| *at > from) {
                first = earlier;
            }
            first
        } else {
            // Going back, the place before a boundary is the first beyond it.
            below(from).filter(|at| *at > to)? - 1
        };
        // Counted from the end: at a steady speed a servo goes as fast as its command.
        Some(Pulses(self.last - self.towards_plus(to - place)))
    }
}
