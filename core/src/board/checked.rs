//! The parameters that a board was configured with, compared with the present ones.

use crate::alarm::{Alarm, number};
use crate::memory::{ControlParameters, parameter};
use crate::units::Axis;
use gsk_link::{AxisRates, Protocol};
use gsk_messages::say;

/// Parameters of the electronic gear: multiplier and divisor of X and Z.
const GEAR: [u16; 4] = [
    parameter::X_MULTIPLIER,
    parameter::Z_MULTIPLIER,
    parameter::X_DIVISOR,
    parameter::Z_DIVISOR,
];
/// Radius programming and inch machine: both change the least increment.
const INCREMENT: [(u16, u8); 2] = [(1, 2), (4, 0)];
/// Rapid rate, its time constant and the highest feed of each axis.
const RATES: [(Axis, [u16; 3]); 2] = [
    (
        Axis::X,
        [
            parameter::X_RAPID,
            parameter::X_RAPID_TIME,
            parameter::FEED_LIMIT,
        ],
    ),
    (
        Axis::Z,
        [
            parameter::Z_RAPID,
            parameter::Z_RAPID_TIME,
            parameter::FEED_LIMIT,
        ],
    ),
];

/// Parameter values at the time of the connection, compared with later ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CheckedParameters {
    gear: [i32; 4],
    increment: [bool; 2],
    /// Rapid rate, time constant and feed limit of X and Z. Set only for boards that plan motion
    /// with their own rates. Otherwise `None`.
    rates: Option<[[i32; 3]; 2]>,
}

impl CheckedParameters {
    pub(crate) fn new(parameters: &ControlParameters, protocol: Protocol) -> Self {
        let rates = RATES.map(|(_, numbers)| numbers.map(|number| parameters.value(number)));
        Self {
            gear: GEAR.map(|number| parameters.value(number)),
            increment: INCREMENT.map(|(number, bit)| parameters.bit(number, bit)),
            rates: (protocol == Protocol::Line).then_some(rates),
        }
    }

    /// The alarm that prevents motion until the board is connected again; `None` if no
    /// relevant parameter has changed.
    pub(crate) fn to_alarm(self, parameters: &ControlParameters) -> Option<Alarm> {
        let changed = self.changed_parameter(parameters)?;
        let why = say::parameter_since_connection(changed);
        Some(Alarm::new(number::BOARD_SETTINGS).with_detail(why))
    }

    /// Number of the first parameter that differs in a harmful way, as text: pulses would
    /// have another size, or the board would be slower than the control. `None` without
    /// one; lower rates do no harm.
    fn changed_parameter(&self, parameters: &ControlParameters) -> Option<String> {
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
            let (was_limits, limits) = (
                AxisRates::new(rapid, time, feed),
                board_rates(axis, parameters),
            );
            if limits.rate > was_limits.rate || limits.acceleration > was_limits.acceleration {
                let mut changed = numbers.into_iter().zip(was);
                let changed = changed.find(|&(number, was)| parameters.value(number) != was);
                return changed.map(|(number, _)| format!("{number:03}"));
            }
        }
        None
    }
}

/// Speed and acceleration that the board must allow an axis, from 022–025 and 027.
pub(crate) fn board_rates(axis: Axis, parameters: &ControlParameters) -> AxisRates {
    AxisRates::new(
        parameters.rapid_rate(axis),
        parameters.rapid_time(axis),
        parameters.feed_limit(),
    )
}
