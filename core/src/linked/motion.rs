//! The motion that was commanded to the board.

use super::{ControlSnapshot, LinkedControl};
use crate::alarm::Alarm;
use crate::board::BoardReport;
use crate::units::{PerAxis, Pulses};
use gsk_link::{FINE, LinkState, MotionRefused, RunTime, Sample, Stop};

/// The motion that was last passed to the board.
#[derive(Clone, Copy, Debug)]
pub(super) struct CommandedMotion {
    pub(super) pulses: PerAxis<Pulses>,
    /// Kernel time at the end of the last tick that made a pulse.
    pub(super) last_motion_end: RunTime,
    /// Whether any pulse was commanded in the last tick.
    pub(super) moved: bool,
    /// Number of stops since the opening after which the control continued from another
    /// position.
    pub(super) resync_count: u64,
}

impl CommandedMotion {
    pub(super) const fn new(pulses: PerAxis<Pulses>) -> Self {
        Self {
            pulses,
            last_motion_end: RunTime::ZERO,
            moved: false,
            resync_count: 0,
        }
    }

    /// Sets the pulse count without a motion to it.
    pub(super) const fn set_count(&mut self, pulses: PerAxis<Pulses>) {
        self.pulses = pulses;
        self.moved = false;
    }
}

impl LinkedControl {
    /// Passes the motion of the last tick to the board.
    pub(super) fn push_motion(&mut self) {
        let ControlSnapshot { pulses, orders } = self.control;
        if self.thread.is_active() {
            // The board moves first; the control follows its count.
            self.motion.set_count(pulses);
            if let Some(order) = self.thread.tap {
                // Only the time passes.
                let _ = self.link.push(Sample::new(self.clock.run, order.start));
            }
            return;
        }
        self.motion.moved = pulses != self.motion.pulses;
        if !self.motion.moved && !self.link.is_prepared() {
            return;
        }
        let waits = orders.spindle.waits_for_angle;
        self.link
            .keep_time(waits || orders.spindle.lead_mm.is_some());
        let to_fine = |position: f64| (position * FINE as f64).round() as i64;
        let sample = Sample {
            end: self.clock.run,
            pulses,
            fine: PerAxis::new(to_fine(orders.fraction.x), to_fine(orders.fraction.z)),
        };
        match self.link.push(sample) {
            Ok(()) => self.motion.pulses = pulses,
            Err(refused) => return self.reject_motion(refused),
        }
        if self.motion.moved {
            self.motion.last_motion_end = self.clock.run;
        } else if !waits
            && !orders.is_moving
            && let Err(refused) = self.link.finish()
        {
            self.reject_motion(refused);
        }
    }

    /// Handles motion that the board rejects: raises the alarm, and returns the control to
    /// the position of the slides.
    pub(super) fn reject_motion(&mut self, refused: MotionRefused) {
        let (number, text) = refused.to_alarm();
        self.raise(Alarm::new(number).with_detail(text));
        self.report(BoardReport::MotionEnded);
        self.motion.moved = false;
        self.report(BoardReport::MotionRejected(self.motion.pulses));
        if self.link.state() == LinkState::Moving {
            // The board reports that position when it has stopped.
            self.link.stop(Stop::Flush);
            self.stopping.flush();
        }
    }
}
