//! Sends samples to a line board as segments, and compares its count at each standstill.

use crate::Backend;
use core::time::Duration;

use super::LineLink;
use crate::{LinkEvent, LinkState, MotionRefused, RunTime, Sample, Uncertainty};
use gsk_messages::say;
use gsk_units::alarm;

/// Least duration of the segment that makes the first pulse of a motion.
const RUN_UP: Duration = Duration::from_millis(80);
/// Duration of a standstill after which the link compares the board's count with the kernel's.
const SETTLED: Duration = Duration::from_millis(50);

impl LineLink {
    /// Takes the commanded position at the end of a tick of the kernel, and sends a motion segment
    /// if one is due.
    ///
    /// # Errors
    /// The link accepts no motion now, a limit switch is in the way, or the pulse rate is too high.
    pub(super) fn take_sample(&mut self, sample: Sample) -> Result<(), MotionRefused> {
        if !self.is_prepared() {
            return Err(MotionRefused::NotReady);
        }
        let moves = [
            sample.pulses.x.0 - self.motion.commanded.x.0,
            sample.pulses.z.0 - self.motion.commanded.z.0,
        ];
        let moved = moves != [0; 2];
        self.limits.allow(
            moves,
            [Some(self.reports.pins.x), Some(self.reports.pins.z)],
        )?;
        if core::mem::take(&mut self.motion.resumes) {
            let tick = RunTime::from_millis(1);
            let from = sample.end.saturating_sub(tick);
            self.motion.segments.begin(self.motion.commanded, from);
        }
        if self.motion.is_drained() {
            self.motion.segments.begin_slowly(RUN_UP);
        }
        let segment = self.motion.segments.push(sample, self.motion.offset)?;
        self.motion.commanded = sample.pulses;
        if moved && matches!(self.session.state, LinkState::Ready | LinkState::Locked) {
            self.enter(LinkState::Moving);
        }
        self.motion.backlog.extend(segment);
        self.feed();
        Ok(())
    }

    /// Sends the motion that is not in a segment yet, as a segment of any duration.
    ///
    /// # Errors
    /// The segment needs more pulses per second than the board can make.
    pub(super) fn take_rest(&mut self) -> Result<(), MotionRefused> {
        if !self.is_prepared() {
            return Ok(());
        }
        let rest = self.motion.segments.finish(self.motion.offset)?;
        self.motion.backlog.extend(rest);
        self.feed();
        Ok(())
    }

    /// Sends waiting segments as far as the board's receive buffer has space.
    fn feed(&mut self) {
        let space = usize::from(self.board().receive_bytes).saturating_sub(1);
        let now = self.session.now;
        loop {
            let free_bytes = space.saturating_sub(self.wire.characters());
            let Some(segment) = self.motion.next_segment(free_bytes, now) else {
                return;
            };
            self.send(&segment.line, true);
        }
    }

    pub(super) fn line_done(&mut self, error: Option<u16>) {
        let Some(line) = self.wire.answered() else {
            if self.stopping.is_none() && self.is_prepared() {
                self.protocol_error(say::line_answer_to_nothing());
            }
            return;
        };
        if self.homing.is_some() && self.wire.is_answered() {
            return self.homed(error);
        }
        if self.thread.is_cutting() {
            return self.pass_answered(error);
        }
        if let Some(number) = error {
            let locked = self.session.state == LinkState::Locked && !self.session.released;
            if self.stopping.is_none() && !locked {
                self.protocol_error(say::line_refused(number));
            }
            return;
        }
        if line.is_segment {
            self.motion.segment_answered();
        }
        // The board holds no more than its queue: older segments have left it.
        self.retire(self.board().blocks);
        self.feed();
    }

    /// Compares the board's count with the commanded position when the axes are at standstill and
    /// no motion is queued. Reports the position, or raises an alarm if they differ.
    pub(super) fn verify(&mut self) {
        let flushed = self.session.state == LinkState::Verify;
        let stands = self.session.state == LinkState::Ready;
        if !(flushed || stands || self.session.state == LinkState::Moving)
            || !self.stopping.is_none()
        {
            return;
        }
        let idle = self.wire.is_answered() && self.motion.is_drained();
        let still_since = self.reports.still_since();
        let settled = still_since.is_some_and(|since| self.session.since(since) >= SETTLED);
        let Some(kernel) = self.counted() else {
            return;
        };
        if !(idle && settled) {
            return;
        }
        if flushed {
            // The kernel takes over the position of the stop.
            self.motion.stand_at(kernel);
            if core::mem::take(&mut self.stopping.too_sudden) {
                self.session.lose_position(Uncertainty::TooFast);
            }
            self.session.events.push(LinkEvent::Position(kernel));
            self.stand();
            return;
        }
        if self.motion.agrees(kernel) {
            if stands {
                return;
            }
            self.session.events.push(LinkEvent::Position(kernel));
            self.session.events.push(LinkEvent::Drained);
            self.stand();
            return;
        }
        self.session.lose_position(Uncertainty::Differs);
        let commanded = self.motion.commanded;
        let text =
            say::board_counts_otherwise(commanded.x.0, commanded.z.0, kernel.x.0, kernel.z.0);
        self.session.alarm(alarm::POSITION_CHECK, text);
        self.enter(LinkState::Locked);
    }

    fn stand(&mut self) {
        let state = self.session.standing_state();
        self.enter(state);
    }
}
