//! A thread pass that the board cuts: passed to it at a standstill, followed by its
//! reports, and resumed by the control where the board stopped.

use super::LinkedControl;
use crate::alarm::Alarm;
use crate::board::BoardReport;
use crate::units::{PerAxis, Pulses};
use gsk_link::{HostTime, PassError, ThreadPass};

/// State of the threads that the board cuts.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BoardThread {
    /// The thread pass that the board is cutting; `None` without one.
    pub(super) pass: Option<ThreadPass>,
    waiting: Option<PassDelay>,
}

/// The reason for which the board does not accept a pass yet, and since when.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PassDelay {
    reason: PassError,
    since: HostTime,
}

impl LinkedControl {
    /// Passes a requested thread pass to the board as soon as the board accepts it; raises
    /// an alarm after the time budget.
    pub(super) fn offer_pass(&mut self) {
        let requested = self.control.orders.pass;
        let offered = requested.filter(|_| self.thread.pass.is_none());
        let Some(pass) = offered else {
            self.thread.waiting = None;
            return;
        };
        let reason = match self.link.cut(&pass) {
            Ok(()) => {
                self.report(BoardReport::PassStarted);
                self.thread.pass = Some(pass);
                self.thread.waiting = None;
                return;
            }
            Err(why) => why,
        };
        let same = |before: &PassDelay| {
            core::mem::discriminant(&before.reason) == core::mem::discriminant(&reason)
        };
        let since = self
            .thread
            .waiting
            .filter(same)
            .map_or(self.clock.now, |before| before.since);
        self.thread.waiting = Some(PassDelay { reason, since });
        let (number, text, time_budget) = reason.to_alarm();
        if self.clock.now.saturating_sub(since) >= time_budget {
            self.thread.waiting = None;
            let alarm = Alarm::new(number).with_detail(text);
            self.report(BoardReport::PassRefused(alarm));
        }
    }

    /// Fraction of the pass that the board had made at its last report, 0–1; `None` without
    /// a pass.
    pub(super) fn pass_fraction(&self) -> Option<f64> {
        Some(fraction_at(&self.thread.pass?, self.link.counted()?))
    }

    /// Ends the pass after the board's count has confirmed its end.
    pub(super) fn end_pass(&mut self) {
        let Some(pass) = self.thread.pass.take() else {
            return;
        };
        self.report(BoardReport::PassEnded(pass.end));
        self.motion.set_count(pass.end);
        self.motion.last_motion_end = self.clock.run;
    }
}

/// Fraction of a pass at a pulse count, measured along its longer axis.
fn fraction_at(pass: &ThreadPass, at: PerAxis<Pulses>) -> f64 {
    let distance = |from: Pulses, to: Pulses| (to.0 - from.0) as f64;
    let total = [
        distance(pass.from.x, pass.end.x),
        distance(pass.from.z, pass.end.z),
    ];
    let done = [distance(pass.from.x, at.x), distance(pass.from.z, at.z)];
    let longer_axis = usize::from(total[1].abs() >= total[0].abs());
    if total[longer_axis] == 0.0 {
        return 0.0;
    }
    done[longer_axis] / total[longer_axis]
}
