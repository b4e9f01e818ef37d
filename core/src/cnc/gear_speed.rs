//! Checks alarm 097: an electronic gear that multiplies lowers the highest speed of its
//! axis (manual III-12.4).

use crate::alarm::Alarm;
use crate::cnc::Cnc;
use crate::command::MoveKind;
use crate::motion::top_speed;
use crate::operation::check_gear_speed;
use crate::units::{Axis, Feed, Point, percent_to_factor};

impl Cnc {
    /// Returns alarm 097 as error if a rapid or a cut to `to`, mm, would exceed the gear speed of
    /// an axis at the current overrides.
    pub(crate) fn check_gear_before_move(
        &self,
        kind: MoveKind,
        to: Point,
        feed: Feed,
    ) -> Result<(), Alarm> {
        if !self.drives.limits.gear_limits_speed() {
            return Ok(());
        }
        let per_minute = match feed {
            Feed::PerMinute(rate) => rate,
            Feed::PerRevolution(rate) => rate * self.spindle.control.actual_rpm().abs(),
        };
        let displacement = to - self.drives.interpolator.commanded();
        let feed = per_minute * self.feed_override_factor();
        let mut top = top_speed(kind, displacement, feed, &self.drives.limits);
        if kind == MoveKind::Rapid {
            let factor = percent_to_factor(self.plc.signals.rapid_override);
            let limit_rapid = |axis| {
                top.get(axis)
                    .min(self.drives.limits.rapid_rate(axis) * factor)
            };
            top = Point::new(limit_rapid(Axis::X), limit_rapid(Axis::Z));
        }
        check_gear_speed(&self.drives.limits, top)
    }

    /// Raises alarm 097 if an axis exceeded its gear speed in the last tick.
    pub(crate) fn check_gear_speed_of_tick(&mut self) {
        if !self.drives.limits.gear_limits_speed() {
            return;
        }
        let speed = self.drives.interpolator.velocity() * 60.0;
        let Err(alarm) = check_gear_speed(&self.drives.limits, speed) else {
            return;
        };
        self.drives.interpolator.decelerate();
        let alarm = match &self.run.automatic.current {
            Some(current) => alarm.with_source(current.command.source),
            None => alarm,
        };
        self.raise(alarm);
    }
}
