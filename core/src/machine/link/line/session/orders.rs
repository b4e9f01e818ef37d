//! What the control orders: motion, stops, the way back after them.

use super::super::super::{Doubt, LinkState, Refused, RunTime, Sample, Stop};
use super::super::Family;
use super::super::answers::BoardState;
use super::{Halt, LineLink, RUN_UP};

impl LineLink {
    /// The port failed: unplugged, or taken away.
    pub fn lost(&mut self, cause: &str) {
        if matches!(self.state, LinkState::Off | LinkState::Lost) {
            return;
        }
        self.forget_motion();
        self.lose_position(Doubt::Unheard);
        self.status = None;
        let never_heard = self.state == LinkState::Opening;
        self.alarm(if never_heard { 601 } else { 605 }, cause);
        self.enter(LinkState::Lost);
    }

    /// Writes the settings that differ; the operator was asked.
    pub fn write_settings(&mut self) {
        let outcome = self.opening.write_settings(self.now);
        self.open_further(outcome);
    }

    /// Hands over where the axes are to be at the end of a tick.
    ///
    /// # Errors
    /// The state takes no motion, or the board could not follow; nothing was sent.
    pub fn push(&mut self, sample: Sample) -> Result<(), Refused> {
        if !self.is_prepared() {
            return Err(Refused::NotReady);
        }
        let moves = [
            sample.pulses.x.0 - self.commanded.x.0,
            sample.pulses.z.0 - self.commanded.z.0,
        ];
        let moved = moves != [0; 2];
        self.limits
            .allow(moves, [Some(self.pins.x), Some(self.pins.z)])?;
        if core::mem::take(&mut self.resumes) {
            let tick = RunTime::from_millis(1);
            let from = sample.end.saturating_sub(tick);
            self.segments.begin(self.commanded, from);
        }
        let stands = self.queued.is_empty() && self.backlog.is_empty();
        if stands && self.segments.pending() == RunTime::ZERO {
            self.segments.begin_slowly(RUN_UP);
        }
        let segment = self.segments.push(sample, self.offset)?;
        self.commanded = sample.pulses;
        if moved && matches!(self.state, LinkState::Ready | LinkState::Locked) {
            self.enter(LinkState::Moving);
        }
        self.backlog.extend(segment);
        self.feed();
        Ok(())
    }

    /// The kernel stands: what is left of the last segment goes out.
    ///
    /// # Errors
    /// The board could not follow the rest.
    pub fn finish(&mut self) -> Result<(), Refused> {
        if !self.is_prepared() {
            return Ok(());
        }
        let rest = self.segments.finish(self.offset)?;
        self.backlog.extend(rest);
        self.feed();
        Ok(())
    }

    /// Stops the board at once.
    pub fn stop(&mut self, stop: Stop) {
        if !self.opening.is_done() || matches!(self.state, LinkState::Off | LinkState::Lost) {
            return;
        }
        match stop {
            Stop::Flush => self.flush(),
            Stop::Kill => {
                let moves = self.state == LinkState::Moving;
                self.lose_position(Doubt::killed(moves, Doubt::StoppedDead));
                self.forget_motion();
                self.restart();
                self.enter(LinkState::Locked);
            }
        }
    }

    /// The operator pressed RESET: faults whose cause is gone are cleared, the board
    /// is unlocked; without a position nothing moves yet.
    pub fn reset(&mut self) {
        self.limits.look();
        match self.state {
            LinkState::Fault if self.restarted || !self.opening.is_done() => self.open_again(),
            LinkState::Tripped | LinkState::Fault if self.opening.is_done() => {
                self.forget_motion();
                if matches!(self.halt, Halt::Restarting(_)) {
                    // What is sent before its banner is thrown away.
                    self.unlocks = true;
                } else {
                    self.send("$X", false);
                }
                self.enter(LinkState::Locked);
            }
            // FluidNC may be locked so that an unlock alone does nothing.
            LinkState::Locked
                if self.opening.family == Family::FluidNc
                    && (self.board_is_locked() || self.status.is_none()) =>
            {
                self.unlocks = true;
                self.restart();
            }
            LinkState::Locked if self.board_is_locked() => self.send("$X", false),
            LinkState::Locked if self.status.is_none() => self.unlocks = true,
            LinkState::Moving => self.flush(),
            LinkState::Homing => self.give_up_homing(None),
            _ => {}
        }
    }

    fn board_is_locked(&self) -> bool {
        self.status
            .is_some_and(|status| status.state == BoardState::Alarm)
    }
}
