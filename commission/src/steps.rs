//! Commissioning steps: each converts its readings to parameter changes (manual III-12.3 to
//! III-12.8).

mod drive;
mod gear;
#[cfg(test)]
mod tests;

use gsk_core::memory::{ControlParameters, PitchTable, parameter};
use gsk_core::units::Axis;
use gsk_messages::{Message, say};

use crate::measurement::SlideTravel;
use crate::parameter_change::{ParameterChange, Proposal, select_by_axis};
use gear::limit_approach_rate;

pub use drive::{DriveKind, FollowingErrorReading, propose_acceleration, propose_rapid_rate};
pub use gear::{MeasuredMove, propose_gear_from_drive, propose_gear_from_move};

/// A step of commissioning a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum CommissioningStep {
    /// Sets the direction in which the motors turn.
    Direction,
    /// Sets the electronic gear.
    Gear,
    /// Sets rapid rate and acceleration.
    Acceleration,
    /// Sets the method of the reference return to the machine zero.
    Reference,
    /// Sets the spindle speed at the full output voltage.
    Spindle,
    /// Measures the backlash.
    Backlash,
    /// Compensates pitch errors.
    Pitch,
}

impl CommissioningStep {
    /// All steps in the order of commissioning. Each step relies on those before it.
    pub const ALL: [Self; 7] = [
        Self::Direction,
        Self::Gear,
        Self::Acceleration,
        Self::Reference,
        Self::Spindle,
        Self::Backlash,
        Self::Pitch,
    ];

    /// Returns the message with the title of the step.
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

    /// Returns the message with the step's instruction to the operator, with the keys to
    /// press.
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

fn build_proposal(
    changes: Vec<ParameterChange>,
    notes: Vec<Message>,
    parameters: &ControlParameters,
) -> Result<Proposal, Message> {
    Proposal::from_changes(changes, notes, parameters, &PitchTable::default())
}

const fn set_value(number: u16, value: i32) -> ParameterChange {
    ParameterChange::Value { number, value }
}

const fn set_bit(number: u16, bit: u8, on: bool) -> ParameterChange {
    ParameterChange::Bit { number, bit, on }
}

const fn axis_bit(axis: Axis) -> u8 {
    match axis {
        Axis::X => 0,
        Axis::Z => 1,
    }
}

/// Proposes to reverse the motor direction of an axis (parameter 008).
///
/// # Errors
/// Never fails in practice: the control accepts both states.
pub fn propose_direction(axis: Axis, parameters: &ControlParameters) -> Result<Proposal, Message> {
    let on = parameters.bit(8, axis_bit(axis));
    let notes = vec![say::commission_power_cycle()];
    build_proposal(vec![set_bit(8, axis_bit(axis), !on)], notes, parameters)
}

/// Method by which the reference return finds the machine zero (manual III-12.6).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ZeroMethod {
    /// Method A: the axis has no switch.
    NoSwitch,
    /// Method B: a deceleration switch, then the motor's one-turn signal.
    SwitchAndSignal,
    /// Method C: one proximity switch alone.
    OneSwitch,
}

/// Proposes the parameters of a reference return method, with the approach towards plus.
///
/// # Errors
/// Never fails in practice: the control accepts the values.
pub fn propose_reference(
    axis: Axis,
    method: ZeroMethod,
    parameters: &ControlParameters,
) -> Result<Proposal, Message> {
    let axis_bit_number = axis_bit(axis);
    let changes = match method {
        ZeroMethod::NoSwitch => vec![set_bit(14, axis_bit_number, false)],
        ZeroMethod::SwitchAndSignal => vec![
            set_bit(4, 5, false),
            set_bit(6, axis_bit_number, false),
            set_bit(7, axis_bit_number, false),
            set_bit(11, 2, true),
            set_bit(14, axis_bit_number, true),
            set_value(parameter::ZERO_LOW_SPEED, 200),
            set_value(
                parameter::ZERO_HIGH_SPEED,
                limit_approach_rate(7600, parameters),
            ),
        ],
        ZeroMethod::OneSwitch => vec![
            set_bit(4, 5, false),
            set_bit(6, axis_bit_number, false),
            set_bit(7, axis_bit_number, true),
            set_bit(11, 2, false),
            set_bit(14, axis_bit_number, true),
            set_value(parameter::ZERO_LOW_SPEED, 200),
            set_value(
                parameter::ZERO_HIGH_SPEED,
                limit_approach_rate(5000, parameters),
            ),
        ],
    };
    let notes = match method {
        ZeroMethod::NoSwitch => vec![say::commission_zero_by_hand()],
        _ => vec![say::commission_zero_dog()],
    };
    build_proposal(changes, notes, parameters)
}

