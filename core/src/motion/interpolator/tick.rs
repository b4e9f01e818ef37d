//! One tick of the interpolator: programmed motion and manual motion.

use super::{Interpolator, ProgrammedMotion};
use crate::motion::inputs::{MotionInputs, cutting_target, rapid_rate, rapid_targets};
use crate::motion::limits::MotionLimits;
use crate::motion::path::CutPath;
use crate::motion::ramp::Ramp;
use crate::motion::spindle_follower::SpindleTick;
use crate::units::{Axis, Feed, Point, TICK_S};

impl Interpolator {
    /// Advances by one tick (1 ms) and returns the new position of the tool, mm.
    pub fn tick(&mut self, limits: &MotionLimits, inputs: &MotionInputs) -> Point {
        self.is_guided = false;
        self.tick_start = self.position;
        let time = TICK_S + core::mem::take(&mut self.leftover_s);
        if self.is_finished() {
            if let Some(handover) = &mut self.handover {
                handover.stop();
            }
            if !self.lag.is_zero() {
                let command = self.commanded();
                self.lag.close_lag(limits.cutting_law(), TICK_S);
                self.position = command - self.lag.vector;
            }
            self.advance_manual(limits, inputs);
        } else {
            self.advance_programmed(limits, inputs, time);
        }
        self.position
    }

    /// Advances by one tick to a position on a path that is planned elsewhere, mm. No other
    /// motion may be under way.
    pub(crate) fn guide(&mut self, to: Point) {
        self.tick_start = core::mem::replace(&mut self.position, to);
        self.leftover_s = 0.0;
        self.is_guided = self.position != self.tick_start;
    }

    /// Continues the tick with the block that was started after the last one had ended, in the time
    /// that remains of the tick. Returns the new position of the tool, mm.
    pub(crate) fn continue_tick(&mut self, limits: &MotionLimits, inputs: &MotionInputs) -> Point {
        if !self.is_finished() && self.leftover_s > 0.0 {
            let time = core::mem::take(&mut self.leftover_s);
            self.advance_programmed(limits, inputs, time);
        }
        self.position
    }

    fn advance_manual(&mut self, limits: &MotionLimits, inputs: &MotionInputs) {
        self.stopping = false;
        for axis in [Axis::X, Axis::Z] {
            if self.manual.get(axis).is_idle() {
                continue;
            }
            let rapid = rapid_rate(limits, inputs.rapid_override, axis);
            let at = self.position.get_mut(axis);
            *at = self
                .manual
                .get_mut(axis)
                .advance(axis, *at, limits, rapid, TICK_S);
        }
    }

    /// Turns a thread or tap that must stop into a cut that brakes along its line, without
    /// the spindle.
    fn leave_spindle(&mut self, limits: &MotionLimits) {
        let (to, can_end) = match &self.motion {
            ProgrammedMotion::Thread(thread) => (thread.to(), true),
            ProgrammedMotion::Tap(tap) => (tap.to(), false),
            _ => return,
        };
        let speed = self.velocity().length();
        let braking_vector = self.stopping_point(limits) - self.position;
        let distance_to_end = (to - self.position).length();
        let beyond = 1.0 + 1e-3 / braking_vector.length().max(1e-9);
        let end = if can_end && braking_vector.length() >= distance_to_end {
            to
        } else {
            self.position + braking_vector * beyond
        };
        let path = CutPath::line(self.position, end);
        self.motion = ProgrammedMotion::Cut {
            path,
            ramp: Ramp {
                speed,
                remaining: path.length(),
            },
            feed: Feed::PerMinute(0.0),
        };
    }

    /// Lets the command of a cut that begins run ahead of the tool, unless exact corners
    /// are on (007.3).
    fn start_lagged_cut(&mut self, limits: &MotionLimits) {
        let ProgrammedMotion::Cut { path, ramp, feed } = self.motion else {
            return;
        };
        let is_at_start = ramp == Ramp::new(path.length());
        if is_at_start && !(limits.has_exact_corners() && self.lag.is_zero()) {
            let remaining = path.length();
            self.motion = ProgrammedMotion::LaggedCut {
                path,
                remaining,
                feed,
            };
        }
    }

