//! The handwheel (manual III-6.2): 100 graduations per turn, one increment each.

use crate::cnc::Cnc;
use crate::mode::OperatingMode;
use crate::motion::JogRate;
use crate::operation::AxisDirection;
use crate::units::Axis;

/// Greatest lag of the axis after the handwheel, as the duration of that distance at the rapid
/// rate, s.
const LAG_S: f64 = 0.5;

impl Cnc {
    /// Drops the motion commanded by the handwheel that the axes have not made yet; they
    /// decelerate.
    pub(crate) fn drop_wheel(&mut self) {
        self.drop_retrace_turns();
        if self.run.mode.motion_mode() != OperatingMode::Handwheel {
            return;
        }
        for axis in [Axis::X, Axis::Z] {
            if self.drives.interpolator.is_stepping(axis) {
                self.drives.interpolator.release_axis(axis);
            }
        }
    }

    /// Moves `axis` by `counts` graduations of the handwheel, at its rapid rate at most, if the
    /// handwheel is assigned to it.
    pub(crate) fn follow_wheel(&mut self, axis: Axis, counts: i32) {
        let rate = JogRate::Feed(self.drives.limits.rapid_rate(axis));
        let rate = self.limit_manual_rate(axis, rate);
        self.control_step(axis, rate);
        if self.plc.signals.wheel_axis != Some(axis) || self.is_interlocked(axis) {
            return;
        }
        let distance = f64::from(counts) * self.step_distance(axis);
        let Some(direction) = AxisDirection::from_distance(distance) else {
            return;
        };
        let distance_to_go = self
            .drives
            .interpolator
            .step_distance_to_go(axis)
            .unwrap_or(0.0);
        let too_far =
            (distance_to_go + distance).abs() > self.drives.limits.rapid_rate(axis) / 60.0 * LAG_S;
        if self.can_move(axis, direction)
            && !(too_far && AxisDirection::from_distance(distance_to_go) == Some(direction))
        {
            self.drives.interpolator.start_step(axis, distance, rate);
        }
    }
}
