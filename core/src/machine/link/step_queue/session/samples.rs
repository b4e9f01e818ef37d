//! Samples of the kernel go to the board as steps, and their counts come back.

use core::time::Duration;

use super::super::super::{Doubt, Event, Input, LinkState, Refused, RunTime, Sample};
use super::super::commands::Command;
use super::super::fit::Ticks;
use super::super::steps::{Steps, Stretch};
use super::motion::Piece;
use super::{Purpose, StepLink};
use crate::units::{PerAxis, Pulses};

/// Pulses are fitted and sent so often.
const FLUSH_EVERY: Duration = Duration::from_millis(10);
/// Pulses that can wait are fitted together with later ones, up to this before they
/// have to be on their way.
const LEAST_SLACK: Duration = Duration::from_millis(45);
/// How many times as far from its time a step may lie, by the time it has left.
const COARSER: [(Duration, Ticks); 4] = [
    (Duration::from_millis(70), 1),
    (Duration::from_millis(50), 2),
    (Duration::from_millis(30), 4),
    (Duration::from_millis(10), 8),
];
const COARSEST: Ticks = 16;
/// The count of standing axes is compared so often.
const LOOK_EVERY: Duration = Duration::from_secs(1);
/// Standing so long before the count is compared.
const SETTLED: Duration = Duration::from_millis(50);
/// Messages that wait for the wire; more motion is not taken.
const MOST_WAITING: usize = 1500;
/// Samples remembered behind the axes, to tell where on the path a stop was.
const REMEMBERED: usize = 800;

impl StepLink {
    /// Motion the board has certainly made, as time since the opening.
    pub const fn executed(&self) -> RunTime {
        self.motion.executed
    }

    /// Motion handed over that may not have been made yet.
    pub fn outstanding(&self) -> Duration {
        let now = self.clock.at(self.now) as Ticks;
        let end = self.motion.end.map_or(0, |end| (end - now).max(0));
        self.clock.duration(end.unsigned_abs())
    }

    /// How much more motion may be handed over now.
    pub fn room(&self) -> Duration {
        if !self.is_prepared() {
            return Duration::ZERO;
        }
        if !self.motion.backlog.is_empty() || self.delivery.backlog() > MOST_WAITING {
            return Duration::ZERO;
        }
        let most = self.farthest();
        let room = self.clock.ticks(self.margin() + FLUSH_EVERY) as Ticks;
        let end = self.motion.end.unwrap_or(most - room);
        self.clock.duration((most - end).max(0).unsigned_abs())
    }

    /// How far the motion handed over now may reach. Besides the lookahead, the time it
    /// takes to the board: a pause of the host as long as the lookahead does no harm.
    fn farthest(&self) -> Ticks {
        let reach = self.ahead() + self.margin() + FLUSH_EVERY;
        self.clock.at(self.now + reach) as Ticks
    }

    /// Hands over where the axes are to be at the end of a tick.
    ///
    /// # Errors
    /// The state takes no motion, or the board could not follow; nothing was sent.
    pub fn push(&mut self, sample: Sample) -> Result<(), Refused> {
        if !self.is_prepared() {
            return Err(Refused::NotReady);
        }
        let before = self.motion.newest;
        let duration = sample.end.saturating_sub(before.end);
        let moves = [
            sample.pulses.x.0 - before.pulses.x.0,
            sample.pulses.z.0 - before.pulses.z.0,
        ];
        let moved = moves != [0; 2];
        if duration.is_zero() {
            return if moved {
                Err(Refused::NotReady)
            } else {
                Ok(())
            };
        }
        self.motion.rates.allow(moves, duration.as_secs_f64())?;
        if moved {
            let operated = [Input::LimitX, Input::LimitZ].map(|input| self.input(input));
            self.motion.limits.allow(moves, operated)?;
        }
        let rests = !moved && sample.fine == before.fine;
        if rests && self.motion.finished && !self.motion.keeps_time {
            // Rest takes no place in the board.
            self.motion.newest = sample;
            if self.motion.end.is_none() {
                self.motion.executed = sample.end;
            }
            return Ok(());
        }
        if self.is_too_late() || (!rests && self.spindle.is_torn()) {
            self.late("the kernel has not handed over motion in time");
            return Err(Refused::NotReady);
        }
        let from = self.next_begin();
        if !rests {
            // A question where the axes stand is idle now.
            self.reading = self.reading.filter(|reading| {
                !matches!(reading.purpose, Purpose::Verify | Purpose::Look { .. })
            });
        }
        let need = self.delivery.time_for(self.motion.pace.expected());
        let need = need.saturating_sub(self.slowness() / 2);
        let slower = self.motion.pace.slower(duration, need);
        let slower = if self.motion.keeps_time { 1.0 } else { slower };
        let end = from + self.clock.ticks(duration.mul_f64(slower)) as Ticks;
        for (axis, steps) in self.motion.steps.iter_mut().enumerate() {
            let pair = |values: PerAxis<i64>| if axis == 0 { values.x } else { values.z };
            let count = |sample: &Sample| pair(PerAxis::new(sample.pulses.x.0, sample.pulses.z.0));
            steps.sample(Stretch {
                clock: [from, end],
                count: [count(&before), count(&sample)],
                fine: [pair(before.fine), pair(sample.fine)],
            });
        }
        let motion = &mut self.motion;
        if motion.end != Some(from) {
            // The place where this motion begins.
            motion.pieces.push_back(Piece {
                sample: before,
                clock: from,
            });
        }
        motion.pieces.push_back(Piece { sample, clock: end });
        motion.end = Some(end);
        motion.end_run = sample.end;
        motion.rested = rests;
        motion.finished = false;
        motion.newest = sample;
        motion.commanded = sample.pulses;
        motion.flush_due.get_or_insert(self.now + FLUSH_EVERY);
        if moved {
            motion.last_step = None;
            self.enter(LinkState::Moving);
        }
        Ok(())
    }

