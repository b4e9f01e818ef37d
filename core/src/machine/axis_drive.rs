//! One simulated slide: drive, screw, switches, zero signal.
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

/// Fraction of a motor revolution in which the zero signal is on: one in this number.
const INDEX_PART: i64 = 50;

/// The position loop of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Servo {
    /// Lag of the motor at a steady speed, s.
    lag_s: f64,
    /// Fraction of a deviation that remains after a tick.
    tick_decay: f64,
    /// Following error that trips the drive, pulses.
    #[serde(rename = "largest")]
    largest: f64,
}

/// A range of motor positions, `from` to before `end`, within which the one-turn signal
/// does not change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct IndexStretch {
    from: i64,
    end: i64,
    /// Level of the signal in the range.
    on: bool,
}

impl IndexStretch {
    const fn holds(&self, place: i64) -> bool {
        self.from <= place && place < self.end
    }
}

/// A simulated slide with its drive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct AxisDrive {
    /// Slide travel of one pulse, mm; negative with a reversed motor.
    #[serde(rename = "pulse")]
    pulse: f64,
    /// Commanded position, pulses from the reference point towards plus.
    commanded: i64,
    /// Following error: distance from the motor to the command, pulses.
    #[serde(rename = "behind")]
    behind: f64,
    /// Physical position of the slide, pulses. It is between the motor's position and that
    /// plus the play of the screw.
    slide: i64,
    #[serde(rename = "play")]
    play: i64,
    /// Command count at the last tick.
    #[serde(rename = "last")]
    last: i64,
    servo: Option<Servo>,
    /// Set when the following error became too large, or a stepper met the end of its
    /// slide. The drive is then off.
    tripped: bool,
    /// Whether the slide is jammed (fault).
    pub blocked: bool,
    /// Pulses per motor revolution.
    #[serde(rename = "turn")]
    turn: i64,
    limits: Option<(i64, i64)>,
    /// Mechanical ends of the slide, pulses.
    ends: (i64, i64),
    /// Whether a real slide follows the pulses. Its ends are unknown.
    #[serde(default)]
    pub real: bool,
    dog: Option<(i64, i64)>,
    /// Positions of motor and slide before the last tick.
    #[serde(rename = "before")]
    before: (i64, i64),
    /// Whether the drive has a one-turn signal.
    has_index: bool,
    /// The range around the motor's position, kept because the motor stays in it for many
    /// ticks.
    #[serde(default)]
    index_stretch: IndexStretch,
    /// Errors of the screw, mm (X in radius): distance of the slide beyond the position of
    /// the pulses. Switches and ends are compared with the pulses.
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
        // All positions in pulses, so that a tick compares integers.
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

    /// Distance of the slide beyond the position of the pulses, mm.
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

    /// Converts drive pulses to pulses towards positive coordinates.
    const fn towards_plus(&self, pulses: i64) -> i64 {
        if self.pulse < 0.0 { -pulses } else { pulses }
    }

    /// Position of the motor, pulses.
    fn motor(&self) -> i64 {
        if self.behind == 0.0 {
            return self.commanded;
        }
        self.commanded - round_to_i64(self.behind)
    }

    /// Follows the command count for one tick. A drive that is not enabled, or has tripped,
    /// ignores the pulses.
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
            // A blocked stepper loses its steps.
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

    /// Updates the following error of a servo whose command moved by `way` pulses in the
    /// tick.
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

    /// Stops a motor that would push the slide past its end. The following error of a servo
    /// grows until it trips; a stepper's drive switches off at once. Returns the motor's
    /// position.
    fn meet_ends(&mut self) -> i64 {
        let ((minus, plus), before) = (self.ends, self.before.0);
        let motor = self.motor();
        // A slide placed beyond its end can move back, but no farther.
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

    /// Takes a count for the present position, without motion.
    pub fn stand_at(&mut self, command: Pulses) {
        self.last = command.0;
        self.before = (self.motor(), self.slide);
    }

    /// Moves the slide to another position, mm from the reference point (X in radius).
    pub fn put(&mut self, place: f64) {
        // The screw position for it, by iteration: the screw errors change slowly.
        let mut said = place;
        for _ in 0..4 {
            said = place - self.screw_error(said);
        }
        self.commanded = (said / self.pulse.abs()).round() as i64;
        self.behind = 0.0;
        self.slide = self.commanded;
        self.before = (self.commanded, self.slide);
    }

    /// Position of the slide, mm from the reference point (X in radius).
    pub fn place(&self) -> f64 {
        let said = self.slide as f64 * self.pulse.abs();
        said + self.screw_error(said)
    }

    /// Following error: distance from the motor to the command, mm (X in radius).
    pub fn following_error(&self) -> f64 {
        self.behind * self.pulse.abs()
    }

    /// Whether the drive has switched off because of a following error or an end of the
    /// slide.
    pub const fn tripped(&self) -> bool {
        self.tripped
    }

    /// The limit switch that the slide presses; `None` if none.
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

    /// Pulses per revolution in which the one-turn signal is on; they begin at zero.
    const fn index_width(&self) -> i64 {
        (self.turn + INDEX_PART - 1) / INDEX_PART
    }

    /// State of the one-turn signal, whose rising edge is at zero in the positive
    /// direction, and the command count at its change in the last tick.
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

    /// The range between two changes of the one-turn signal around a position.
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

    /// The command count at the first change of the one-turn signal on a travel.
    #[cold]
    fn index_change(&self, way: (i64, i64)) -> Option<Pulses> {
        let starts = [0, self.index_width()];
        self.first_change(way, |place| {
            let on_turn = |start: &i64| place - (place - start).rem_euclid(self.turn);
            starts.iter().map(on_turn).max()
        })
    }

    /// The command count at which the deceleration switch changed in the last tick.
    pub(crate) fn dog_latch(&self) -> Option<Pulses> {
        let (from, to) = self.dog?;
        let way = (self.before.1, self.slide);
        self.first_change(way, |place| {
            [from, to + 1].into_iter().filter(|at| *at <= place).max()
        })
    }

    /// The command count at the first change of a signal in the last tick, on the travel of
    /// motor or slide. `below(place)` is the last boundary at or before a position; a
    /// boundary is the first position of its range.
    fn first_change(
        &self,
        (from, to): (i64, i64),
        below: impl Fn(i64) -> Option<i64>,
    ) -> Option<Pulses> {
        if to == from {
            return None;
        }
        let place = if to > from {
            // The first boundary after the start.
            let mut first = below(to).filter(|at| *at > from)?;
            while let Some(earlier) = below(first - 1).filter(|at| *at > from) {
                first = earlier;
            }
            first
        } else {
            // In the negative direction the position before a boundary is the first beyond
            // it.
            below(from).filter(|at| *at > to)? - 1
        };
        // Counted from the end: at a steady speed a servo moves as fast as its command.
        Some(Pulses(self.last - self.towards_plus(to - place)))
    }
}
