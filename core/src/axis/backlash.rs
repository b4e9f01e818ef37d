//! Backlash compensation: the play of the screw, taken up once at each reversal (034, 035;
//! 006.0 and 006.1, 010.3–010.0, 011.7, 011.6; manual III-12.8).
//!
//! ```text
//!  given │        ┌──── A (011.7 = 0): at (CPF + 1) kpps, 011.6: an eighth of it
//!        │   ___╱
//!        │  ╱  .──      B (011.7 = 1): evenly faster, then evenly slower, with the
//!        │ ╱ .'         acceleration of the axis in rapid
//!        └─┴───────► t
//!     reversal
//! ```

use serde::{Deserialize, Serialize};

use crate::memory::ControlParameters;
use crate::units::{Axis, TICK_S, round_to_i64};

/// How backlash compensation is distributed over the time after a reversal.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum BacklashMethod {
    /// Method A: at a steady rate, increments per tick.
    Steady(f64),
    /// Method B: the compensation accelerates with this value, increments/s².
    Accelerated(f64),
}

/// Backlash compensation of one axis, in least output increments.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Backlash {
    amount: i64,
    output: BacklashMethod,
    /// Whether motion in the negative direction needs no compensation; otherwise motion in
    /// the positive one.
    first_negative: bool,
    /// Whether the last motion was in the negative direction.
    negative: bool,
    /// Compensation before and after the present change, increments, and ticks since the
    /// reversal.
    from: f64,
    to: f64,
    ticks: u32,
    given: f64,
}

impl Backlash {
    /// State at power-on. `per_mm`: increments per mm of slide travel; `per_pulse`:
    /// increments per drive pulse.
    pub fn new(axis: Axis, parameters: &ControlParameters, per_mm: f64, per_pulse: f64) -> Self {
        let amount = parameters.backlash(axis) * per_mm;
        let output = if parameters.is_backlash_accelerated() {
            let rate = parameters.rapid_rate(axis) / 60.0;
            let time = parameters.rapid_time(axis) / 1000.0;
            BacklashMethod::Accelerated((rate / time.max(TICK_S)).max(1e-3) * per_mm)
        } else {
            BacklashMethod::Steady(parameters.backlash_frequency() * TICK_S * per_pulse)
        };
        let first_negative = parameters.is_reference_negative(axis);
        Self {
            amount: libm::round(amount) as i64,
            output,
            first_negative,
            negative: first_negative,
            from: 0.0,
            to: 0.0,
            ticks: 0,
            given: 0.0,
        }
    }

    /// The compensation that the direction of the last motion needs, increments.
    const fn target(&self) -> i64 {
        match (self.negative, self.first_negative) {
            (true, false) => -self.amount,
            (false, true) => self.amount,
            _ => 0,
        }
    }

    /// Advances by one tick in which the axis moved by this number of increments.
    #[inline]
    pub fn tick(&mut self, increments: i64) {
        if self.amount != 0 {
            self.advance(increments);
        }
    }

    fn advance(&mut self, increments: i64) {
        if increments != 0 && self.negative != (increments < 0) {
            self.negative = increments < 0;
            self.from = self.given;
            self.to = self.target() as f64;
            self.ticks = 0;
        }
        if self.given != self.to {
            self.ticks += 1;
            self.given = self.compensation_after(self.ticks);
        }
    }

    /// The compensation at a number of ticks after the reversal, increments.
    fn compensation_after(&self, ticks: u32) -> f64 {
        let distance = (self.to - self.from).abs();
        let done = match self.output {
            BacklashMethod::Steady(rate) => rate * f64::from(ticks),
            BacklashMethod::Accelerated(acceleration) => {
                let (time, whole) = (
                    f64::from(ticks) * TICK_S,
                    2.0 * (distance / acceleration).sqrt(),
                );
                let left = whole - time;
                if left <= 0.0 {
                    distance
                } else if time <= left {
                    acceleration * time * time / 2.0
                } else {
                    distance - acceleration * left * left / 2.0
                }
            }
        };
        if done >= distance {
            self.to
        } else if self.to > self.from {
            self.from + done
        } else {
            self.from - done
        }
    }

