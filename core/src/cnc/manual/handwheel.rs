//! The handwheel (manual III-6.2): 100 graduations a turn, one increment each.

use crate::cnc::Cnc;
use crate::mode::Mode;
use crate::motion::JogRate;
use crate::operation::Direction;
use crate::units::Axis;

/// The axis follows the wheel by at most the way of so many seconds at rapid.
const LAG_S: f64 = 0.5;

impl Cnc {
    /// The axis stands as soon as it can, however far the wheel was turned.
    pub(crate) fn drop_wheel(&mut self) {
        if self.run.mode.motion() != Mode::Handwheel {
            return;
        }
        for axis in [Axis::X, Axis::Z] {
            if self.drives.interpolator.stepping(axis) {
                self.drives.interpolator.release(axis);
            }
        }
    }

    /// The selected axis follows the wheel, at no more than its rapid rate.
    pub(crate) fn follow_wheel(&mut self, axis: Axis, counts: i32) {
        let rate = JogRate::Feed(self.drives.limits.rapid_rate(axis));
        let rate = self.board_slows(axis, rate);
        self.guide_step(axis, rate);
        if self.plc.signals.wheel_axis != Some(axis) || self.interlocked(axis) {
            return;
        }
        let distance = f64::from(counts) * self.step_distance(axis);
        let Some(way) = Direction::of(distance) else {
            return;
        };
        let rest = self.drives.interpolator.step_rest(axis).unwrap_or(0.0);
        let too_far = (rest + distance).abs() > self.drives.limits.rapid_rate(axis) / 60.0 * LAG_S;
        if self.may_go(axis, way) && !(too_far && Direction::of(rest) == Some(way)) {
            self.drives.interpolator.start_step(axis, distance, rate);
        }
    }
}
