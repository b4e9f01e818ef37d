//! Alarm 097: an electronic gear that multiplies lowers the highest speed of its axis
//! (manual III-12.4).

use crate::alarm::Alarm;
use crate::cnc::Cnc;
use crate::command::MoveKind;
use crate::motion::{MotionLimits, top_speed};
use crate::units::{Axis, Feed, Point};

impl Cnc {
    /// Before a rapid or a cut: at the overrides as they are.
    pub(super) fn check_gear_before(
        &self,
        kind: MoveKind,
        to: Point,
        feed: Feed,
    ) -> Result<(), Alarm> {
        if !self.limits.gear_limits_speed() {
            return Ok(());
        }
        let per_minute = match feed {
            Feed::PerMinute(rate) => rate,
            Feed::PerRevolution(rate) => rate * self.spindle.actual_rpm().abs(),
        };
        let way = to - self.interpolator.commanded();
        let feed = per_minute * self.feed_override_factor();
        let mut top = top_speed(kind, way, feed, &self.limits);
        if kind == MoveKind::Rapid {
            let part = f64::from(self.from_plc.rapid_override) / 100.0;
            let at_most = |axis| top.get(axis).min(self.limits.rapid_rate(axis) * part);
            top = Point::new(at_most(Axis::X), at_most(Axis::Z));
        }
        check_gear_speed(&self.limits, top)
    }

    /// Watches the speed of the last tick.
    pub(crate) fn watch_gear_speed(&mut self) {
        if !self.limits.gear_limits_speed() {
            return;
        }
        let speed = self.interpolator.velocity() * 60.0;
        let Err(alarm) = check_gear_speed(&self.limits, speed) else {
            return;
        };
        self.interpolator.decelerate();
        let alarm = match &self.automatic.current {
            Some(current) => alarm.at(current.command.source),
            None => alarm,
        };
        self.raise(alarm);
    }
}

/// Alarm 097 if an axis is faster than its gear allows; speeds in mm/min.
pub(crate) fn check_gear_speed(limits: &MotionLimits, speed: Point) -> Result<(), Alarm> {
    let Some((axis, limit)) = limits.too_fast_for_gear(speed) else {
        return Ok(());
    };
    let made = speed.get(axis).abs();
    Err(Alarm::new(97).because(format!(
        "{axis:?} at {made:.0} mm/min, its electronic gear allows {limit:.0}"
    )))
}
