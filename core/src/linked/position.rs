//! The position of the slides after a stop that the control did not make.

use super::LinkedControl;
use crate::alarm::{Alarm, number};
use crate::board::{BoardReport, Standstill};
use crate::units::{PerAxis, Pulses};
use gsk_link::{HostTime, LinkState, RunTime};

/// The moment of the motion at which a picture of the machine was taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MotionStamp {
    at: RunTime,
    /// Number of stops since the opening after which the control continued from another
    /// position.
    resync_count: u64,
}

impl LinkedControl {
    /// Returns the moment of the motion for a picture that is taken now.
    pub const fn stamp(&self) -> MotionStamp {
        MotionStamp {
            at: self.motion.last_motion_end,
            resync_count: self.motion.resync_count,
        }
    }

    /// Whether the board has executed all motion up to `stamp`: the pictures of that moment
    /// may be shown.
    pub fn has_executed(&self, stamp: MotionStamp) -> bool {
        !self.has_pending_motion() || self.link.executed() >= stamp.at
    }

    /// Whether the board may never execute the motion up to `stamp`: the pictures of that
    /// moment must be dropped.
    pub const fn is_discarded(&self, stamp: MotionStamp) -> bool {
        stamp.resync_count != self.motion.resync_count
    }

    /// Number of kernel ticks whose motion may not have been executed yet.
    pub(super) fn ticks_ahead(&self) -> u64 {
        // After a fault this is unknown until the board has reported its position.
        if self.link.takes_motion() && !self.has_pending_motion() {
            return 0;
        }
        let ahead = self.clock.run.saturating_sub(self.link.executed());
        ahead.as_micros().div_ceil(1000) as u64
    }

    /// Makes the pulse count of the stopped slides the control's position.
    pub(super) fn adopt_stop(&mut self, pulses: PerAxis<Pulses>) {
        self.report(BoardReport::StoppedAt(pulses));
        self.motion.set_count(pulses);
    }

    /// Whether the slides move or are being stopped.
    fn is_under_way(&self) -> bool {
        self.has_pending_motion() || !self.stopping.is_none() || self.thread.is_active()
    }

    /// Sets the control's position to the board's last count after a fault or a loss, so that the
    /// pages show what was executed and not what was commanded.
    pub(super) fn adopt_count(&mut self) {
        if self.link.takes_motion() || self.is_under_way() {
            return;
        }
        if let Some(at) = self
            .link
            .last_position()
            .filter(|at| *at != self.motion.pulses)
        {
            self.adopt_stop(at);
        }
    }

    /// Reports to the control whether the slides are at standstill, and what the board knows about
    /// their position.
    pub(super) fn report_standstill(&mut self) {
        let is_standstill = !(self.is_under_way() || self.link.is_stopping());
        self.reports.standstill = is_standstill.then(|| Standstill {
            position_reported: self.link.last_position().is_some(),
            uncertainty: self.link.uncertainty(),
        });
    }

    /// Raises the alarm for late motion after the board has answered. No alarm for a lost
    /// board, which has its own.
    pub(super) fn report_late(&mut self) {
        let lost = matches!(self.link.state(), LinkState::Lost | LinkState::Fault);
        let answered = |late: HostTime| self.link.has_answered_since(late);
        if let Some((text, _)) = self
            .reports
            .late_motion
            .take_if(|(_, late)| lost || answered(*late))
            .filter(|_| !lost)
        {
            self.raise(Alarm::new(number::STEPS_TOO_LATE).with_detail(text));
        }
    }
}
