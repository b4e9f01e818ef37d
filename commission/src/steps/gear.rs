//! Proposes the electronic gear from nameplates or from a measured move (manual III-12.3).

use gsk_core::axis::{gear_speed_limit, pulse_weight};
use gsk_core::memory::{ControlParameters, PitchTable, parameter};
use gsk_core::units::Axis;
use gsk_messages::{Message, say};

use super::{build_proposal, set_value};
use crate::gear_ratio::{DriveTrain, find_nearest_ratio};
use crate::measurement::SlideTravel;
use crate::parameter_change::{Proposal, axis_letter, select_by_axis};

/// A commanded move of a slide, and the slide travel that was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredMove {
    /// Commanded slide travel, mm; X as a radius.
    pub commanded: SlideTravel,
    /// Measured slide travel, mm; X as a radius.
    pub measured: SlideTravel,
}

/// Proposes the electronic gear of an axis from the nameplates of its drive.
///
/// # Errors
/// Returns a message for a nameplate value that is not above 0, or a ratio outside 1/127 to
/// 127.
pub fn propose_gear_from_drive(
    axis: Axis,
    drive: &DriveTrain,
    parameters: &ControlParameters,
) -> Result<Proposal, Message> {
    let (multiply, divide) = parameters.gear(axis);
    let increment = pulse_weight(axis, parameters) * f64::from(multiply) / f64::from(divide);
    propose_gear(
        axis,
        drive.gear_ratio(SlideTravel(increment))?,
        0.0,
        parameters,
    )
}

/// Relative error that a screw lead and its measurement may have. A ratio of small numbers
/// within it is taken as the true one (decision COMMISSION-2).
const LEAD_TOLERANCE: f64 = 200e-6;

/// Proposes the electronic gear of an axis from a long measured move.
///
/// # Errors
/// Returns a message for a commanded move below 1 mm, a measured move in the other direction,
/// or a ratio outside 1/127 to 127.
pub fn propose_gear_from_move(
    axis: Axis,
    slide_move: MeasuredMove,
    parameters: &ControlParameters,
) -> Result<Proposal, Message> {
    let (commanded, measured) = (slide_move.commanded.0, slide_move.measured.0);
    if !(commanded.is_finite() && measured.is_finite()) || commanded.abs() < 1.0 {
        return Err(say::commission_move_short());
    }
    if measured == 0.0 || (commanded > 0.0) != (measured > 0.0) {
        return Err(say::commission_move_reversed(axis_letter(axis)));
    }
    let (multiply, divide) = parameters.gear(axis);
    let current_ratio = f64::from(multiply) / f64::from(divide);
    propose_gear(
        axis,
        current_ratio * commanded / measured,
        LEAD_TOLERANCE,
        parameters,
    )
}

fn propose_gear(
    axis: Axis,
    target_ratio: f64,
    tolerance: f64,
    parameters: &ControlParameters,
) -> Result<Proposal, Message> {
    let ratio = find_nearest_ratio(target_ratio, tolerance)?;
    let mut changes = vec![
        set_value(
            select_by_axis(axis, parameter::X_MULTIPLIER, parameter::Z_MULTIPLIER),
            ratio.multiply,
        ),
        set_value(
            select_by_axis(axis, parameter::X_DIVISOR, parameter::Z_DIVISOR),
            ratio.divide,
        ),
    ];
    let mut notes = vec![say::commission_gear_off(
        ratio.multiply,
        ratio.divide,
        ratio.error_um_per_m,
    )];
    let mut changed = parameters.clone();
    let mut empty = PitchTable::default();
    for change in &changes {
        change.apply(&mut changed, &mut empty)?;
    }
    if let Some(limit) = gear_speed_limit(axis, &changed) {
        let approach = max_approach_rate(axis, limit);
        let rapid = select_by_axis(axis, parameter::X_RAPID, parameter::Z_RAPID);
        for (number, max_rate) in [(rapid, limit), (parameter::ZERO_HIGH_SPEED, approach)] {
            if f64::from(parameters.value(number)) > max_rate {
                changes.push(set_value(number, max_rate.floor() as i32));
            }
        }
        notes.push(say::commission_gear_slow(axis_letter(axis), limit.floor()));
    }
    notes.push(say::pitch_zero_return_needed());
    build_proposal(changes, notes, parameters)
}

/// Returns the largest approach rate (113) at which an axis stays within its rate `limit`. The
/// control halves 113 for X.
const fn max_approach_rate(axis: Axis, limit: f64) -> f64 {
    match axis {
        Axis::X => 2.0 * limit,
        Axis::Z => limit,
    }
}

/// Limits an approach rate to what the gears of both axes permit: parameter 113 applies to
/// both.
pub(super) fn limit_approach_rate(requested_rate: i32, parameters: &ControlParameters) -> i32 {
    let limits = [Axis::X, Axis::Z].into_iter().filter_map(|axis| {
        let limit = gear_speed_limit(axis, parameters)?;
        Some(max_approach_rate(axis, limit).floor() as i32)
    });
    limits.fold(requested_rate, i32::min)
}