    /// Board clock at which the motion handed over so far is over, rest behind it
    /// counted; none: there is none.
    fn end_of_rest(&self) -> Option<(Ticks, Ticks)> {
        let end = self.motion.end?;
        let rest = (self.motion.newest.end).saturating_sub(self.motion.end_run);
        Some((end, end + self.clock.ticks(rest) as Ticks))
    }

    /// Whether moving axes are without motion by now.
    fn is_too_late(&self) -> bool {
        let rests = self.motion.rested || self.motion.finished;
        let late = self.earliest() as Ticks;
        !rests && self.end_of_rest().is_some_and(|(_, rest)| rest < late)
    }

    /// Board clock at which motion begins that is handed over now.
    pub(super) fn next_begin(&self) -> Ticks {
        let begin = self.farthest();
        match self.end_of_rest() {
            Some((end, rest)) if rest >= self.earliest() as Ticks => rest.min(begin).max(end),
            // Out of rest it may begin later.
            _ => begin,
        }
    }

    /// The kernel stands: what is left of the motion goes out.
    ///
    /// # Errors
    /// None; the other back end has some.
    pub fn finish(&mut self) -> Result<(), Refused> {
        self.motion.finished = true;
        self.fit();
        self.send();
        Ok(())
    }

    /// Time until the first pulse that is not fitted has to be on its way, so that
    /// there is time to say it again.
    fn slack(&self) -> Duration {
        let first = self.motion.steps.iter().filter_map(Steps::first).min();
        let first = first.map_or(0, Ticks::unsigned_abs);
        let slack = self.clock.duration(first.saturating_sub(self.earliest()));
        slack.saturating_sub(self.slowness())
    }

    fn slowness(&self) -> Duration {
        self.delivery.slowness_now(self.now)
    }

    /// Pulses due become runs. What has had to wait becomes fewer and longer ones:
    /// they keep the times of the pulses less exactly.
    fn fit(&mut self) {
        let slack = self.slack().saturating_sub(self.slowness());
        let coarse = COARSER.iter().find(|(least, _)| slack >= *least);
        let coarse = coarse.map_or(COARSEST, |(_, coarse)| *coarse);
        self.motion.flush_due = None;
        let now = self.clock.at(self.now) as Ticks;
        let mut entries = Vec::new();
        for (axis, steps) in self.motion.steps.iter_mut().enumerate() {
            let mut fitted = Vec::new();
            steps.fit(now, coarse, &mut fitted);
            entries.extend(fitted.into_iter().map(|entry| (axis, entry)));
        }
        entries.sort_by_key(|(_, entry)| entry.first);
        let messages = entries.iter().map(|(_, entry)| entry.messages());
        self.motion.pace.fitted(messages.sum());
        self.motion.backlog.extend(entries);
        self.hand_over();
    }

