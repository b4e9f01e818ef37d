//! The steps of commissioning, each from its readings to what is to be written
//! (manual III-12.3 to III-12.8).

mod drive;
mod gear;
#[cfg(test)]
mod tests;

use gsk_core::memory::{Parameters, PitchTable, parameter};
use gsk_core::units::Axis;
use gsk_messages::{Message, say};

use crate::change::{Change, Proposal, of};
use crate::measurement::Travel;
use gear::approach;

pub use drive::{DriveKind, Lag, acceleration, largest_lag};
pub use gear::{GearMeasured, gear_from_drive, gear_measured};

/// A step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Step {
    /// Direction of the motors.
    Direction,
    /// Electronic gear.
    Gear,
    /// Rapid rate and acceleration.
    Acceleration,
    /// Machine zero.
    Reference,
    /// Spindle speed.
    Spindle,
    /// Backlash.
    Backlash,
    /// Pitch errors.
    Pitch,
}

impl Step {
    /// All of them, in the order in which they are made: each needs those before it.
    pub const ALL: [Self; 7] = [
        Self::Direction,
        Self::Gear,
        Self::Acceleration,
        Self::Reference,
        Self::Spindle,
        Self::Backlash,
        Self::Pitch,
    ];

    /// Its name.
    pub fn name(self) -> Message {
        match self {
            Self::Direction => say::commission_step_direction(),
            Self::Gear => say::commission_step_gear(),
            Self::Acceleration => say::commission_step_acceleration(),
            Self::Reference => say::commission_step_reference(),
            Self::Spindle => say::commission_step_spindle(),
            Self::Backlash => say::commission_step_backlash(),
            Self::Pitch => say::commission_step_pitch(),
        }
    }

    /// What is done in it, and with which keys.
    pub fn explanation(self) -> Message {
        match self {
            Self::Direction => say::commission_explain_direction(),
            Self::Gear => say::commission_explain_gear(),
            Self::Acceleration => say::commission_explain_acceleration(),
            Self::Reference => say::commission_explain_reference(),
            Self::Spindle => say::commission_explain_spindle(),
            Self::Backlash => say::commission_explain_backlash(),
            Self::Pitch => say::commission_explain_pitch(),
        }
    }
}

fn proposal(
    changes: Vec<Change>,
    notes: Vec<Message>,
    parameters: &Parameters,
) -> Result<Proposal, Message> {
    Proposal::of(changes, notes, parameters, &PitchTable::default())
}

const fn value(number: u16, value: i32) -> Change {
    Change::Value { number, value }
}

const fn bit(number: u16, bit: u8, on: bool) -> Change {
    Change::Bit { number, bit, on }
}

/// The bit of the two that belongs to an axis.
const fn bit_of(axis: Axis) -> u8 {
    match axis {
        Axis::X => 0,
        Axis::Z => 1,
    }
}

/// The slide moved against the key: 008 is turned over.
///
/// # Errors
/// None; the control takes it.
pub fn direction(axis: Axis, parameters: &Parameters) -> Result<Proposal, Message> {
    let on = parameters.bit(8, bit_of(axis));
    let notes = vec![say::commission_power_cycle()];
    proposal(vec![bit(8, bit_of(axis), !on)], notes, parameters)
}

/// How the machine zero is found (manual III-12.6).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ZeroMethod {
    /// A: there is no switch.
    NoSwitch,
    /// B: a switch for deceleration, then the one-turn signal.
    SwitchAndSignal,
    /// C: one proximity switch.
    OneSwitch,
}

