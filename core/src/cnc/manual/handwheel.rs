//! The handwheel (manual III-6.2): 100 graduations per turn, one increment each.

use crate::cnc::Cnc;
use crate::mode::Mode;
use crate::motion::JogRate;
use crate::operation::Direction;
use crate::units::Axis;

/// Greatest lag of the axis after the wheel, s of motion at rapid.
const LAG_S: f64 = 0.5;

impl Cnc {
    /// Stops the axis as soon as possible and drops the rest of the handwheel's motion.
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

    /// Lets the selected axis follow the wheel, at most at its rapid rate.
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
