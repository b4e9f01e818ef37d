//! How many steps a second a board makes.

use super::super::{LinkConfig, MotionRefused, PulseRates};
use super::compression::Ticks;
use super::steps::Timing;

/// Steps a second of both axes together that processors were measured to make; half
/// of it is used.
const MEASURED: [(&str, u32); 7] = [
    ("stm32g0b1", 790_000),
    ("stm32f103", 820_000),
    ("stm32f407", 2_400_000),
    ("stm32f446", 2_600_000),
    ("rp2040", 2_500_000),
    ("rp2350", 2_600_000),
    ("stm32h723", 8_600_000),
];
/// Of a processor nobody has measured.
const UNKNOWN: u32 = 100_000;
/// Of each axis of the small AVR boards, which are also coarser in time.
const AVR: u32 = 32_000;
/// Messages a second of such a board.
const AVR_MESSAGES: u32 = 700;
/// Farthest a step may lie from its time, µs.
const AVR_OFF: f64 = 5.0;
const USUAL_OFF: f64 = 2.0;

/// What a board can do.
#[derive(Clone, Debug)]
pub(super) struct Rates {
    pub(super) timing: [Timing; 2],
    /// Steps a second of each axis, and of both.
    pub(super) most: PulseRates,
    /// Most messages a second, where they are counted.
    pub(super) messages: Option<u32>,
}

impl Rates {
    pub(super) fn unknown() -> Self {
        Self::new(&LinkConfig::default(), "", 1e6)
    }

    pub(super) fn new(config: &LinkConfig, processor: &str, rate: f64) -> Self {
        let avr = ["atmega", "at90"]
            .iter()
            .any(|begin| processor.starts_with(begin));
        let measured = MEASURED
            .iter()
            .find(|(begin, _)| processor.starts_with(begin));
        let both = match measured {
            _ if avr => 2 * AVR,
            Some((_, rate)) => rate / 2,
            None => UNKNOWN,
        };
        let usual = if avr { AVR } else { both };
        let axes = [&config.x, &config.z];
        let each = axes.map(|axis| f64::from(axis.max_rate.unwrap_or(usual)));
        let ticks = |micros: f64| (micros * rate / 1e6) as Ticks;
        let off = ticks(if avr { AVR_OFF } else { USUAL_OFF }).max(2);
        let timing = [0, 1].map(|axis| {
            let apart = (rate / each[axis]) as Ticks;
            let pause = axes[axis].dir_setup_us + axes[axis].step_pulse_us;
            let turn = ticks(pause.into()).max(apart) + 2 * off;
            Timing {
                rate,
                off,
                apart,
                turn,
            }
        });
        Self {
            timing,
            most: PulseRates {
                each,
                both: f64::from(both),
            },
            messages: avr.then_some(AVR_MESSAGES),
        }
    }

    /// Whether so many pulses in so many seconds can be made.
    pub(super) fn allow(&self, moves: [i64; 2], seconds: f64) -> Result<(), MotionRefused> {
        let counts = moves.map(|count| count.unsigned_abs() as f64);
        let too_fast = |count: f64, rate: f64| count > rate * seconds + 1.0;
        let PulseRates { each, both } = self.most;
        if too_fast(counts[0], each[0])
            || too_fast(counts[1], each[1])
            || too_fast(counts[0] + counts[1] - 1.0, both)
        {
            return Err(MotionRefused::TooFast);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn processors_have_their_rates() {
        let config = LinkConfig::default();
        let avr = Rates::new(&config, "atmega2560", 16e6);
        assert_eq!(avr.allow([33, 33], 1e-3), Ok(()));
        assert_eq!(avr.allow([34, 0], 1e-3), Err(MotionRefused::TooFast));
        assert_eq!((avr.timing[0].off, avr.timing[0].apart), (80, 500));
        let arm = Rates::new(&config, "rp2040", 12e6);
        assert_eq!(arm.allow([600, 600], 1e-3), Ok(()));
        assert_eq!(arm.allow([700, 600], 1e-3), Err(MotionRefused::TooFast));
        assert_eq!(arm.timing[0].off, 24);
    }
}
