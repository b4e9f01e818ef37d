//! Rates and acceleration that suit the drives, and what their following error allows
//! (manual III-12.5).

use gsk_core::axis::gear_speed_limit;
use gsk_core::memory::{Parameters, parameter};
use gsk_core::units::Axis;
use gsk_messages::{Message, say};

use super::{bit, proposal, value};
use crate::change::{Change, Proposal, of};
use crate::measurement::Travel;

/// The kind of the drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveKind {
    /// Stepping motors.
    Stepper,
    /// Servo motors.
    Servo,
}

/// Rates and acceleration that suit the drives (manual III-12.5). What is within the limits
/// of the manual stays.
///
/// # Errors
/// None; the control takes them.
pub fn acceleration(kind: DriveKind, parameters: &Parameters) -> Result<Proposal, Message> {
    let at_most = |number, limit| value(number, parameters.value(number).min(limit));
    let at_least = |number, limit| value(number, parameters.value(number).max(limit));
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
            bit(7, 3, true),
        ],
        DriveKind::Servo => vec![
            value(parameter::X_RAPID, 3800),
            value(parameter::Z_RAPID, 7600),
            at_most(parameter::X_RAPID_TIME, 50),
            at_most(parameter::Z_RAPID_TIME, 50),
            at_most(parameter::THREAD_TIME, 50),
            at_most(parameter::THREAD_LOW_SPEED, 500),
            at_most(parameter::FEED_TIME, 50),
            at_most(parameter::FEED_LOW_SPEED, 500),
        ],
    };
    // With a gear that multiplies the pulses set the limit.
    let capped = |change: Change| match change {
        Change::Value {
            number,
            value: rate,
        } if [parameter::X_RAPID, parameter::Z_RAPID].contains(&number) => {
            let axis = if number == parameter::X_RAPID {
                Axis::X
            } else {
                Axis::Z
            };
            let limit = gear_speed_limit(axis, parameters).map_or(rate, |it| it.floor() as i32);
            value(number, rate.min(limit))
        }
        other => other,
    };
    let changes = changes.into_iter().map(capped).collect();
    proposal(changes, Vec::new(), parameters)
}

/// The largest following error that was seen in a rapid move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag {
    /// What was seen, mm of slide travel.
    pub seen: Travel,
    /// What the drive allows.
    pub allowed: Travel,
}

/// The part of the allowed following error that a rapid move may use.
const LAG_SHARE: f64 = 0.8;

/// A rapid rate for which the following error keeps a fifth of what is allowed in reserve:
/// it grows as the rate does.
///
/// # Errors
/// Numbers that are none.
pub fn largest_lag(axis: Axis, lag: Lag, parameters: &Parameters) -> Result<Proposal, Message> {
    let (seen, allowed) = (lag.seen.0.abs(), lag.allowed.0);
    if !(seen.is_finite() && allowed.is_finite() && seen > 0.0 && allowed > 0.0) {
        return Err(say::commission_lag_numbers());
    }
    let rate = parameters.rapid_rate(axis);
    let gain = rate / 60.0 / seen;
    let mut notes = vec![say::commission_lag(seen, allowed, gain)];
    let most = rate * LAG_SHARE * allowed / seen;
    let mut changes = Vec::new();
    if most < rate {
        let least = 6.0;
        changes.push(value(
            of(axis, parameter::X_RAPID, parameter::Z_RAPID),
            most.floor().max(least) as i32,
        ));
    } else {
        notes.push(say::commission_lag_fine());
    }
    proposal(changes, notes, parameters)
}
