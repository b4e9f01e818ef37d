//! Checks the speed of an axis whose electronic gear multiplies: alarm 097 (manual
//! III-12.4).

use crate::alarm::{Alarm, number};
use crate::motion::MotionLimits;
use crate::units::Point;
use gsk_messages::say;

/// Returns alarm 097 as error if an axis is faster than its gear allows; speeds in
/// mm/min.
pub(crate) fn check_gear_speed(limits: &MotionLimits, speed: Point) -> Result<(), Alarm> {
    let Some((axis, limit)) = limits.exceeded_gear_limit(speed) else {
        return Ok(());
    };
    let axis_speed = speed.get(axis).abs();
    Err(Alarm::new(number::GEAR_SPEED)
        .with_detail(say::gear_speed_too_great(axis, axis_speed, limit)))
}
