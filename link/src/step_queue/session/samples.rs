//! Sends samples to the board as timed steps, and compares the board's count with the commanded
//! position.

use crate::Backend;
use crate::position::Positioned;
use core::time::Duration;

use super::super::super::{Input, LinkEvent, LinkState, MotionRefused, Sample, Uncertainty};
use super::super::commands::Command;
use super::super::step_compress::Ticks;
use super::super::steps::Stretch;
use super::{QueryPurpose, StepLink};
use gsk_messages::say;
use gsk_units::{PerAxis, Pulses, alarm};

/// Interval at which the link compresses steps and sends them.
pub(super) const FLUSH_EVERY: Duration = Duration::from_millis(10);
/// Least time until steps must be sent with which they wait to be compressed together with later
/// ones.
const LEAST_SLACK: Duration = Duration::from_millis(45);
/// Factor of the permitted time error of steps, by the least time until they must be sent.
const COARSER: [(Duration, Ticks); 4] = [
    (Duration::from_millis(70), 1),
    (Duration::from_millis(50), 2),
    (Duration::from_millis(30), 4),
    (Duration::from_millis(10), 8),
];
const COARSEST: Ticks = 16;
/// Interval at which the counts of board and kernel are compared at standstill.
const LOOK_EVERY: Duration = Duration::from_secs(1);
/// Duration of a standstill after which the counts of board and kernel are compared.
const SETTLED: Duration = Duration::from_millis(50);
/// Number of waiting bytes above which the link reports no free lookahead to the kernel.
pub(super) const MOST_WAITING: usize = 1500;

impl StepLink {
    /// Returns the greatest board clock, ticks, at which motion accepted now may end: after the
    /// lookahead and the transmission time. A pause of the host up to the lookahead then has no
    /// effect.
    pub(super) fn farthest(&self) -> Ticks {
        let reach = self.ahead() + self.margin() + FLUSH_EVERY;
        self.path_now() + self.clock.ticks(reach) as Ticks
    }

    /// Takes the commanded position at the end of a tick of the kernel and adds its steps to the
    /// motion.
    ///
    /// # Errors
    /// The link accepts no motion now, a limit switch is in the way, the pulse rate is too high, or
    /// the motion is late.
    pub(super) fn take_sample(&mut self, sample: Sample) -> Result<(), MotionRefused> {
        if !self.is_prepared() {
            return Err(MotionRefused::NotReady);
        }
        let before = self.motion.path.newest;
        if self.angle.tap.is_some() {
            if sample.pulses != before.pulses {
                return Err(MotionRefused::NotReady);
            }
            self.pass_time_in_tap(sample);
            return Ok(());
        }
        if !self.angle.is_planned() && self.angle.is_engaged() {
            self.take_sample_after_thread(sample);
            return Ok(());
        }
        let duration = sample.end.saturating_sub(before.end);
        let moves = [
            sample.pulses.x.0 - before.pulses.x.0,
            sample.pulses.z.0 - before.pulses.z.0,
        ];
        let moved = moves != [0; 2];
        if duration.is_zero() {
            return if moved {
                Err(MotionRefused::NotReady)
            } else {
                Ok(())
            };
        }
        self.motion.rates.allow(moves, duration.as_secs_f64())?;
        if moved {
            let operated = [Input::LimitX, Input::LimitZ].map(|input| self.input(input));
            self.motion.limits.allow(moves, operated)?;
        }
        if self.angle.is_planned() {
            return self.take_angle_sample(&before, sample);
        }
        let rests = !moved && sample.fine == before.fine;
        if rests && self.motion.path.finished && !self.motion.path.keeps_time {
            // Time without motion is not sent.
            self.motion.path.rest(sample);
            return Ok(());
        }
        if self.is_too_late() || (!rests && self.spindle.has_gap()) {
            self.late(say::motion_not_in_time());
            return Err(MotionRefused::NotReady);
        }
        let from = self.next_begin();
        if !rests {
            // A position query at standstill is obsolete now.
            self.query.pending = self.query.pending.filter(|reading| {
                !matches!(
                    reading.purpose,
                    QueryPurpose::Verify | QueryPurpose::Look { .. }
                )
            });
        }
        let need = self
            .wire
            .send_queue
            .time_for(self.motion.queue.slowdown.expected());
        let need = need.saturating_sub(self.slowness() / 2);
        let slower = self.motion.queue.slowdown.factor(duration, need);
        let slower = if self.motion.path.keeps_time {
            1.0
        } else {
            slower
        };
        let end = from + self.clock.ticks(duration.mul_f64(slower)) as Ticks;
        for (axis, steps) in self.motion.queue.steps.iter_mut().enumerate() {
            let pair = |values: PerAxis<i64>| if axis == 0 { values.x } else { values.z };
            let count = |sample: &Sample| pair(PerAxis::new(sample.pulses.x.0, sample.pulses.z.0));
            steps.sample(Stretch {
                clock: [from, end],
                count: [count(&before), count(&sample)],
                fine: [pair(before.fine), pair(sample.fine)],
            });
        }
        self.motion.path.push(sample, from, end, rests);
        self.motion.count.commanded = sample.pulses;
        let flush_due = self.session.now + FLUSH_EVERY;
        self.motion.queue.flush_due.get_or_insert(flush_due);
        if moved {
            self.motion.queue.last_step = None;
            self.session.enter(LinkState::Moving);
        }
        Ok(())
    }

