//! A spindle with an encoder: driven by the outputs of the board or at a given speed, with
//! a ripple in each turn and a load that slows it down.

use core::f64::consts::TAU;

/// Length of the index signal, counts.
const INDEX_COUNTS: i64 = 4;

/// The pins and the behaviour of a spindle at a pulse board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleEncoderWiring {
    /// GPIO of the index signal.
    pub index_pin: u32,
    /// GPIO of the outputs that turn the spindle forward and in reverse; `None` for a spindle that
    /// the board does not switch.
    pub direction_pins: Option<[u32; 2]>,
    /// GPIO of the PWM output for the speed; `None` for a spindle with one speed.
    pub speed_pin: Option<u32>,
    /// Counts per turn: four for each line of the encoder.
    pub counts_per_turn: u32,
    /// Spindle speed at full output, r/min.
    pub full_speed_rpm: f64,
    /// Time constant with which the spindle changes its speed, s.
    pub time_constant_s: f64,
}

/// A load that slows the spindle down when a slide enters an interval, as a tool does that begins
/// to cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleLoad {
    /// Index of the stepper, 0 or 1.
    pub stepper: usize,
    /// First and last position of the interval, pulses.
    pub interval: [i64; 2],
    /// Share of the speed that is lost, 0 to 1.
    pub lost_share: f64,
    /// Number of turns for which it is lost.
    pub turns: f64,
}

/// The spindle over time.
#[derive(Clone, Copy, Debug)]
pub(super) struct EncoderSpindle {
    pub(super) wiring: SpindleEncoderWiring,
    /// Turns since power-on, negative in reverse.
    pub(super) turns: f64,
    /// Speed without ripple and load, and its target, turns per second.
    pub(super) speed: f64,
    target: f64,
    /// Amplitude of the ripple as a share of the speed, and its number in a turn.
    pub(super) ripple: (f64, f64),
    pub(super) load: Option<SpindleLoad>,
    /// The turns at which the load ends; `None` without a load.
    loaded_until: Option<f64>,
    was_inside: bool,
    pub(super) is_stalled: bool,
    /// Whether the spindle keeps its speed and direction whatever the outputs are, as with a
    /// contactor that sticks.
    pub(super) is_drive_stuck: bool,
    /// Whether the output for the reverse direction has no effect.
    pub(super) is_reverse_missing: bool,
    /// Counts that the encoder shows too many.
    pub(super) jumped: i64,
    /// Whether A and B of the encoder are exchanged.
    pub(super) is_encoder_reversed: bool,
    pub(super) is_index_lost: bool,
    /// Whether the index signal is disturbed: high all the time.
    pub(super) is_index_stuck: bool,
}

impl EncoderSpindle {
    pub(super) const fn new(wiring: SpindleEncoderWiring) -> Self {
        Self {
            wiring,
            // Not at the index.
            turns: 0.3,
            speed: 0.0,
            target: 0.0,
            ripple: (0.0, 1.0),
            load: None,
            loaded_until: None,
            was_inside: false,
            is_stalled: false,
            is_drive_stuck: false,
            is_reverse_missing: false,
            jumped: 0,
            is_encoder_reversed: false,
            is_index_lost: false,
            is_index_stuck: false,
        }
    }

    /// Sets the target speed from the outputs of the board; `output` returns a value as a share.
    pub(super) fn drive(&mut self, output: impl Fn(u32) -> f64) {
        let Some([forward, reverse]) = self.wiring.direction_pins else {
            return;
        };
        if self.is_drive_stuck {
            return;
        }
        let turns_back = output(reverse) > 0.0 && !self.is_reverse_missing;
        let direction = match (output(forward) > 0.0, turns_back) {
            (true, false) => 1.0,
            (false, true) => -1.0,
            _ => 0.0,
        };
        let share = self.wiring.speed_pin.map_or(1.0, output);
        self.target = direction * share * self.wiring.full_speed_rpm / 60.0;
    }

    /// Sets the speed of a spindle that the board does not switch, turns per second.
    pub(super) const fn set_speed(&mut self, speed: f64) {
        self.speed = speed;
        self.target = speed;
    }

    /// Returns the speed with ripple and load, turns per second.
    pub(super) fn actual_speed(&self) -> f64 {
        if self.is_stalled {
            return 0.0;
        }
        let (share, number) = self.ripple;
        let ripple = 1.0 + share * (self.turns * number * TAU).sin();
        let lost = match (self.load, self.loaded_until) {
            (Some(load), Some(_)) => load.lost_share,
            _ => 0.0,
        };
        self.speed * ripple * (1.0 - lost)
    }

    /// Advances by a time, s; the slides are at `pulses`.
    pub(super) fn advance(&mut self, seconds: f64, pulses: [i64; 2]) {
        let time = self.wiring.time_constant_s;
        if time > 0.0 {
            self.speed += (self.target - self.speed) * (seconds / time).min(1.0);
        } else {
            self.speed = self.target;
        }
        if let Some(load) = self.load {
            let at = pulses[load.stepper % 2];
            let is_inside = (load.interval[0]..=load.interval[1]).contains(&at);
            if is_inside && !self.was_inside {
                self.loaded_until = Some(self.turns.abs() + load.turns);
            }
            self.was_inside = is_inside;
        }
        self.turns += self.actual_speed() * seconds;
        let is_over = |end: &f64| self.turns.abs() >= *end;
        if self.loaded_until.as_ref().is_some_and(is_over) {
            self.loaded_until = None;
        }
    }

    /// Returns the count of the encoder.
    pub(super) fn count(&self) -> i64 {
        self.true_count() + self.jumped
    }

    /// Returns the count without lost and doubled edges.
    fn true_count(&self) -> i64 {
        let count = (self.turns * f64::from(self.wiring.counts_per_turn)).floor() as i64;
        if self.is_encoder_reversed {
            -count
        } else {
            count
        }
    }

    /// Returns the levels of the pins that the spindle drives.
    pub(super) fn levels(&self) -> u32 {
        let turn = i64::from(self.wiring.counts_per_turn.max(1));
        let is_at_index = self.true_count().rem_euclid(turn) < INDEX_COUNTS && !self.is_index_lost;
        u32::from(is_at_index || self.is_index_stuck) << self.wiring.index_pin
    }
}