    /// The compensation in force, rounded to whole increments.
    pub fn compensation(&self) -> i64 {
        round_to_i64(self.given)
    }

    /// Returns `changed`, the backlash with new parameters, with the state of this one. Call it at
    /// a standstill: the play of the screw is on the side of the last motion and counts as
    /// compensated.
    pub(crate) fn with_parameters(&self, changed: Self) -> Self {
        let mut new = Self {
            negative: self.negative,
            ..changed
        };
        new.to = new.target() as f64;
        new.given = new.to;
        new
    }

    /// Whether the compensation has reached the value that the direction of the last motion
    /// needs.
    pub(crate) fn is_settled(&self) -> bool {
        self.given == self.to
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Z with 0.1 mm of play: 100 increments.
    fn backlash(changes: &[(u16, i32)]) -> Backlash {
        let mut parameters = ControlParameters::default();
        parameters.set(35, 100).unwrap();
        for (number, value) in changes {
            parameters.set(*number, *value).unwrap();
        }
        Backlash::new(Axis::Z, &parameters, 1000.0, 1.0)
    }

    fn ticks_to_settle(backlash: &mut Backlash, increments: i64) -> (i64, u32) {
        backlash.tick(increments);
        let mut ticks = 1;
        while !backlash.is_settled() {
            backlash.tick(0);
            ticks += 1;
        }
        (backlash.compensation(), ticks)
    }

    #[test]
    fn compensation_follows_the_direction() {
        let mut one = backlash(&[]);
        assert_eq!(ticks_to_settle(&mut one, 5).0, 0);
        assert_eq!(ticks_to_settle(&mut one, -1).0, -100);
        assert_eq!(ticks_to_settle(&mut one, -5).0, -100);
        assert_eq!(ticks_to_settle(&mut one, 1).0, 0);
    }

    #[test]
    fn the_first_move_against_006_is_compensated() {
        let mut one = backlash(&[(6, 0b10)]);
        assert_eq!(ticks_to_settle(&mut one, -1).0, 0);
        assert_eq!(ticks_to_settle(&mut one, 1).0, 100);
        assert_eq!(ticks_to_settle(&mut one, -1).0, 0);
    }

    /// 010 = 1: 2 kpps, 100 increments in 50 ms; 011.6: an eighth, 400 ms.
    #[test]
    fn method_a_has_the_frequency_of_010() {
        assert_eq!(ticks_to_settle(&mut backlash(&[(11, 0)]), -1), (-100, 50));
        let eighth = &mut backlash(&[(11, 0b0100_0000)]);
        assert_eq!(ticks_to_settle(eighth, -1), (-100, 400));
        let fast = &mut backlash(&[(11, 0), (10, 0b1001)]);
        assert_eq!(ticks_to_settle(fast, -1), (-100, 10));
    }

    /// Z: 7600 mm/min in 300 ms are 422 mm/s²; 2 √(0.1 / 422) = 30.8 ms.
    #[test]
    fn method_b_has_the_acceleration_of_rapid() {
        let one = &mut backlash(&[]);
        assert_eq!(ticks_to_settle(one, -1), (-100, 31));
        let same = &mut backlash(&[(10, 0b1111), (11, 0b1100_0000)]);
        assert_eq!(ticks_to_settle(same, -1), (-100, 31));
        let slow = &mut backlash(&[(25, 1200)]);
        assert_eq!(ticks_to_settle(slow, -1), (-100, 62));
    }

    #[test]
    fn a_reversal_during_compensation_reverses_it() {
        let mut one = backlash(&[(11, 0)]);
        for _ in 0..20 {
            one.tick(-1);
        }
        assert_eq!(one.compensation(), -40);
        assert_eq!(ticks_to_settle(&mut one, 1), (0, 20));
    }
}
