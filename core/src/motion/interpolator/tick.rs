//! One tick of the interpolator: programmed motion and manual motion.

use super::{Interpolator, Motion};
use crate::motion::follower::SpindleTick;
use crate::motion::inputs::{MotionInputs, cutting_target, rapid_rate, rapid_targets};
use crate::motion::limits::MotionLimits;
use crate::motion::path::Path;
use crate::motion::ramp::Ramp;
use crate::units::{Axis, Feed, Point, TICK_S};

impl Interpolator {
    /// Advances by one tick (1 ms) and returns the new position.
    pub fn tick(&mut self, limits: &MotionLimits, inputs: &MotionInputs) -> Point {
        self.tick_start = self.position;
        let time = TICK_S + core::mem::take(&mut self.carry);
        if self.finished() {
            if let Some(handover) = &mut self.handover {
                handover.stand_still();
            }
            if !self.lag.is_none() {
                let command = self.commanded();
                self.lag.close_up(limits.cutting_law(), TICK_S);
                self.position = command - self.lag.behind;
            }
            self.manual_motion(limits, inputs);
        } else {
            self.programmed_motion(limits, inputs, time);
        }
        self.position
    }

    /// Uses the rest of this tick, which the last block left, for the block started since.
    /// Returns the new position.
    pub(crate) fn continue_tick(&mut self, limits: &MotionLimits, inputs: &MotionInputs) -> Point {
        if !self.finished() && self.carry > 0.0 {
            let time = core::mem::take(&mut self.carry);
            self.programmed_motion(limits, inputs, time);
        }
        self.position
    }

    fn manual_motion(&mut self, limits: &MotionLimits, inputs: &MotionInputs) {
        self.stopping = false;
        for axis in [Axis::X, Axis::Z] {
            if self.manual.get(axis).idle() {
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

    /// Makes a thread or tap that must stop leave the spindle and come to rest on its line,
    /// like a cut.
    fn leave_spindle(&mut self, limits: &MotionLimits) {
        let (to, ends) = match &self.motion {
            Motion::Thread(thread) => (thread.to(), true),
            Motion::Tap(tap) => (tap.to(), false),
            _ => return,
        };
        let speed = self.velocity().length();
        let rest = self.stopping_point(limits) - self.position;
        let left = (to - self.position).length();
        let beyond = 1.0 + 1e-3 / rest.length().max(1e-9);
        let end = if ends && rest.length() >= left {
            to
        } else {
            self.position + rest * beyond
        };
        let path = Path::line(self.position, end);
        self.motion = Motion::Cut {
            path,
            ramp: Ramp {
                speed,
                remaining: path.length(),
            },
            feed: Feed::PerMinute(0.0),
        };
    }

    /// Without exact corners (007.3 = 0) makes the command of a starting cut run ahead of
    /// the tool.
    fn lead(&mut self, limits: &MotionLimits) {
        let Motion::Cut { path, ramp, feed } = self.motion else {
            return;
        };
        let begins = ramp == Ramp::new(path.length());
        if begins && !(limits.exact_corners() && self.lag.is_none()) {
            let rest = path.length();
            self.motion = Motion::Led { path, rest, feed };
        }
    }

    fn programmed_motion(&mut self, limits: &MotionLimits, inputs: &MotionInputs, time: f64) {
        if self.stopping {
            self.leave_spindle(limits);
        }
        let spindle_tick = || SpindleTick {
            limits,
            spindle: &inputs.spindle,
            rpm: inputs.spindle_rpm,
            hold: inputs.hold,
            continues: inputs.thread_continues,
        };
        let dry_changes = inputs.dry_run.is_some() != self.dry;
        let stop = inputs.hold || self.stopping || (dry_changes && self.is_moving());
        if !stop {
            self.dry = inputs.dry_run.is_some();
        }
        self.lead(limits);
        let used = match &mut self.motion {
            Motion::None => return,
            Motion::Rapid(rapid) => {
                let used = rapid.advance(limits, rapid_targets(limits, inputs, stop), time);
                self.position = rapid.position();
                rapid.finished().then_some(used)
            }
            Motion::StraightRapid(rapid) => {
                let used = rapid.advance(limits, rapid_targets(limits, inputs, stop), time);
                self.position = rapid.position();
                rapid.finished().then_some(used)
            }
            Motion::Cut { path, ramp, feed } => {
                let target = if stop {
                    0.0
                } else {
                    cutting_target(limits, inputs, *feed)
                };
                let used = ramp.advance(limits.cutting_law(), target, time).used;
                self.position = path.at(ramp.remaining);
                ramp.finished().then_some(used)
            }
            Motion::Led { path, rest, feed } => {
                let law = limits.cutting_law();
                let before = path.at(*rest);
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
                    self.lag.follow(law, path.at(*rest) - before, used);
                }
                let mut finished = *rest <= 0.0;
                if finished && (stop || !inputs.cut_continues) {
                    used += self.lag.close_up(law, time - used);
                    finished = self.lag.is_none();
                }
                self.position = path.at(*rest) - self.lag.behind;
                finished.then_some(used)
            }
            Motion::Thread(thread) => {
                let used = thread.advance(&spindle_tick(), time);
                self.position = thread.position();
                self.handover = Some(thread.handover(inputs.thread_continues));
                thread.finished().then_some(used)
            }
            Motion::Tap(tap) => {
                let used = tap.advance(&spindle_tick(), time);
                self.position = tap.position();
                tap.finished().then_some(used)
            }
            Motion::Driven(cut) => {
                cut.advance();
                self.position = cut.position();
                None
            }
        };
        if let Some(used) = used {
            self.motion = Motion::None;
            self.carry = (time - used).clamp(0.0, TICK_S);
        }
        let ends_itself = matches!(&self.motion, Motion::Driven(cut) if cut.is_begun());
        if self.stopping && !self.is_moving() && !ends_itself {
            self.motion = Motion::None;
            self.carry = 0.0;
            self.stopping = false;
        }
    }
}
