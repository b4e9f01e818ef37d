//! Step rates and timing of boards by their processor.

use super::super::{LinkConfig, MotionRefused, PulseRates};
use super::step_compress::Ticks;
use super::steps::Timing;

/// Greatest measured number of steps per second of both axes together, by the beginning of the
/// processor name. The link uses half.
const MEASURED: [(&str, u32); 8] = [
    // Our own firmware, in an emulator: each axis 260 000.
    ("gsk980td-rp2040", 520_000),
    ("stm32g0b1", 790_000),
    ("stm32f103", 820_000),
    ("stm32f407", 2_400_000),
    ("stm32f446", 2_600_000),
    ("rp2040", 2_500_000),
    ("rp2350", 2_600_000),
    ("stm32h723", 8_600_000),
];
/// Greatest number of steps per second, of both axes together, that the link sends to an unknown
/// processor.
const UNKNOWN: u32 = 100_000;
/// Greatest number of steps per second that the link sends to an AVR processor for each axis.
const AVR: u32 = 32_000;
/// Greatest number of messages per second that the link sends to an AVR processor.
const AVR_MESSAGES: u32 = 700;
/// Greatest time error of a step of an AVR processor, µs.
const AVR_STEP_ERROR_US: f64 = 5.0;
/// Greatest time error of a step of other processors, µs.
const USUAL_STEP_ERROR_US: f64 = 2.0;

/// The step rates, message rate and timing that a board can keep.
#[derive(Clone, Debug)]
pub(super) struct Rates {
    pub(super) timing: [Timing; 2],
    /// Greatest step rates of the axes, steps per second.
    pub(super) most: PulseRates,
    /// Greatest number of messages per second; `None` without a limit.
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
        let max_error = ticks(if avr {
            AVR_STEP_ERROR_US
        } else {
            USUAL_STEP_ERROR_US
        })
        .max(2);
        let timing = [0, 1].map(|axis| {
            let min_interval = (rate / each[axis]) as Ticks;
            let pause = axes[axis].dir_setup_us + axes[axis].step_pulse_us;
            let reversal = ticks(pause.into()).max(min_interval) + 2 * max_error;
            Timing {
                rate,
                max_error,
                min_interval,
                reversal,
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

    /// Checks that the board can make the pulses `moves` of X and Z in the time `seconds`.
    ///
    /// # Errors
    /// The motion needs more pulses per second than the board can make.
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
    fn rates_depend_on_the_processor() {
        let config = LinkConfig::default();
        let avr = Rates::new(&config, "atmega2560", 16e6);
        assert_eq!(avr.allow([33, 33], 1e-3), Ok(()));
        assert_eq!(avr.allow([34, 0], 1e-3), Err(MotionRefused::TooFast));
        let timing = avr.timing[0];
        assert_eq!((timing.max_error, timing.min_interval), (80, 500));
        let arm = Rates::new(&config, "rp2040", 12e6);
        assert_eq!(arm.allow([600, 600], 1e-3), Ok(()));
        assert_eq!(arm.allow([700, 600], 1e-3), Err(MotionRefused::TooFast));
        assert_eq!(arm.timing[0].max_error, 24);
    }
}
