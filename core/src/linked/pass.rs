//! A pass of a thread that the board cuts by itself: handed over at rest, followed by
//! its reports, and taken up again where it has ended.

use super::Linked;
use crate::alarm::Alarm;
use crate::simulation::Simulation;
use crate::units::{PerAxis, Pulses};
use gsk_link::{CannotCut, HostTime, Pass};

/// A thread that the board cuts by itself.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Thread {
    /// The pass under way.
    pub(super) pass: Option<Pass>,
    waiting: Option<Waiting>,
}

/// What a pass waits for, and since when.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Waiting {
    why: CannotCut,
    since: HostTime,
}

impl Linked {
    /// A pass that waits goes to the board as soon as the board can take it.
    pub(super) fn offer_pass(&mut self, simulation: &mut Simulation) {
        let cnc = &mut simulation.cnc;
        let asked = cnc.pass_waiting().filter(|_| self.thread.pass.is_none());
        let Some(pass) = asked else {
            self.thread.waiting = None;
            return;
        };
        let why = match self.link.cut(&pass) {
            Ok(()) => {
                cnc.begin_pass();
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
        let (number, text, patience) = why.judged();
        if self.clock.now.saturating_sub(since) >= patience {
            self.thread.waiting = None;
            cnc.raise_at_last(Alarm::new(number).because(text));
        }
    }

    /// The control stands where the board was seen last.
    pub(super) fn follow_pass(&mut self, simulation: &mut Simulation) {
        if let (Some(pass), Some(at)) = (self.thread.pass, self.link.counted()) {
            simulation.cnc.pass_progress(made(&pass, at));
        }
    }

    /// The board has made its pass, and its count says so.
    pub(super) fn end_pass(&mut self, simulation: &mut Simulation) {
        let Some(pass) = self.thread.pass.take() else {
            return;
        };
        simulation.cnc.end_pass(pass.end);
        self.motion.stand_at(simulation.cnc.pulses());
        self.motion.last = self.clock.run;
    }
}

/// The part of a pass that is made.
fn made(pass: &Pass, at: PerAxis<Pulses>) -> f64 {
    let way = |from: Pulses, to: Pulses| (to.0 - from.0) as f64;
    let whole = [way(pass.from.x, pass.end.x), way(pass.from.z, pass.end.z)];
    let gone = [way(pass.from.x, at.x), way(pass.from.z, at.z)];
    let long = usize::from(whole[1].abs() >= whole[0].abs());
    if whole[long] == 0.0 {
        return 0.0;
    }
    gone[long] / whole[long]
}
