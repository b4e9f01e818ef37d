//! The parameters that a board was checked against when it was connected.

use serde::{Deserialize, Serialize};

use super::Protocol;
use super::line::Limits;
use crate::alarm::Alarm;
use crate::memory::Parameters;
use crate::units::Axis;

/// The electronic gear of X and of Z.
const GEAR: [u16; 4] = [15, 16, 17, 18];
/// Radius programming and the inch machine: they make the increment another one.
const INCREMENT: [(u16, u8); 2] = [(1, 2), (4, 0)];
/// Rapid rate, its time constant and the highest feed, by axis.
const RATES: [(Axis, [u16; 3]); 2] = [(Axis::X, [22, 24, 27]), (Axis::Z, [23, 25, 27])];

/// What they were.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Checked {
    gear: [i32; 4],
    increment: [bool; 2],
    /// For a board with rates of its own.
    rates: Option<[[i32; 3]; 2]>,
}

impl Checked {
    pub(crate) fn new(parameters: &Parameters, protocol: Protocol) -> Self {
        let rates = RATES.map(|(_, numbers)| numbers.map(|number| parameters.value(number)));
        Self {
            gear: GEAR.map(|number| parameters.value(number)),
            increment: INCREMENT.map(|(number, bit)| parameters.bit(number, bit)),
            rates: (protocol == Protocol::Line).then_some(rates),
        }
    }

    /// Why nothing begins to move before the board is connected again.
    pub(crate) fn alarm(&self, parameters: &Parameters) -> Option<Alarm> {
        let number = self.outgrown(parameters)?;
        Some(Alarm::new(603).because(format!(
            "No.{number} has changed since the board was connected: connect it again"
        )))
    }

    /// The first parameter that is not what the board was checked against: pulses would
    /// be other ways, or the board would be slower than the control. Lower rates do no
    /// harm.
    fn outgrown(&self, parameters: &Parameters) -> Option<String> {
        let mut gear = GEAR.into_iter().zip(self.gear);
        if let Some((number, _)) = gear.find(|&(number, was)| parameters.value(number) != was) {
            return Some(format!("{number:03}"));
        }
        let mut increment = INCREMENT.into_iter().zip(self.increment);
        let changed = increment.find(|&((number, bit), was)| parameters.bit(number, bit) != was);
        if let Some(((number, bit), _)) = changed {
            return Some(format!("{number:03}.{bit}"));
        }
        for ((axis, numbers), was) in RATES.into_iter().zip(self.rates?) {
            let [rapid, time, feed] = was.map(f64::from);
            let (was_limits, limits) =
                (Limits::new(rapid, time, feed), Limits::of(axis, parameters));
            if limits.rate > was_limits.rate || limits.acceleration > was_limits.acceleration {
                let mut changed = numbers.into_iter().zip(was);
                let changed = changed.find(|&(number, was)| parameters.value(number) != was);
                return changed.map(|(number, _)| format!("{number:03}"));
            }
        }
        None
    }
}
