//! Where the slides stand after a stop that the control has not made.

use super::Linked;
use crate::alarm::{Alarm, number};
use crate::board::{BoardReport, Settled};
use crate::units::{PerAxis, Pulses};
use gsk_link::{HostTime, LinkState, RunTime};

/// The moment of the motion that a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    at: RunTime,
    /// Stops since the opening behind which the control went on from another place.
    stops: u64,
}

impl Linked {
    /// The moment of the motion that a picture taken now shows.
    pub const fn stamp(&self) -> Stamp {
        Stamp {
            at: self.motion.last,
            stops: self.motion.stops,
        }
    }

    /// Whether the board has made all motion up to a moment: pictures of it may be
    /// shown.
    pub fn has_made(&self, stamp: Stamp) -> bool {
        !self.is_behind() || self.link.executed() >= stamp.at
    }

    /// Whether the motion up to a moment may never have been made: pictures of it are
    /// not to be shown any more.
    pub const fn is_void(&self, stamp: Stamp) -> bool {
        stamp.stops != self.motion.stops
    }

    /// Ticks of the kernel whose motion may not have been made yet.
    pub(super) fn ticks_ahead(&self) -> u64 {
        // Behind a fault nobody knows before the board has said where it stands.
        if self.link.takes_motion() && !self.is_behind() {
            return 0;
        }
        let ahead = self.clock.run.saturating_sub(self.link.executed());
        ahead.as_micros().div_ceil(1000) as u64
    }

    /// The control goes on from where the slides are.
    pub(super) fn stopped_at(&mut self, pulses: PerAxis<Pulses>) {
        self.report(BoardReport::StandsAt(pulses));
        self.motion.stand_at(pulses);
    }

    /// The slides are on their way, or being stopped.
    fn is_under_way(&self) -> bool {
        self.is_behind() || !self.stopping.is_none() || self.thread.pass.is_some()
    }

    /// Behind a fault or a loss the pages show what the board has made by its last
    /// count, not what was commanded.
    pub(super) fn adopt_count(&mut self) {
        if self.link.takes_motion() || self.is_under_way() {
            return;
        }
        if let Some(at) = self
            .link
            .last_position()
            .filter(|at| *at != self.motion.pulses)
        {
            self.stopped_at(at);
        }
    }

    /// The control hears that the slides stand, and what is known of where.
    pub(super) fn report_standstill(&mut self) {
        let stand = !(self.is_under_way() || self.link.is_stopping());
        self.reports.settled = stand.then(|| Settled {
            reported: self.link.last_position().is_some(),
            uncertainty: self.link.uncertainty(),
        });
    }

    /// Motion came too late to a board that answers; one that is lost is another matter.
    pub(super) fn report_late(&mut self) {
        let lost = matches!(self.link.state(), LinkState::Lost | LinkState::Fault);
        let answered = |late: HostTime| self.link.has_answered_since(late);
        if let Some((text, _)) = self
            .reports
            .late
            .take_if(|(_, late)| lost || answered(*late))
            .filter(|_| !lost)
        {
            self.raise(Alarm::new(number::STEPS_TOO_LATE).because(text));
        }
    }
}
