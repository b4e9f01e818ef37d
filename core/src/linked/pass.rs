//! A thread pass or tap that the board makes: passed to it at a standstill, followed by its
//! reports, and resumed by the control where the board stopped.

use super::LinkedControl;
use crate::alarm::Alarm;
use crate::board::BoardReport;
use crate::units::{Axis, PerAxis, Pulses};
use gsk_link::{HostTime, LinkState, PassError, Stop, TapOrder, ThreadPass};

/// State of the threads and taps that the board makes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BoardThread {
    /// The thread pass that the board is cutting; `None` without one.
    pub(super) pass: Option<ThreadPass>,
    /// The tap that the board is making; `None` without one.
    pub(super) tap: Option<TapOrder>,
    waiting: Option<PassDelay>,
}

impl BoardThread {
    /// Whether the board moves on its own, and the control follows.
    pub(super) const fn is_active(&self) -> bool {
        self.pass.is_some() || self.tap.is_some()
    }
}

/// The reason for which the board does not accept a pass or tap yet, and since when.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PassDelay {
    reason: PassError,
    since: HostTime,
}

impl LinkedControl {
    /// Passes a requested thread pass or tap to the board as soon as the board accepts it; raises
    /// an alarm after the time budget.
    pub(super) fn offer_pass(&mut self) {
        let is_free = !self.thread.is_active();
        let reason = if let Some(pass) = self.control.orders.pass.filter(|_| is_free) {
            self.link.cut(&pass).map(|()| {
                self.report(BoardReport::PassStarted);
                self.thread.pass = Some(pass);
            })
        } else if let Some(order) = self.control.orders.tap.filter(|_| is_free) {
            self.link.tap(&order).map(|()| {
                self.report(BoardReport::TapStarted);
                self.thread.tap = Some(order);
            })
        } else {
            Ok(())
        };
        let Err(reason) = reason else {
            self.thread.waiting = None;
            return;
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

    /// Depth of the tap at the angle that the board last reported, mm; `None` without a tap.
    pub(super) fn tap_depth_mm(&self) -> Option<f64> {
        self.thread.tap?;
        Some(self.link.tap_distance()? / self.link.pulses_per_mm()[Axis::Z as usize])
    }

    /// Stops the board in a tap that the control no longer follows.
    pub(super) fn stop_abandoned_tap(&mut self) {
        if self.thread.tap.is_none() || self.control.orders.follows_tap {
            return;
        }
        if self.reports.are_delivered() {
            self.drop_tap();
        }
    }

    /// Ends a tap before its end: the board stops, and reports where.
    pub(super) fn drop_tap(&mut self) {
        if self.thread.tap.take().is_none() {
            return;
        }
        self.report(BoardReport::MotionEnded);
        if self.link.state() == LinkState::Moving {
            self.link.stop(Stop::Flush);
            self.stopping.flush();
        }
    }

    /// Ends the pass or tap after the board's count has confirmed its end.
    pub(super) fn end_pass(&mut self) {
        if let Some(order) = self.thread.tap.take() {
            self.report(BoardReport::TapEnded(order.start));
            self.motion.set_count(order.start);
            self.motion.last_motion_end = self.clock.run;
        }
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
