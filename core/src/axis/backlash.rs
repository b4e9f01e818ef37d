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

use crate::memory::Parameters;
use crate::units::{Axis, TICK_S, round_to_i64};

/// How the compensation is distributed over time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Output {
    /// Method A: at a steady rate, increments per tick.
    Steady(f64),
    /// Method B: with constant acceleration, increments/s².
    Accelerated(f64),
}

/// Backlash of one axis, in least output increments.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Backlash {
    amount: i64,
    output: Output,
    /// Direction in which no compensation is needed.
    first_negative: bool,
    /// Direction of the last motion.
    negative: bool,
    /// Compensation at the start and the end of the change, and ticks since its start.
    from: f64,
    to: f64,
    ticks: u32,
    given: f64,
}

impl Backlash {
    /// State at power-on. `per_mm`: increments per mm; `per_pulse`: increments per pulse.
    pub fn new(axis: Axis, parameters: &Parameters, per_mm: f64, per_pulse: f64) -> Self {
        let amount = parameters.backlash(axis) * per_mm;
        let output = if parameters.backlash_accelerates() {
            let rate = parameters.rapid_rate(axis) / 60.0;
            let time = parameters.rapid_time(axis) / 1000.0;
            Output::Accelerated((rate / time.max(TICK_S)).max(1e-3) * per_mm)
        } else {
            Output::Steady(parameters.backlash_frequency() * TICK_S * per_pulse)
        };
        let first_negative = parameters.reference_is_negative(axis);
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

    /// The compensation for the direction of the last motion.
    const fn wanted(&self) -> i64 {
        match (self.negative, self.first_negative) {
            (true, false) => -self.amount,
            (false, true) => self.amount,
            _ => 0,
        }
    }

    /// Advances one tick in which the axis moved by `way` increments.
    #[inline]
    pub fn tick(&mut self, way: i64) {
        if self.amount != 0 {
            self.give_out(way);
        }
    }

    fn give_out(&mut self, way: i64) {
        if way != 0 && self.negative != (way < 0) {
            self.negative = way < 0;
            self.from = self.given;
            self.to = self.wanted() as f64;
            self.ticks = 0;
        }
        if self.given != self.to {
            self.ticks += 1;
            self.given = self.after(self.ticks);
        }
    }

    /// The compensation at a number of ticks after the reversal.
    fn after(&self, ticks: u32) -> f64 {
        let way = (self.to - self.from).abs();
        let made = match self.output {
            Output::Steady(rate) => rate * f64::from(ticks),
            Output::Accelerated(acceleration) => {
                let (time, whole) = (f64::from(ticks) * TICK_S, 2.0 * (way / acceleration).sqrt());
                let left = whole - time;
                if left <= 0.0 {
                    way
                } else if time <= left {
                    acceleration * time * time / 2.0
                } else {
                    way - acceleration * left * left / 2.0
                }
            }
        };
        if made >= way {
            self.to
        } else if self.to > self.from {
            self.from + made
        } else {
            self.from - made
        }
    }

    /// The compensation now, whole increments.
    pub fn given(&self) -> i64 {
        round_to_i64(self.given)
    }

    /// Takes over new parameters at a standstill. The play stays on the side of the last
    /// motion and counts as taken up.
    pub(crate) fn reconfigured(&self, changed: Self) -> Self {
        let mut new = Self {
            negative: self.negative,
            ..changed
        };
        new.to = new.wanted() as f64;
        new.given = new.to;
        new
    }

    /// Whether the compensation is complete.
    pub(crate) fn is_settled(&self) -> bool {
        self.given == self.to
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Z with 0.1 mm of play: 100 increments.
    fn backlash(changes: &[(u16, i32)]) -> Backlash {
        let mut parameters = Parameters::default();
        parameters.set(35, 100).unwrap();
        for (number, value) in changes {
            parameters.set(*number, *value).unwrap();
        }
        Backlash::new(Axis::Z, &parameters, 1000.0, 1.0)
    }

    fn ticks_to_settle(backlash: &mut Backlash, way: i64) -> (i64, u32) {
        backlash.tick(way);
        let mut ticks = 1;
        while !backlash.is_settled() {
            backlash.tick(0);
            ticks += 1;
        }
        (backlash.given(), ticks)
    }

    #[test]
    fn it_comes_and_goes_with_the_direction() {
        let mut one = backlash(&[]);
        assert_eq!(ticks_to_settle(&mut one, 5).0, 0);
        assert_eq!(ticks_to_settle(&mut one, -1).0, -100);
        assert_eq!(ticks_to_settle(&mut one, -5).0, -100);
        assert_eq!(ticks_to_settle(&mut one, 1).0, 0);
    }

    #[test]
    fn the_first_move_against_006_has_it() {
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
    fn a_reversal_while_it_is_given_out_turns_it_back() {
        let mut one = backlash(&[(11, 0)]);
        for _ in 0..20 {
            one.tick(-1);
        }
        assert_eq!(one.given(), -40);
        assert_eq!(ticks_to_settle(&mut one, 1), (0, 20));
    }
}
