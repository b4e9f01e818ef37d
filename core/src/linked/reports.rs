//! Reports of the board that wait for the control's next tick.

use core::time::Duration;

use super::LinkedControl;
use crate::alarm::Alarm;
use crate::board::{BoardReport, Standstill};
use gsk_link::HostTime;
use gsk_messages::Message;

/// Time after which a turn of the handwheel that no tick has taken moves nothing.
const WHEEL_LEASE: Duration = Duration::from_millis(200);

/// Board reports that wait for the control's next tick.
#[derive(Clone, Debug, Default)]
pub(super) struct PendingReports {
    waiting: Vec<BoardReport>,
    /// What the board knows about the position of the slides, while they are at standstill; `None`
    /// otherwise.
    pub(super) standstill: Option<Standstill>,
    /// The message about motion that was too late, and the host time; `None` if no motion was. The
    /// alarm waits until the board has answered.
    pub(super) late_motion: Option<(Message, HostTime)>,
    /// Graduations by which the handwheel at the board has turned, and the host time of the last.
    wheel: (i32, HostTime),
}

impl PendingReports {
    /// Whether the control has received all reports. Only then do its orders take them into
    /// account.
    pub(super) const fn are_delivered(&self) -> bool {
        self.waiting.is_empty()
    }

    /// Removes and returns the reports and the standstill for a tick.
    pub(super) fn take_for_tick(&mut self) -> (Vec<BoardReport>, Option<Standstill>) {
        (core::mem::take(&mut self.waiting), self.standstill.take())
    }
}

impl LinkedControl {
    /// Queues a report for the control's next tick.
    pub(super) fn report(&mut self, report: BoardReport) {
        self.reports.waiting.push(report);
    }

    /// Queues a turn of the handwheel for the control's next tick.
    pub(super) fn queue_wheel_turn(&mut self, graduations: i32) {
        let turned = self.take_wheel_turn();
        self.reports.wheel = (turned.saturating_add(graduations), self.clock.now);
    }

    /// Removes and returns the turns of the handwheel for a tick; none if they are too old.
    pub(super) fn take_wheel_turn(&mut self) -> i32 {
        let (turned, at) = core::mem::take(&mut self.reports.wheel);
        if self.clock.now.saturating_sub(at) > WHEEL_LEASE {
            return 0;
        }
        turned
    }

    /// Queues an alarm for the control's next tick. The control later adds the position of
    /// the slides to its detail.
    pub(super) fn raise(&mut self, alarm: Alarm) {
        let in_pass = self.thread.is_active();
        self.thread.pass = None;
        self.drop_tap();
        self.report(BoardReport::Alarm { alarm, in_pass });
    }
}