    /// Runs go out as far as the queue of the board reaches.
    fn hand_over(&mut self) {
        let now = self.clock.at(self.now) as Ticks;
        let Some(axes) = self.wiring.as_ref().map(|wiring| wiring.axes) else {
            return;
        };
        self.motion.queued.retain(|first| *first > now);
        while self.motion.queued.len() < self.motion.queue {
            let Some((axis, entry)) = self.motion.backlog.pop_front() else {
                return;
            };
            let (oid, invert) = match axis {
                0 => (axes.x, self.config.x.is_turned_over()),
                _ => (axes.z, self.config.z.is_turned_over()),
            };
            let due = entry.first.unsigned_abs();
            if let Some(from) = entry.from {
                self.say_timed(Command::ResetStepClock, &[oid, i64::from(from as u32)], due);
            }
            if let Some(up) = entry.up {
                self.say_timed(
                    Command::SetNextStepDir,
                    &[oid, i64::from(up != invert)],
                    due,
                );
            }
            let run = entry.run;
            let arguments = [oid, run.interval.into(), run.count.into(), run.add.into()];
            self.say_timed(Command::QueueStep, &arguments, due);
            self.traffic.segments += 1;
            self.motion.queued.push_back(entry.first);
            let last = self.motion.last_step.unwrap_or(Ticks::MIN);
            self.motion.last_step = Some(last.max(entry.last));
        }
    }

    /// Time passes over the motion.
    pub(super) fn move_on(&mut self) {
        let now = self.clock.at(self.now) as Ticks;
        while let Some(piece) = self.motion.pieces.front().copied()
            && self.stopping.is_none()
            && piece.clock <= now
        {
            self.motion.pieces.pop_front();
            self.motion.executed = self.motion.executed.max(piece.sample.end);
            self.motion.made.push_back(piece);
            if self.motion.made.len() > REMEMBERED {
                self.motion.made.pop_front();
            }
        }
        let due = self.motion.flush_due.is_some_and(|due| self.now >= due);
        // On a line that is slow, or full, longer runs are better than more of them.
        let narrow = self.delivery.is_congested() || !self.slowness().is_zero();
        let may_wait = narrow && self.slack() >= LEAST_SLACK;
        if due && !may_wait {
            self.fit();
        } else {
            self.hand_over();
        }
        let dry = self.motion.end.is_some_and(|end| end <= now);
        if dry && !self.motion.rested && !self.motion.finished {
            self.late("the kernel has not handed over motion in time");
            return;
        }
        if dry && self.motion.pieces.is_empty() {
            self.motion.end = None;
        }
        self.verify(now);
    }

    /// When the board stands and nothing is queued, its count is compared.
    fn verify(&mut self, now: Ticks) {
        let settled = self.clock.ticks(SETTLED) as Ticks;
        let made = self
            .motion
            .last_step
            .is_some_and(|last| now >= last + settled);
        let queued = self.motion.is_waiting() || self.delivery.is_congested();
        let moving = self.state == LinkState::Moving && self.stopping.is_none();
        if moving && made && !queued && self.reading.is_none() {
            self.read_place(Purpose::Verify);
        } else if self.now >= self.look_due && self.may_look() {
            self.look_due = self.now + LOOK_EVERY;
            self.read_place(Purpose::Look { asked: false });
        }
    }

    fn may_look(&self) -> bool {
        self.state == LinkState::Ready
            && self.stopping.is_none()
            && self.reading.is_none()
            && !self.motion.is_under_way()
    }

    /// Compares the counts of standing axes now: [`Event::Position`] when they agree.
    /// Whether the board is asked.
    pub fn compare(&mut self) -> bool {
        let asks = self.may_look();
        if asks {
            self.read_place(Purpose::Look { asked: true });
        }
        asks
    }

    /// The board said where the axes stand.
    pub(super) fn place_read(&mut self, purpose: Purpose, board: PerAxis<Pulses>) {
        match purpose {
            Purpose::Stopped => self.stopped(board),
            Purpose::Opening => {
                self.motion.board = Some(board);
                self.enter(LinkState::Locked);
            }
            Purpose::Verify | Purpose::Look { .. } => {
                let motion = &mut self.motion;
                motion.board = Some(board);
                let (x, z) = (board.x.0 - motion.offset.x, board.z.0 - motion.offset.z);
                let kernel = PerAxis::new(Pulses(x), Pulses(z));
                let commanded = motion.commanded;
                if purpose != (Purpose::Look { asked: false }) {
                    self.events.push(Event::Position(kernel));
                }
                if kernel == commanded && purpose != Purpose::Verify {
                    return;
                }
                if kernel == commanded {
                    self.events.push(Event::Drained);
                    self.enter(if self.known {
                        LinkState::Ready
                    } else {
                        LinkState::Locked
                    });
                    return;
                }
                self.lose_position(Doubt::Differs);
                let text = format!(
                    "commanded X {} Z {} pulses, the board counts X {x} Z {z}",
                    commanded.x.0, commanded.z.0
                );
                self.alarm(611, &text);
                self.give_up_motion();
                self.motion.stand_at(kernel);
                self.enter(LinkState::Locked);
            }
        }
    }
}
