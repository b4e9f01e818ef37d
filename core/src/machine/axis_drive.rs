//! One simulated slide: drive, screw, switches, zero signal.
//!
//! ```text
//!  pulses ─► servo ─► motor ─► screw with its play ─► slide
//!            v = gain · lag    zero signal            dog, limit switches, ends
//! ```

use serde::{Deserialize, Serialize};

use super::config::{AxisConfig, ScrewError};
use super::io::TrippedLimit;
use crate::axis::{is_motor_reversed, pulse_weight};
use crate::memory::ControlParameters;
use crate::units::{Axis, Pulses, TICK_S, round_to_i64};

/// The zero signal is on during this fraction of a motor revolution: 1 /
/// `INDEX_DIVISOR`.
const INDEX_DIVISOR: i64 = 50;

/// The position control loop of a servo drive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Servo {
    /// Following error at a steady speed, as the time by which the motor lags, s.
    lag_s: f64,
    /// Fraction of a deviation from the steady following error that remains after a tick.
    tick_decay: f64,
    /// Following error above which the drive switches off, pulses.
    #[serde(rename = "largest")]
    max_error_pulses: f64,
}

/// A range of motor positions in pulses, from `from` up to but not including `end`, in which the
/// one-turn signal is constant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct IndexRange {
    from: i64,
    end: i64,
    /// Level of the one-turn signal in the range.
    on: bool,
}

impl IndexRange {
    const fn contains(&self, position: i64) -> bool {
        self.from <= position && position < self.end
    }
}

/// A simulated slide with its drive and screw.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct AxisDrive {
    /// Slide travel of one pulse, mm; negative with a reversed motor.
    #[serde(rename = "pulse")]
    pulse_mm: f64,
    /// Commanded position, pulses from the reference point towards plus.
    commanded: i64,
    /// Following error: distance from the motor to the command, pulses.
    #[serde(rename = "behind")]
    following_error_pulses: f64,
    /// Physical position of the slide, pulses; from the motor's position up to that plus
    /// the play of the screw.
    slide: i64,
    #[serde(rename = "play")]
    play_pulses: i64,
    /// Command count at the last tick, drive pulses.
    #[serde(rename = "last")]
    last_command: i64,
    servo: Option<Servo>,
    /// Set when the following error is too large, or when a stepper meets the end of its
    /// slide. The drive is then off.
    tripped: bool,
    /// Whether the slide is jammed by a fault.
    pub blocked: bool,
    /// Number of pulses per motor revolution.
    #[serde(rename = "turn")]
    pulses_per_turn: i64,
    limits: Option<(i64, i64)>,
    /// Mechanical ends of the slide, negative and positive, pulses.
    ends: (i64, i64),
    /// Whether a real slide follows the pulses. Its ends are unknown.
    #[serde(default)]
    pub real: bool,
    dog: Option<(i64, i64)>,
    /// Positions of motor and slide at the start of the last tick, pulses.
    #[serde(rename = "before")]
    previous: (i64, i64),
    /// Whether the drive has a one-turn signal.
    has_index: bool,
    /// The range of the one-turn signal that contains the motor's position, kept because
    /// the motor stays in it for many ticks.
    #[serde(default)]
    index_stretch: IndexRange,
    /// Errors of the screw by position, mm (X in radius): distance of the slide beyond the
    /// position that the pulses give. Limit switches and ends are compared with the pulses.
    #[serde(default)]
    screw: Vec<ScrewError>,
}

