//! The electronic gear, from the plates of a drive or from a measured move (manual III-12.3).

use gsk_core::axis::{gear_speed_limit, pulse_weight};
use gsk_core::memory::{Parameters, PitchTable, parameter};
use gsk_core::units::Axis;
use gsk_messages::{Message, say};

use super::{proposal, value};
use crate::change::{Proposal, name, of};
use crate::gear::{Drive, nearest_ratio};
use crate::measurement::Travel;

/// What was commanded, and what the slide made of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GearMeasured {
    /// Commanded slide travel, mm; X in radius.
    pub commanded: Travel,
    /// Measured slide travel.
    pub measured: Travel,
}

/// The gear of an axis from the plates of its drive.
///
/// # Errors
/// Numbers that are none, a ratio out of reach.
pub fn gear_from_drive(
    axis: Axis,
    drive: &Drive,
    parameters: &Parameters,
) -> Result<Proposal, Message> {
    let (multiply, divide) = parameters.gear(axis);
    let increment = pulse_weight(axis, parameters) * f64::from(multiply) / f64::from(divide);
    gear(axis, drive.ratio(Travel(increment))?, 0.0, parameters)
}

/// What the lead of a screw, and a measurement of it, may be off: a ratio of small numbers
/// within that is the one the wheels have (decision COMMISSION-2).
const LEAD_TOLERANCE: f64 = 200e-6;

/// The gear of an axis from a long move.
///
/// # Errors
/// A measurement that cannot be, a ratio out of reach.
pub fn gear_measured(
    axis: Axis,
    made: GearMeasured,
    parameters: &Parameters,
) -> Result<Proposal, Message> {
    let (commanded, measured) = (made.commanded.0, made.measured.0);
    if !(commanded.is_finite() && measured.is_finite()) || commanded.abs() < 1.0 {
        return Err(say::commission_move_short());
    }
    if measured == 0.0 || (commanded > 0.0) != (measured > 0.0) {
        return Err(say::commission_move_reversed(name(axis)));
    }
    let (multiply, divide) = parameters.gear(axis);
    let stands = f64::from(multiply) / f64::from(divide);
    gear(
        axis,
        stands * commanded / measured,
        LEAD_TOLERANCE,
        parameters,
    )
}

fn gear(
    axis: Axis,
    wanted: f64,
    tolerance: f64,
    parameters: &Parameters,
) -> Result<Proposal, Message> {
    let ratio = nearest_ratio(wanted, tolerance)?;
    let mut changes = vec![
        value(
            of(axis, parameter::X_MULTIPLIER, parameter::Z_MULTIPLIER),
            ratio.multiply,
        ),
        value(
            of(axis, parameter::X_DIVISOR, parameter::Z_DIVISOR),
            ratio.divide,
        ),
    ];
    let mut notes = vec![say::commission_gear_off(
        ratio.multiply,
        ratio.divide,
        ratio.off,
    )];
    let mut then = parameters.clone();
    let mut none = PitchTable::default();
    for change in &changes {
        change.apply(&mut then, &mut none)?;
    }
    if let Some(limit) = gear_speed_limit(axis, &then) {
        let approach = approach_limit(axis, limit);
        let rapid = of(axis, parameter::X_RAPID, parameter::Z_RAPID);
        for (number, most) in [(rapid, limit), (parameter::ZERO_HIGH_SPEED, approach)] {
            if f64::from(parameters.value(number)) > most {
                changes.push(value(number, most.floor() as i32));
            }
        }
        notes.push(say::commission_gear_slow(name(axis), limit.floor()));
    }
    notes.push(say::pitch_zero_return_needed());
    proposal(changes, notes, parameters)
}

/// The largest rate of the approach (113) for the largest rate of an axis: it is halved for X.
const fn approach_limit(axis: Axis, limit: f64) -> f64 {
    match axis {
        Axis::X => 2.0 * limit,
        Axis::Z => limit,
    }
}

/// A rate of the approach that neither axis is too slow for: 113 is that of both.
pub(super) fn approach(wanted: i32, parameters: &Parameters) -> i32 {
    let limits = [Axis::X, Axis::Z].into_iter().filter_map(|axis| {
        let limit = gear_speed_limit(axis, parameters)?;
        Some(approach_limit(axis, limit).floor() as i32)
    });
    limits.fold(wanted, i32::min)
}