/// Measured spindle speed at S9999, where the control outputs 10 V.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleSpeed {
    /// Number of the spindle gear, 1 to 4.
    pub gear: u8,
    /// Measured spindle speed, r/min.
    pub rpm: f64,
    /// Measured output voltage, V; `None` if it was not measured.
    pub volts: Option<f64>,
}

/// Proposes the spindle speed at 10 V of a gear (037 to 040) and, with a measured voltage, the
/// output gain (021).
///
/// # Errors
/// A value out of range (gear 1 to 4, 1 to 9999 r/min, 1 to 20 V), or a spindle without analog
/// output (001.4 = 0).
pub fn propose_spindle(
    read: SpindleSpeed,
    parameters: &ControlParameters,
) -> Result<Proposal, Message> {
    if !parameters.has_analog_spindle() {
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
    // The corrected voltage changes the speed in proportion.
    let rpm = (read.rpm * 10.0 / volts).round();
    let gear = parameter::GEAR_SPEED_1 + u16::from(read.gear) - 1;
    let mut changes = vec![set_value(gear, rpm as i32)];
    if read.volts.is_some() {
        changes.insert(0, set_value(parameter::SPINDLE_GAIN, gain as i32));
    }
    build_proposal(changes, Vec::new(), parameters)
}

/// Two gauge readings at the same position: approached towards plus and towards minus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BacklashReading {
    /// Reading A of the manual, after block N20, mm of slide travel.
    pub a: SlideTravel,
    /// Reading B of the manual, after block N40, mm of slide travel.
    pub b: SlideTravel,
}

/// Proposes the mean of |A − B| as backlash (034 or 035). The parameter must be 0 during the
/// measurement; without readings the proposal sets it to 0.
///
/// # Errors
/// A backlash parameter that is not 0, or a backlash above 2 mm.
pub fn propose_backlash(
    axis: Axis,
    readings: &[BacklashReading],
    parameters: &ControlParameters,
) -> Result<Proposal, Message> {
    const LARGEST_UM: f64 = 2000.0;
    const SPREAD_UM: f64 = 10.0;
    let number = select_by_axis(axis, parameter::X_BACKLASH, parameter::Z_BACKLASH);
    if readings.is_empty() {
        let notes = vec![say::commission_backlash_zero(number)];
        return build_proposal(vec![set_value(number, 0)], notes, parameters);
    }
    if parameters.value(number) != 0 {
        return Err(say::commission_backlash_not_zero(number));
    }
    let backlashes_um: Vec<f64> = readings
        .iter()
        .map(|it| (it.a.0 - it.b.0).abs() * 1000.0)
        .collect();
    let smallest = backlashes_um.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = backlashes_um.iter().copied().fold(0.0, f64::max);
    if !largest.is_finite() || largest > LARGEST_UM {
        return Err(say::commission_backlash_large(largest, LARGEST_UM));
    }
    let mean = backlashes_um.iter().sum::<f64>() / backlashes_um.len() as f64;
    let mut notes = vec![say::commission_backlash_mean(
        backlashes_um.len(),
        mean,
        largest - smallest,
    )];
    if largest - smallest > SPREAD_UM {
        notes.push(say::commission_backlash_spread());
    }
    let units = mean / 1000.0 / parameters.least_increment_mm();
    build_proposal(
        vec![set_value(number, units.round() as i32)],
        notes,
        parameters,
    )
}
