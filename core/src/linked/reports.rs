//! What the control is going to hear of the board in its next tick.

use super::Linked;
use crate::alarm::Alarm;
use crate::board::{BoardReport, Settled};
use gsk_link::HostTime;
use gsk_messages::Message;

/// Reports that wait for the next tick.
#[derive(Clone, Debug, Default)]
pub(super) struct Reports {
    waiting: Vec<BoardReport>,
    /// The slides stand, and the board has said where.
    pub(super) settled: Option<Settled>,
    /// Why motion came late, and when: it is not sure yet that the board is there.
    pub(super) late: Option<(Message, HostTime)>,
}

impl Reports {
    /// Whether the control has heard everything: only then are its orders an answer.
    pub(super) const fn are_heard(&self) -> bool {
        self.waiting.is_empty()
    }

    /// What goes into a tick.
    pub(super) fn take(&mut self) -> (Vec<BoardReport>, Option<Settled>) {
        (core::mem::take(&mut self.waiting), self.settled.take())
    }
}

impl Linked {
    /// The control is told of it in its next tick.
    pub(super) fn report(&mut self, report: BoardReport) {
        self.reports.waiting.push(report);
    }

    /// An alarm, which is going to say where the slides stand.
    pub(super) fn raise(&mut self, alarm: Alarm) {
        let in_pass = self.thread.pass.take().is_some();
        self.report(BoardReport::Alarm { alarm, in_pass });
    }
}
