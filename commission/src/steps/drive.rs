//! Proposes rapid rates and accelerations for the drives, also from the following error (manual
//! III-12.5).

use gsk_core::axis::gear_speed_limit;
use gsk_core::memory::{ControlParameters, parameter};
use gsk_core::units::Axis;
use gsk_messages::{Message, say};

use super::{build_proposal, set_bit, set_value};
use crate::measurement::SlideTravel;
use crate::parameter_change::{ParameterChange, Proposal, select_by_axis};

/// Type of the motors that drive the axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveKind {
    /// The axes have stepping motors.
    Stepper,
    /// The axes have servo motors.
    Servo,
}

/// Proposes rapid rates and acceleration times for a type of drive (manual III-12.5). Values
/// within the limits of the manual stay.
///
/// # Errors
/// Never fails in practice: the control accepts the values.
pub fn propose_acceleration(
    kind: DriveKind,
    parameters: &ControlParameters,
) -> Result<Proposal, Message> {
    let at_most = |number, limit| set_value(number, parameters.value(number).min(limit));
    let at_least = |number, limit| set_value(number, parameters.value(number).max(limit));
    let changes = match kind {
        DriveKind::Stepper => vec![
            at_most(parameter::X_RAPID, 2500),
            at_most(parameter::Z_RAPID, 5000),
            at_least(parameter::X_RAPID_TIME, 450),
            at_least(parameter::Z_RAPID_TIME, 450),
            at_least(parameter::THREAD_TIME, 250),
            at_most(parameter::THREAD_LOW_SPEED, 50),
            at_least(parameter::FEED_TIME, 250),
            at_most(parameter::FEED_LOW_SPEED, 50),
            set_bit(7, 3, true),
        ],
        DriveKind::Servo => vec![
            set_value(parameter::X_RAPID, 3800),
            set_value(parameter::Z_RAPID, 7600),
            at_most(parameter::X_RAPID_TIME, 50),
            at_most(parameter::Z_RAPID_TIME, 50),
            at_most(parameter::THREAD_TIME, 50),
            at_most(parameter::THREAD_LOW_SPEED, 500),
            at_most(parameter::FEED_TIME, 50),
            at_most(parameter::FEED_LOW_SPEED, 500),
        ],
    };
    // If the gear multiplies pulses, the pulse frequency limits the rapid rate.
    let limit_to_gear = |change: ParameterChange| match change {
        ParameterChange::Value {
            number,
            value: rate,
        } if [parameter::X_RAPID, parameter::Z_RAPID].contains(&number) => {
            let axis = if number == parameter::X_RAPID {
                Axis::X
            } else {
                Axis::Z
            };
            let limit = gear_speed_limit(axis, parameters).map_or(rate, |it| it.floor() as i32);
            set_value(number, rate.min(limit))
        }
        other => other,
    };
    let changes = changes.into_iter().map(limit_to_gear).collect();
    build_proposal(changes, Vec::new(), parameters)
}

/// Largest following error that was measured in a rapid move, and its limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FollowingErrorReading {
    /// Measured following error, mm of slide travel.
    pub measured: SlideTravel,
    /// Limit of the drive, mm of slide travel.
    pub allowed: SlideTravel,
}

/// Fraction of the allowed following error that a rapid move may use.
const USABLE_SHARE: f64 = 0.8;

/// Proposes a rapid rate that keeps a fifth of the allowed following error in reserve. The
/// following error is proportional to the rate.
///
/// # Errors
/// Returns a message if a value is not a finite number above 0.
pub fn propose_rapid_rate(
    axis: Axis,
    following_error: FollowingErrorReading,
    parameters: &ControlParameters,
) -> Result<Proposal, Message> {
    let (measured, allowed) = (following_error.measured.0.abs(), following_error.allowed.0);
    if !(measured.is_finite() && allowed.is_finite() && measured > 0.0 && allowed > 0.0) {
        return Err(say::commission_lag_numbers());
    }
    let rate = parameters.rapid_rate(axis);
    let gain = rate / 60.0 / measured;
    let mut notes = vec![say::commission_lag(measured, allowed, gain)];
    let max_rate = rate * USABLE_SHARE * allowed / measured;
    let mut changes = Vec::new();
    if max_rate < rate {
        let min_rate = 6.0;
        changes.push(set_value(
            select_by_axis(axis, parameter::X_RAPID, parameter::Z_RAPID),
            max_rate.floor().max(min_rate) as i32,
        ));
    } else {
        notes.push(say::commission_lag_fine());
    }
    build_proposal(changes, notes, parameters)
}
