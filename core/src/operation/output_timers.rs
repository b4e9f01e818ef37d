//! Timers for outputs that a program switches directly.

use serde::{Deserialize, Serialize};

use crate::units::TICK_MS;

/// Number of outputs with a timer, Y0 to Y23.
const OUTPUTS: usize = 24;

/// Time after which each output switches off, ms; 0: the output keeps its state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct OutputTimers([u32; OUTPUTS]);

impl OutputTimers {
    /// Switches outputs and sets their timers; a later command replaces a running timer.
    /// `outputs`, `on`, `off` and the result are masks with Y0 in bit 0; the result is the
    /// new state of all outputs.
    pub(crate) fn switch(&mut self, outputs: u32, on: u32, off: u32, ms: u32) -> u32 {
        for (output, left_ms) in self.0.iter_mut().enumerate() {
            if (on | off) >> output & 1 == 1 {
                *left_ms = if on >> output & 1 == 1 { ms } else { 0 };
            }
        }
        (outputs | on) & !off
    }

    /// Advances by one tick (1 ms). Returns the mask of the outputs whose time has elapsed.
    pub(crate) fn tick(&mut self) -> u32 {
        if self.is_idle() {
            return 0;
        }
        let mut elapsed = 0;
        for (output, left_ms) in self.0.iter_mut().enumerate() {
            if *left_ms > 0 {
                *left_ms = left_ms.saturating_sub(TICK_MS);
                elapsed |= u32::from(*left_ms == 0) << output;
            }
        }
        elapsed
    }

    /// Whether no timer is running.
    pub(crate) fn is_idle(&self) -> bool {
        self.0.iter().fold(0, |any, left| any | left) == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_output_goes_off_after_its_time() {
        let mut timers = OutputTimers::default();
        assert_eq!(timers.switch(0b0001, 0b1000, 0, 3), 0b1001);
        let over: Vec<u32> = (0..4).map(|_| timers.tick()).collect();
        assert_eq!(over, [0, 0, 0b1000, 0]);
    }

    #[test]
    fn the_last_command_wins() {
        let mut timers = OutputTimers::default();
        timers.switch(0, 0b1000, 0, 3);
        assert_eq!(timers.switch(0b1000, 0b1000, 0, 0), 0b1000);
        assert!(timers.is_idle());
        timers.switch(0, 0b1000, 0, 3);
        assert_eq!(timers.switch(0b1000, 0, 0b1000, 0), 0);
        assert!(timers.is_idle());
    }
}