    /// Returns the board clocks, ticks, at the end of the motion and at the end of the samples
    /// without motion after it; `None` without motion.
    fn end_of_rest(&self) -> Option<(Ticks, Ticks)> {
        let end = self.motion.path.end?;
        let rest = self.motion.path.rest_after_end();
        Some((end, end + self.clock.ticks(rest) as Ticks))
    }

    /// Whether a sample that continues the current motion would be too late to be executed without
    /// a gap.
    fn is_too_late(&self) -> bool {
        let rests = self.motion.path.is_at_rest();
        let late = self.earliest() as Ticks;
        !rests && self.end_of_rest().is_some_and(|(_, rest)| rest < late)
    }

    /// Returns the board clock at which motion that is accepted now will begin, ticks.
    pub(super) fn next_begin(&self) -> Ticks {
        let begin = self.farthest();
        match self.end_of_rest() {
            Some((end, rest)) if rest >= self.earliest() as Ticks => rest.min(begin).max(end),
            // After a standstill motion may begin later.
            _ => begin,
        }
    }

    /// Compresses and sends the steps that still wait to be compressed with later ones, when the
    /// kernel is at standstill. Never fails.
    pub(super) fn take_rest(&mut self) -> Result<(), MotionRefused> {
        self.close_stretch();
        self.motion.path.finished = true;
        self.compress();
        self.send();
        Ok(())
    }

    /// Returns the time within which the first step that is not compressed must be sent; time for a
    /// retransmission is subtracted.
    fn slack(&self) -> Duration {
        let first = self.motion.queue.first_due().unwrap_or_default();
        let slack = self.clock.duration(first.saturating_sub(self.earliest()));
        slack.saturating_sub(self.slowness())
    }

    fn slowness(&self) -> Duration {
        self.wire.send_queue.slowness_now(self.session.now)
    }

    /// Compresses the collected steps into runs and sends these. Steps that must be sent soon give
    /// fewer and longer runs, with larger time errors.
    pub(super) fn compress(&mut self) {
        let slack = self.slack().saturating_sub(self.slowness());
        let coarse = COARSER.iter().find(|(least, _)| slack >= *least);
        let coarse = coarse.map_or(COARSEST, |(_, coarse)| *coarse);
        self.motion.queue.flush_due = None;
        let now = self.clock.at(self.session.now) as Ticks;
        let mut entries = Vec::new();
        for (axis, steps) in self.motion.queue.steps.iter_mut().enumerate() {
            let mut compressed = Vec::new();
            steps.compress(now, coarse, &mut compressed);
            entries.extend(compressed.into_iter().map(|entry| (axis, entry)));
        }
        entries.sort_by_key(|(_, entry)| entry.first);
        let messages = entries.iter().map(|(_, entry)| entry.messages());
        self.motion.queue.slowdown.compressed(messages.sum());
        self.motion.queue.backlog.extend(entries);
        self.hand_over();
        self.compress_angle();
    }