    fn advance_programmed(&mut self, limits: &MotionLimits, inputs: &MotionInputs, time: f64) {
        if self.stopping {
            self.leave_spindle(limits);
        }
        let spindle_tick = || SpindleTick {
            limits,
            spindle: &inputs.spindle,
            rpm: inputs.spindle_rpm,
            is_held: inputs.hold,
            continues: inputs.thread_continues,
        };
        let dry_changes = inputs.dry_run.is_some() != self.is_dry_run;
        let stop = inputs.hold || self.stopping || (dry_changes && self.is_moving());
        if !stop {
            self.is_dry_run = inputs.dry_run.is_some();
        }
        self.start_lagged_cut(limits);
        let used = match &mut self.motion {
            ProgrammedMotion::None => return,
            ProgrammedMotion::Rapid(rapid) => {
                let used = rapid.advance(limits, rapid_targets(limits, inputs, stop), time);
                self.position = rapid.position();
                rapid.is_finished().then_some(used)
            }
            ProgrammedMotion::StraightRapid(rapid) => {
                let used = rapid.advance(limits, rapid_targets(limits, inputs, stop), time);
                self.position = rapid.position();
                rapid.is_finished().then_some(used)
            }
            ProgrammedMotion::Cut { path, ramp, feed } => {
                let target = if stop {
                    0.0
                } else {
                    cutting_target(limits, inputs, *feed)
                };
                let used = ramp.advance(limits.cutting_law(), target, time).used_s;
                self.position = path.point_at(ramp.remaining);
                ramp.is_finished().then_some(used)
            }
            ProgrammedMotion::LaggedCut {
                path,
                remaining: rest,
                feed,
            } => {
                let law = limits.cutting_law();
                let before = path.point_at(*rest);
                let mut used = 0.0;
                if *rest > 0.0 {
                    let rate = if stop {
                        0.0
                    } else {
                        cutting_target(limits, inputs, *feed)
                    };
                    let arrives = rate * time >= *rest;
                    used = if arrives { *rest / rate } else { time };
                    *rest = if arrives { 0.0 } else { *rest - rate * time };
                    self.lag.follow(law, path.point_at(*rest) - before, used);
                }
                let mut finished = *rest <= 0.0;
                if finished && (stop || !inputs.cut_continues) {
                    used += self.lag.close_lag(law, time - used);
                    finished = self.lag.is_zero();
                }
                self.position = path.point_at(*rest) - self.lag.vector;
                finished.then_some(used)
            }
            ProgrammedMotion::Thread(thread) => {
                let used = thread.advance(&spindle_tick(), time);
                self.position = thread.position();
                self.handover = Some(thread.handover(inputs.thread_continues));
                thread.is_finished().then_some(used)
            }
            ProgrammedMotion::Tap(tap) => {
                let used = tap.advance(&spindle_tick(), time);
                self.position = tap.position();
                tap.is_finished().then_some(used)
            }
            ProgrammedMotion::ExternalCut(cut) => {
                cut.advance();
                self.position = cut.position();
                None
            }
            ProgrammedMotion::ExternalTap(tap) => {
                tap.advance();
                self.position = tap.position();
                None
            }
        };
        if let Some(used) = used {
            self.motion = ProgrammedMotion::None;
            self.leftover_s = (time - used).clamp(0.0, TICK_S);
        }
        let is_external = match &self.motion {
            ProgrammedMotion::ExternalCut(cut) => cut.is_begun(),
            ProgrammedMotion::ExternalTap(tap) => tap.is_begun(),
            _ => false,
        };
        if self.stopping && !self.is_moving() && !is_external {
            self.motion = ProgrammedMotion::None;
            self.leftover_s = 0.0;
            self.stopping = false;
        }
    }
}
