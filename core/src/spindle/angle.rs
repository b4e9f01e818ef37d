//! Estimates the spindle angle from the encoder counts, finer than one count.
//!
//! A count covers a range of angles and arrives up to a tick late: a thread cut by bare
//! counts would jerk by one count per tick. A small observer (position and rate, critically
//! damped) follows the counts. At a steady speed it has no lag; at a changing speed it
//! never leaves the range of the count.

use serde::{Deserialize, Serialize};

use super::encoder::Encoder;
use crate::memory::ControlParameters;

/// Fraction of the observed error by which the angle is corrected in a tick. The next constant is
/// that of the rate.
const ANGLE_GAIN: f64 = 0.4;
const RATE_GAIN: f64 = 0.05;

/// The spindle angle around one tick, in turns since power-on; negative in reverse.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SpindleTurn {
    /// Angle at the beginning of the tick, turns.
    pub before: f64,
    /// Angle at the end of the tick, turns.
    pub now: f64,
    /// Spindle angle at the last one-turn signal, turns.
    pub index: f64,
    /// An angle at which a revolution of the spindle begins; the other such angles differ
    /// from it by whole turns.
    pub zero: f64,
}

/// Estimates the spindle angle from encoder counts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpindleAngle {
    /// Turns per count; 0 without a usable encoder (070).
    #[serde(rename = "scale")]
    turns_per_count: f64,
    /// Whether encoder and spindle turn at the same speed (110 = 111): each signal begins a
    /// revolution.
    direct: bool,
    count: Option<i64>,
    index_count: Option<i64>,
    /// Angle beyond the count, in counts, and its rate, counts per tick.
    #[serde(rename = "beyond")]
    beyond_counts: f64,
    rate: f64,
    zero: Option<f64>,
    turn: SpindleTurn,
}

impl SpindleAngle {
    /// Creates an estimate that has not received a count yet.
    pub fn new(parameters: &ControlParameters) -> Self {
        Self {
            turns_per_count: Encoder::counts_per_spindle_turn(parameters)
                .map_or(0.0, |counts| 1.0 / counts),
            direct: parameters.is_encoder_direct(),
            count: None,
            index_count: None,
            beyond_counts: 0.5,
            rate: 0.0,
            zero: None,
            turn: SpindleTurn::default(),
        }
    }

    /// The spindle angle before and after the last tick.
    pub const fn turn(&self) -> SpindleTurn {
        self.turn
    }

    /// Sets the angle to the value that a pulse board measures, which replaces the encoder.
    pub const fn set_measured_turn(&mut self, turn: SpindleTurn) {
        self.turn = turn;
        self.count = None;
        self.index_count = None;
        self.zero = None;
        self.beyond_counts = 0.5;
        self.rate = 0.0;
    }

    /// Advances by one tick: `count` is the absolute encoder count, `index` the count at
    /// the encoder's last one-turn signal.
    pub fn tick(&mut self, count: i64, index: i64) {
        let step = count - self.count.unwrap_or(count);
        self.count = Some(count);
        // The middle of the count is where the angle is on average.
        let predicted = self.beyond_counts + self.rate - step as f64;
        let error = 0.5 - predicted;
        self.beyond_counts = (predicted + ANGLE_GAIN * error).clamp(0.0, 1.0);
        self.rate += RATE_GAIN * error;
        let before = self.turn.now;
        self.turn.now = (count as f64 + self.beyond_counts) * self.turns_per_count;
        self.turn.before = if step == 0 && self.index_count.is_none() {
            self.turn.now
        } else {
            before
        };
        let previous = self.index_count.replace(index);
        if previous.is_some_and(|known| known != index) {
            self.turn.index = index as f64 * self.turns_per_count;
            if self.direct || self.zero.is_none() {
                self.zero = Some(self.turn.index);
            }
            self.turn.zero = self.zero.unwrap_or_default();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs ticks at a steady speed. Returns the greatest error of the angle after it has
    /// settled, turns.
    fn error_at(rpm: f64) -> f64 {
        let mut angle = SpindleAngle::new(&ControlParameters::default());
        let mut worst = 0.0f64;
        for tick in 0..3000 {
            let turns = rpm / 60_000.0 * f64::from(tick) + 0.123;
            let count = (turns * 4096.0).floor() as i64;
            angle.tick(count, turns.floor() as i64 * 4096);
            if tick > 200 {
                worst = worst.max((angle.turn().now - turns).abs());
            }
        }
        worst
    }

    #[test]
    fn a_steady_angle_is_exact_to_half_a_count() {
        for rpm in [37.0, 100.0, 499.3, 500.0, 1234.5, 3000.0, -700.0] {
            let error = error_at(rpm) * 4096.0;
            assert!(error < 0.5, "{error} counts at {rpm} r/min");
        }
    }

    #[test]
    fn a_braking_spindle_is_exact_to_one_count() {
        let mut angle = SpindleAngle::new(&ControlParameters::default());
        let (mut rpm, mut turns) = (1500.0, 0.2);
        for tick in 0..4000 {
            // 100 ms to a tenth: as hard as a brake.
            let target = if tick < 500 { 1500.0 } else { -1500.0 };
            rpm += (target - rpm) * 0.023;
            turns += rpm / 60_000.0;
            let count = f64::floor(turns * 4096.0) as i64;
            angle.tick(count, f64::floor(turns) as i64 * 4096);
            let error = (angle.turn().now - turns).abs() * 4096.0;
            assert!(tick < 200 || error <= 1.0, "{error} counts at {rpm}");
        }
    }

    #[test]
    fn a_spindle_at_standstill_has_no_motion() {
        let mut angle = SpindleAngle::new(&ControlParameters::default());
        for _ in 0..1000 {
            angle.tick(12_345, 8192);
        }
        let turn = angle.turn();
        assert!((turn.now - turn.before).abs() < 1e-12);
        assert!((turn.now * 4096.0 - 12_345.5).abs() < 1e-6);
    }

    #[test]
    fn geared_encoders_keep_the_first_signal_as_their_zero() {
        // The encoder turns twice for one turn of the spindle.
        let mut parameters = ControlParameters::default();
        parameters.set(110, 2).unwrap();
        let mut angle = SpindleAngle::new(&parameters);
        for count in 0..30_000 {
            angle.tick(count, count / 4096 * 4096);
        }
        assert_eq!(angle.turn().zero, 0.5);
        assert_eq!(angle.turn().index, 3.5);
    }

    #[test]
    fn without_a_usable_encoder_there_is_no_angle() {
        let mut parameters = ControlParameters::default();
        parameters.set(70, 50).unwrap();
        let mut angle = SpindleAngle::new(&parameters);
        for count in 0..1000 {
            angle.tick(count * 7, 0);
        }
        assert_eq!(angle.turn(), SpindleTurn::default());
    }
}