    /// Sends step runs as far as the board's motion queue has free entries.
    fn hand_over(&mut self) {
        let now = self.clock.at(self.session.now) as Ticks;
        let Some(axes) = self.wiring.as_ref().map(|wiring| wiring.axes) else {
            return;
        };
        self.motion.queue.pass(now);
        while let Some((axis, entry)) = self.motion.queue.next_entry() {
            let (oid, invert) = match axis {
                0 => (axes.x, self.config.x.is_direction_inverted()),
                _ => (axes.z, self.config.z.is_direction_inverted()),
            };
            let due = entry.first.unsigned_abs();
            if let Some(from) = entry.from {
                self.wire
                    .send_timed(Command::ResetStepClock, &[oid, i64::from(from as u32)], due);
            }
            if let Some(up) = entry.up {
                self.wire.send_timed(
                    Command::SetNextStepDir,
                    &[oid, i64::from(up != invert)],
                    due,
                );
            }
            let run = entry.run;
            let arguments = [oid, run.interval.into(), run.count.into(), run.add.into()];
            self.wire.send_steps(axis, &arguments, due);
            self.wire.traffic.segments += 1;
        }
    }

    /// Advances the motion to the current time: sends due steps, and stops motion that is
    /// late.
    pub(super) fn advance_motion(&mut self) {
        self.watch_angle();
        self.watch_tap();
        let now = self.path_now();
        if self.stopping.is_none() {
            self.motion.path.pass(now);
        }
        let due = self
            .motion
            .queue
            .flush_due
            .is_some_and(|due| self.session.now >= due);
        // On a slow or full line fewer and longer runs are better.
        let narrow = self.wire.send_queue.is_congested() || !self.slowness().is_zero();
        let may_wait = narrow && self.slack() >= LEAST_SLACK;
        if due && !may_wait {
            self.compress();
        } else {
            self.hand_over();
            self.hand_over_angle();
        }
        let dry = self.motion.path.end.is_some_and(|end| end <= now);
        if dry && !self.motion.path.is_at_rest() {
            self.late(say::motion_not_in_time());
            return;
        }
        if dry && !self.angle.is_engaged() {
            self.motion.path.end_if_made();
        }
        self.verify(self.clock.at(self.session.now) as Ticks);
    }

    /// Queries the board's count for the comparison with the commanded position, when the axes are
    /// at standstill and no motion is queued.
    fn verify(&mut self, now: Ticks) {
        let settled = self.clock.ticks(SETTLED) as Ticks;
        let made = self
            .motion
            .queue
            .last_step
            .is_some_and(|last| now >= last + settled);
        let queued = self.motion.queue.is_waiting() || self.wire.send_queue.is_congested();
        let moving = self.session.state == LinkState::Moving && self.stopping.is_none();
        if moving && made && !queued && self.query.pending.is_none() {
            self.query_position(QueryPurpose::Verify);
        } else if self.session.now >= self.query.look_due && self.may_look() {
            self.query.look_due = self.session.now + LOOK_EVERY;
            self.query_position(QueryPurpose::Look { requested: false });
        }
    }

    pub(super) fn may_look(&self) -> bool {
        self.session.state == LinkState::Ready
            && self.stopping.is_none()
            && self.query.pending.is_none()
            && !self.motion.is_under_way()
    }

    /// Handles the answer to a position query by its `purpose`. `board` is the board's count,
    /// pulses.
    pub(super) fn position_answered(&mut self, purpose: QueryPurpose, board: PerAxis<Pulses>) {
        match purpose {
            QueryPurpose::Stopped => self.stopped(board),
            QueryPurpose::ShutDown => {
                let kernel = self.motion.count.to_kernel(board);
                self.motion.count.board = Some(board);
                self.motion.stand_at(kernel);
                // The position is counted; the shutdown has switched the drives off.
                self.session.replace_uncertainty(Uncertainty::Powerless);
            }
            QueryPurpose::Opening => {
                self.motion.count.board = Some(board);
                self.session.enter(LinkState::Locked);
            }
            QueryPurpose::Verify | QueryPurpose::Look { .. } => {
                self.motion.count.board = Some(board);
                let kernel = self.motion.count.to_kernel(board);
                let commanded = self.motion.count.commanded;
                if purpose != (QueryPurpose::Look { requested: false }) {
                    self.session.events.push(LinkEvent::Position(kernel));
                }
                if kernel == commanded && purpose != QueryPurpose::Verify {
                    return;
                }
                if kernel == commanded {
                    self.session.events.push(LinkEvent::Drained);
                    self.session.enter(self.session.standing_state());
                    return;
                }
                self.lose_position(Uncertainty::Differs);
                let text = say::board_counts_otherwise(
                    commanded.x.0,
                    commanded.z.0,
                    kernel.x.0,
                    kernel.z.0,
                );
                self.session.alarm(alarm::POSITION_CHECK, text);
                self.give_up_motion();
                self.motion.stand_at(kernel);
                self.session.enter(LinkState::Locked);
            }
        }
    }
}