impl AxisDrive {
    pub fn new(axis: Axis, config: &AxisConfig, parameters: &ControlParameters) -> Self {
        let scale = match axis {
            Axis::X => 0.5,
            Axis::Z => 1.0,
        };
        let weight = match config.pulse {
            Some(pulse) if pulse.is_finite() && pulse != 0.0 => pulse.abs(),
            _ => pulse_weight(axis, parameters),
        };
        // All positions in pulses, so that a tick compares integers.
        let to_pulses = |mm: f64| (mm * scale / weight).round() as i64;
        let ends = config.slide_ends(axis);
        let servo = config.servo.as_ref().map(|servo| {
            let gain = servo.gain.clamp(1.0, 1000.0);
            Servo {
                lag_s: 1.0 / gain,
                tick_decay: libm::exp(-gain * TICK_S),
                max_error_pulses: (servo.largest_error.abs() * scale / weight).max(1.0),
            }
        });
        // A motor mounted the other way round needs 008 inverted, after each power-on: it is wired
        // for the delivered value. Every other one turns the right way with 008 as it is now.
        let runs_backwards = match config.reversed {
            true => !is_motor_reversed(axis, &ControlParameters::default()),
            false => is_motor_reversed(axis, parameters),
        };
        Self {
            pulse_mm: if runs_backwards { -weight } else { weight },
            commanded: to_pulses(config.start),
            following_error_pulses: 0.0,
            slide: to_pulses(config.start),
            play_pulses: to_pulses(config.backlash).max(0),
            last_command: 0,
            servo,
            tripped: false,
            blocked: false,
            pulses_per_turn: to_pulses(config.motor_turn).max(1),
            limits: config
                .limits
                .map(|limits| (to_pulses(limits.minus), to_pulses(limits.plus))),
            ends: (to_pulses(ends.minus), to_pulses(ends.plus)),
            real: false,
            dog: config
                .dog
                .map(|dog| (to_pulses(dog.from), to_pulses(dog.to))),
            previous: (to_pulses(config.start), to_pulses(config.start)),
            has_index: config.one_turn_signal,
            index_stretch: IndexRange::default(),
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

    /// Distance of the slide beyond the screw position `position`, mm.
    fn screw_error(&self, position: f64) -> f64 {
        if self.real {
            return 0.0;
        }
        let after = self.screw.partition_point(|point| point.at <= position);
        match (
            after.checked_sub(1).and_then(|index| self.screw.get(index)),
            self.screw.get(after),
        ) {
            (Some(before), Some(next)) => {
                let fraction = (position - before.at) / (next.at - before.at);
                before.error + fraction * (next.error - before.error)
            }
            (Some(only), None) | (None, Some(only)) => only.error,
            (None, None) => 0.0,
        }
    }

    /// Converts drive pulses to pulses that count towards positive coordinates.
    const fn towards_plus(&self, pulses: i64) -> i64 {
        if self.pulse_mm < 0.0 { -pulses } else { pulses }
    }

    /// Position of the motor, pulses from the reference point towards plus.
    fn motor_position(&self) -> i64 {
        if self.following_error_pulses == 0.0 {
            return self.commanded;
        }
        self.commanded - round_to_i64(self.following_error_pulses)
    }

    /// Follows the command count for one tick. A drive that is not enabled, or has tripped,
    /// ignores the pulses.
    pub fn follow(&mut self, command: Pulses, enabled: bool) {
        let pulses = self.towards_plus(command.0 - self.last_command);
        self.last_command = command.0;
        let before = self.motor_position();
        self.previous = (before, self.slide);
        if !enabled || self.tripped {
            self.tripped &= enabled;
            self.commanded = before;
            self.following_error_pulses = 0.0;
            return;
        }
        if pulses == 0 && self.following_error_pulses == 0.0 {
            return;
        }
        match self.servo {
            // A blocked stepper loses its steps.
            None if self.blocked => {}
            None => self.commanded += pulses,
            Some(servo) => {
                self.commanded += pulses;
                self.update_following_error(&servo, pulses);
            }
        }
        let motor = self.stop_at_ends();
        self.slide = motor.max(self.slide.min(motor + self.play_pulses));
        if self.has_index && !self.index_stretch.contains(motor) {
            self.index_stretch = self.index_range_around(motor);
        }
    }

    /// Updates the following error of a servo whose command moved by `pulses` in the tick.
    fn update_following_error(&mut self, servo: &Servo, pulses: i64) {
        let settled = pulses as f64 / TICK_S * servo.lag_s;
        self.following_error_pulses = if self.blocked {
            self.following_error_pulses + pulses as f64
        } else {
            settled + (self.following_error_pulses - settled) * servo.tick_decay
        };
        if pulses == 0 && self.following_error_pulses.abs() < 1e-3 {
            self.following_error_pulses = 0.0;
        }
        self.tripped = self.following_error_pulses.abs() > servo.max_error_pulses;
    }

    /// Stops a motor that would push the slide past its end. The following error of a servo
    /// grows until it trips; a stepper's drive switches off at once. Returns the motor's
    /// position.
    fn stop_at_ends(&mut self) -> i64 {
        let ((minus, plus), before) = (self.ends, self.previous.0);
        let motor = self.motor_position();
        // A slide placed beyond its end can move back, but no farther.
        let limited = motor
            .max((minus - self.play_pulses).min(before))
            .min(plus.max(before));
        if limited == motor || self.real {
            return motor;
        }
        match &self.servo {
            Some(servo) => {
                self.following_error_pulses = (self.commanded - limited) as f64;
                self.tripped = self.following_error_pulses.abs() > servo.max_error_pulses;
            }
            None => {
                self.commanded = limited;
                self.tripped = true;
            }
        }
        limited
    }

    /// Assigns a command count to the present position, without motion.
    pub fn set_count(&mut self, command: Pulses) {
        self.last_command = command.0;
        self.previous = (self.motor_position(), self.slide);
    }

    /// Places the slide at another position, mm from the reference point (X in radius).
    pub fn set_position(&mut self, position: f64) {
        // The screw position for it, by iteration: the screw errors change slowly.
        let mut screw_position = position;
        for _ in 0..4 {
            screw_position = position - self.screw_error(screw_position);
        }
        self.commanded = (screw_position / self.pulse_mm.abs()).round() as i64;
        self.following_error_pulses = 0.0;
        self.slide = self.commanded;
        self.previous = (self.commanded, self.slide);
    }

    /// Position of the slide, mm from the reference point (X in radius).
    pub fn position(&self) -> f64 {
        let screw_position = self.slide as f64 * self.pulse_mm.abs();
        screw_position + self.screw_error(screw_position)
    }

    /// Following error: distance from the motor to its command, mm (X in radius).
    pub fn following_error(&self) -> f64 {
        self.following_error_pulses * self.pulse_mm.abs()
    }

    /// Whether the drive has switched off, because of its following error or an end of the
    /// slide.
    pub const fn is_tripped(&self) -> bool {
        self.tripped
    }

    /// The limit switch that the slide presses; `None` if no limit switch is pressed.
    pub fn pressed_limit(&self) -> Option<TrippedLimit> {
        let (minus, plus) = self.limits?;
        if self.slide < minus {
            return Some(TrippedLimit::Minus);
        }
        (self.slide > plus).then_some(TrippedLimit::Plus)
    }

    /// Whether the slide presses its deceleration switch.
    pub(crate) fn is_on_dog(&self) -> bool {
        self.dog
            .is_some_and(|(from, to)| (from..=to).contains(&self.slide))
    }

    /// Length of the range in each motor revolution in which the one-turn signal is on,
    /// pulses. The range begins at zero.
    const fn index_width(&self) -> i64 {
        (self.pulses_per_turn + INDEX_DIVISOR - 1) / INDEX_DIVISOR
    }

    /// State of the one-turn signal, and the command count at its change in the last tick
    /// (`None` without a change). Its rising edge in the positive direction is at zero.
    #[inline]
    pub fn index_signal(&self) -> (bool, Option<Pulses>) {
        if !self.has_index {
            return (false, None);
        }
        let (from, to) = (self.previous.0, self.motor_position());
        let stretch = &self.index_stretch;
        if stretch.contains(from) && stretch.contains(to) {
            return (stretch.on, None);
        }
        let change = self.index_change((from, to));
        (self.index_range_around(to).on, change)
    }

    /// The range between two changes of the one-turn signal that contains a motor position.
    #[cold]
    const fn index_range_around(&self, position: i64) -> IndexRange {
        let (on_turn, width) = (
            position.rem_euclid(self.pulses_per_turn),
            self.index_width(),
        );
        let on = on_turn < width;
        let (first, next) = if on {
            (0, width)
        } else {
            (width, self.pulses_per_turn)
        };
        IndexRange {
            from: position - on_turn + first,
            end: position - on_turn + next,
            on,
        }
    }

    /// The command count at the first change of the one-turn signal on the motor's travel,
    /// given as start and end; `None` without a change.
    #[cold]
    fn index_change(&self, travel: (i64, i64)) -> Option<Pulses> {
        let starts = [0, self.index_width()];
        self.first_change(travel, |position| {
            let on_turn =
                |start: &i64| position - (position - start).rem_euclid(self.pulses_per_turn);
            starts.iter().map(on_turn).max()
        })
    }

    /// The command count at which the deceleration switch changed in the last tick; `None`
    /// without a change.
    pub(crate) fn dog_latch(&self) -> Option<Pulses> {
        let (from, to) = self.dog?;
        let travel = (self.previous.1, self.slide);
        self.first_change(travel, |position| {
            [from, to + 1]
                .into_iter()
                .filter(|at| *at <= position)
                .max()
        })
    }

    /// The command count at the first change of a signal in the last tick, on the travel of
    /// motor or slide; `None` without a change. `boundary_at_or_before(position)` is the
    /// last boundary at or before a position; a boundary is the first position of its
    /// range.
    fn first_change(
        &self,
        (from, to): (i64, i64),
        boundary_at_or_before: impl Fn(i64) -> Option<i64>,
    ) -> Option<Pulses> {
        if to == from {
            return None;
        }
        let position = if to > from {
            // The first boundary after the start.
            let mut first = boundary_at_or_before(to).filter(|at| *at > from)?;
            while let Some(earlier) = boundary_at_or_before(first - 1).filter(|at| *at > from) {
                first = earlier;
            }
            first
        } else {
            // In the negative direction the position before a boundary is the first beyond
            // it.
            boundary_at_or_before(from).filter(|at| *at > to)? - 1
        };
        // Counted from the end: at a steady speed a servo moves as fast as its command.
        Some(Pulses(self.last_command - self.towards_plus(to - position)))
    }
}