/// The parameters of a method, the approach towards plus.
///
/// # Errors
/// None; the control takes them.
pub fn reference(
    axis: Axis,
    method: ZeroMethod,
    parameters: &Parameters,
) -> Result<Proposal, Message> {
    let own = bit_of(axis);
    let changes = match method {
        ZeroMethod::NoSwitch => vec![bit(14, own, false)],
        ZeroMethod::SwitchAndSignal => vec![
            bit(4, 5, false),
            bit(6, own, false),
            bit(7, own, false),
            bit(11, 2, true),
            bit(14, own, true),
            value(parameter::ZERO_LOW_SPEED, 200),
            value(parameter::ZERO_HIGH_SPEED, approach(7600, parameters)),
        ],
        ZeroMethod::OneSwitch => vec![
            bit(4, 5, false),
            bit(6, own, false),
            bit(7, own, true),
            bit(11, 2, false),
            bit(14, own, true),
            value(parameter::ZERO_LOW_SPEED, 200),
            value(parameter::ZERO_HIGH_SPEED, approach(5000, parameters)),
        ],
    };
    let notes = match method {
        ZeroMethod::NoSwitch => vec![say::commission_zero_by_hand()],
        _ => vec![say::commission_zero_dog()],
    };
    proposal(changes, notes, parameters)
}

/// The speed of the spindle at S9999, 10 V.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleSpeed {
    /// The gear, 1 to 4.
    pub gear: u8,
    /// What was read, r/min.
    pub rpm: f64,
    /// What a voltmeter read, V, if it did.
    pub volts: Option<f64>,
}

/// Speed at 10 V of a gear (037–040), and the voltage set right (021).
///
/// # Errors
/// Numbers that are none, a spindle without analog output (001.4 = 0).
pub fn spindle(read: SpindleSpeed, parameters: &Parameters) -> Result<Proposal, Message> {
    if !parameters.analog_spindle() {
        return Err(say::commission_spindle_switched());
    }
    if !(1..=4).contains(&read.gear) || !(1.0..=9999.0).contains(&read.rpm) {
        return Err(say::commission_spindle_numbers());
    }
    let volts = match read.volts {
        Some(volts) if !(1.0..=20.0).contains(&volts) => {
            return Err(say::commission_spindle_volts(volts));
        }
        volts => volts.unwrap_or(10.0),
    };
    let gain = (f64::from(parameters.value(parameter::SPINDLE_GAIN)) * 10.0 / volts).round();
    // With the voltage set right the speed changes with it.
    let rpm = (read.rpm * 10.0 / volts).round();
    let gear = parameter::GEAR_SPEED_1 + u16::from(read.gear) - 1;
    let mut changes = vec![value(gear, rpm as i32)];
    if read.volts.is_some() {
        changes.insert(0, value(parameter::SPINDLE_GAIN, gain as i32));
    }
    proposal(changes, Vec::new(), parameters)
}

/// Readings of the gauge at the same position: approached towards plus, and towards minus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Backlash {
    /// A, after N20, mm of slide travel.
    pub a: Travel,
    /// B, after N40.
    pub b: Travel,
}

/// |A − B| of several readings becomes 034 or 035. What stands there must be 0 while it is
/// measured; without readings that is proposed.
///
/// # Errors
/// A compensation that is in force, readings that differ too much, a play beyond 2 mm.
pub fn backlash(
    axis: Axis,
    readings: &[Backlash],
    parameters: &Parameters,
) -> Result<Proposal, Message> {
    const LARGEST_UM: f64 = 2000.0;
    const SPREAD_UM: f64 = 10.0;
    let number = of(axis, parameter::X_BACKLASH, parameter::Z_BACKLASH);
    if readings.is_empty() {
        let notes = vec![say::commission_backlash_zero(number)];
        return proposal(vec![value(number, 0)], notes, parameters);
    }
    if parameters.value(number) != 0 {
        return Err(say::commission_backlash_not_zero(number));
    }
    let plays: Vec<f64> = readings
        .iter()
        .map(|it| (it.a.0 - it.b.0).abs() * 1000.0)
        .collect();
    let least = plays.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = plays.iter().copied().fold(0.0, f64::max);
    if !largest.is_finite() || largest > LARGEST_UM {
        return Err(say::commission_backlash_large(largest, LARGEST_UM));
    }
    let mean = plays.iter().sum::<f64>() / plays.len() as f64;
    let mut notes = vec![say::commission_backlash_mean(
        plays.len(),
        mean,
        largest - least,
    )];
    if largest - least > SPREAD_UM {
        notes.push(say::commission_backlash_spread());
    }
    let units = mean / 1000.0 / parameters.least_increment();
    proposal(vec![value(number, units.round() as i32)], notes, parameters)
}
