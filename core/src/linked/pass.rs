//! A pass of a thread that the board cuts by itself: handed over at rest, followed by
//! its reports, and taken up again where it has ended.

use super::Linked;
use crate::alarm::Alarm;
use crate::board::BoardReport;
use crate::units::{PerAxis, Pulses};
use gsk_link::{HostTime, PassError, ThreadPass};

/// A thread that the board cuts by itself.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Thread {
    /// The pass under way.
    pub(super) pass: Option<ThreadPass>,
    waiting: Option<Waiting>,
}

/// What a pass waits for, and since when.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Waiting {
    why: PassError,
    since: HostTime,
}

impl Linked {
    /// A pass that waits goes to the board as soon as the board can take it.
    pub(super) fn offer_pass(&mut self) {
        let waiting = self.control.orders.pass;
        let asked = waiting.filter(|_| self.thread.pass.is_none());
        let Some(pass) = asked else {
            self.thread.waiting = None;
            return;
        };
        let why = match self.link.cut(&pass) {
            Ok(()) => {
                self.report(BoardReport::PassBegan);
                self.thread.pass = Some(pass);
                self.thread.waiting = None;
                return;
            }
            Err(why) => why,
        };
        let same = |before: &Waiting| {
            core::mem::discriminant(&before.why) == core::mem::discriminant(&why)
        };
        let since = self
            .thread
            .waiting
            .filter(same)
            .map_or(self.clock.now, |before| before.since);
        self.thread.waiting = Some(Waiting { why, since });
        let (number, text, time_budget) = why.to_alarm();
        if self.clock.now.saturating_sub(since) >= time_budget {
            self.thread.waiting = None;
            let alarm = Alarm::new(number).because(text);
            self.report(BoardReport::PassRefused(alarm));
        }
    }

    /// The control stands where the board was seen last: the part of the pass made.
    pub(super) fn pass_made(&self) -> Option<f64> {
        Some(made(&self.thread.pass?, self.link.counted()?))
    }

    /// The board has made its pass, and its count says so.
    pub(super) fn end_pass(&mut self) {
        let Some(pass) = self.thread.pass.take() else {
            return;
        };
        self.report(BoardReport::PassEnded(pass.end));
        self.motion.stand_at(pass.end);
        self.motion.last = self.clock.run;
    }
}

/// The part of a pass that is made.
fn made(pass: &ThreadPass, at: PerAxis<Pulses>) -> f64 {
    let way = |from: Pulses, to: Pulses| (to.0 - from.0) as f64;
    let whole = [way(pass.from.x, pass.end.x), way(pass.from.z, pass.end.z)];
    let gone = [way(pass.from.x, at.x), way(pass.from.z, at.z)];
    let long = usize::from(whole[1].abs() >= whole[0].abs());
    if whole[long] == 0.0 {
        return 0.0;
    }
    gone[long] / whole[long]
}
