//! Reports of the board that wait for the control's next tick.

use super::LinkedControl;
use crate::alarm::Alarm;
use crate::board::{BoardReport, Standstill};
use gsk_link::HostTime;
use gsk_messages::Message;

/// Reports that wait for the next tick.
#[derive(Clone, Debug, Default)]
pub(super) struct PendingReports {
    waiting: Vec<BoardReport>,
    /// Set when the slides stand still and the board has reported their position.
    pub(super) standstill: Option<Standstill>,
    /// Why and when motion came too late. The alarm waits until the board has answered.
    pub(super) late_motion: Option<(Message, HostTime)>,
}

impl PendingReports {
    /// Whether the control has received all reports: only then are its orders based on
    /// them.
    pub(super) const fn are_delivered(&self) -> bool {
        self.waiting.is_empty()
    }

    /// Takes the reports and the standstill for a tick.
    pub(super) fn take_for_tick(&mut self) -> (Vec<BoardReport>, Option<Standstill>) {
        (core::mem::take(&mut self.waiting), self.standstill.take())
    }
}

impl LinkedControl {
    /// Queues a report for the control's next tick.
    pub(super) fn report(&mut self, report: BoardReport) {
        self.reports.waiting.push(report);
    }

    /// Queues an alarm; its detail later names the position of the slides.
    pub(super) fn raise(&mut self, alarm: Alarm) {
        let in_pass = self.thread.pass.take().is_some();
        self.report(BoardReport::Alarm { alarm, in_pass });
    }
}
