//! Motion in the board: what is sent, what is made, and whether the counts agree.

use core::time::Duration;
use std::collections::VecDeque;

use super::super::super::{
    Event, FINE, HostTime, Input, LinkConfig, LinkState, Refused, RunTime, Sample,
};
use super::super::commands::Command;
use super::super::fit::Ticks;
use super::super::rates::Rates;
use super::super::steps::{Entry, Steps, Stretch};
use super::{Purpose, StepLink};
use crate::units::{Axis, PerAxis, Pulses};

/// Pulses are fitted and sent so often.
const FLUSH_EVERY: Duration = Duration::from_millis(10);
/// Standing so long before the count is compared.
const SETTLED: Duration = Duration::from_millis(50);
/// Places of the board's queue that are never used.
const SPARE: usize = 32;
/// Messages that wait for the wire; more motion is not taken.
const MOST_WAITING: usize = 1500;
/// Samples remembered behind the axes, to tell where on the path a stop was.
const REMEMBERED: usize = 800;

/// To either side of the stop, for the speed there.
const AVERAGED: usize = 10;

/// A sample as the board has it.
#[derive(Clone, Copy, Debug)]
struct Piece {
    sample: Sample,
    clock: Ticks,
}

/// Where and how the axes were stopped.
pub(super) struct Stopped {
    pub(super) kernel: PerAxis<Pulses>,
    /// The place lies on the commanded path.
    pub(super) on_path: bool,
    /// Speed there, mm/min, and way of each axis.
    pub(super) speed: f64,
    pub(super) way: [i64; 2],
}

/// Motion handed over.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    steps: [Steps; 2],
    rates: Rates,
    /// Places of the board's queue.
    queue: usize,
    newest: Sample,
    /// Place of the last sample taken.
    pub(super) commanded: PerAxis<Pulses>,
    /// Board pulses minus kernel pulses.
    offset: PerAxis<i64>,
    /// Where the board stood when it was last asked.
    pub(super) board: Option<PerAxis<Pulses>>,
    /// Clock of the end of the newest sample that was more than rest, and its time;
    /// none: no motion runs.
    end: Option<Ticks>,
    end_run: RunTime,
    /// The newest sample moved nothing; the kernel said it stands.
    rested: bool,
    finished: bool,
    pieces: VecDeque<Piece>,
    made: VecDeque<Piece>,
    executed: RunTime,
    flush_due: Option<HostTime>,
    backlog: VecDeque<(usize, Entry)>,
    /// Clocks of the first steps of what the board has in its queue.
    queued: VecDeque<Ticks>,
    last_step: Option<Ticks>,
    /// Way of each axis on which its operated limit switch lies.
    blocked: [i64; 2],
}

impl Motion {
    pub(super) fn new() -> Self {
        let rates = Rates::unknown();
        Self {
            steps: [Steps::new(rates.timing[0]), Steps::new(rates.timing[1])],
            rates,
            queue: 0,
            newest: Sample::new(RunTime::ZERO, PerAxis::default()),
            commanded: PerAxis::default(),
            offset: PerAxis::default(),
            board: None,
            end: None,
            end_run: RunTime::ZERO,
            rested: true,
            finished: true,
            pieces: VecDeque::new(),
            made: VecDeque::new(),
            executed: RunTime::ZERO,
            flush_due: None,
            backlog: VecDeque::new(),
            queued: VecDeque::new(),
            last_step: None,
            blocked: [0; 2],
        }
    }

    pub(super) fn set_up(&mut self, config: &LinkConfig, processor: &str, rate: f64) {
        self.rates = Rates::new(config, processor, rate);
        self.steps = self.rates.timing.map(Steps::new);
    }

    pub(super) const fn set_queue(&mut self, places: u32) {
        self.queue = (places as usize).saturating_sub(SPARE);
    }

    /// The board has been reset, or is a new one.
    pub(super) fn forget_board(&mut self) {
        self.drop_queued();
        self.board = None;
        self.last_step = None;
        self.blocked = [0; 2];
    }

    pub(super) fn forget_steps(&mut self) {
        for steps in &mut self.steps {
            steps.forget();
        }
    }

    pub(super) const fn last_step(&self) -> Option<u64> {
        match self.last_step {
            Some(clock) => Some(clock.unsigned_abs()),
            None => None,
        }
    }

    /// Steps are queued or being made.
    pub(super) fn is_under_way(&self) -> bool {
        self.end.is_some() && !(self.rested && self.pieces.is_empty())
            || !self.backlog.is_empty()
            || self.steps.iter().any(|steps| !steps.is_empty())
    }

    /// Everything queued is dropped, here and in the board.
    pub(super) fn drop_queued(&mut self) {
        self.forget_steps();
        self.backlog.clear();
        self.queued.clear();
        self.flush_due = None;
        self.end = None;
        self.finished = true;
        self.rested = true;
    }

    /// The axes stand at this place of the kernel, and of the board.
    pub(super) fn take_over(
        &mut self,
        kernel: PerAxis<Pulses>,
        board: PerAxis<Pulses>,
        at: RunTime,
    ) {
        self.offset = PerAxis::new(board.x.0 - kernel.x.0, board.z.0 - kernel.z.0);
        self.stand_at(kernel);
        self.executed = at;
        self.newest.end = at;
    }

    fn stand_at(&mut self, kernel: PerAxis<Pulses>) {
        self.drop_queued();
        self.commanded = kernel;
        self.newest = Sample::new(self.newest.end, kernel);
        self.pieces.clear();
        self.made.clear();
    }

    /// What the board counts, with the high bits it does not tell.
    pub(super) fn board_counts(&self, [x, z]: [u32; 2], config: &LinkConfig) -> PerAxis<Pulses> {
        let known = self.board.unwrap_or_default();
        let whole = |low: u32, invert: bool, known: i64| {
            let low = if invert { low.wrapping_neg() } else { low };
            Pulses(known + i64::from(low.wrapping_sub(known as u32) as i32))
        };
        PerAxis::new(
            whole(x, config.x.invert_direction, known.x.0),
            whole(z, config.z.invert_direction, known.z.0),
        )
    }

    /// Where on the commanded path the board stopped.
    pub(super) fn stopped_at(
        &mut self,
        board: PerAxis<Pulses>,
        now: u64,
        pulses_per_mm: [f64; 2],
    ) -> Stopped {
        let kernel = PerAxis::new(
            Pulses(board.x.0 - self.offset.x),
            Pulses(board.z.0 - self.offset.z),
        );
        let (x, z) = (kernel.x.0, kernel.z.0);
        // What the board cannot have made yet is no place to stand.
        let begun = self
            .pieces
            .partition_point(|piece| piece.clock.unsigned_abs() <= now);
        let ahead = self.pieces.iter().take(begun.max(1));
        let places: Vec<Sample> = self
            .made
            .iter()
            .chain(ahead)
            .map(|piece| piece.sample)
            .collect();
        let within =
            |a: Pulses, b: Pulses, at: i64| (a.0.min(b.0) - 1..=a.0.max(b.0) + 1).contains(&at);
        // From behind: after a reversal the later place is the likelier.
        let place = places.windows(2).rposition(|pair| {
            within(pair[0].pulses.x, pair[1].pulses.x, x)
                && within(pair[0].pulses.z, pair[1].pulses.z, z)
        });
        let (mut speed, mut way) = (0.0, [0; 2]);
        if let Some(place) = place {
            // Over some samples: one alone may have a pulse more or less.
            let from = places[place.saturating_sub(AVERAGED)];
            let to = places[(place + AVERAGED).min(places.len() - 1)];
            let moved = [to.fine.x - from.fine.x, to.fine.z - from.fine.z];
            let minutes = (to.end.saturating_sub(from.end)).as_secs_f64().max(1e-3) / 60.0;
            let [x, z] = [0, 1].map(|axis| moved[axis] as f64 / FINE as f64 / pulses_per_mm[axis]);
            speed = libm::hypot(x, z) / minutes;
            way = moved.map(i64::signum);
            self.executed = self.executed.max(places[place].end);
        }
        let on_path = place.is_some() || places.last().is_none_or(|last| last.pulses == kernel);
        self.stand_at(kernel);
        self.board = Some(board);
        self.last_step = None;
        Stopped {
            kernel,
            on_path,
            speed,
            way,
        }
    }

    /// Beyond its limit switch the axis is not moved.
    pub(super) const fn block(&mut self, axis: usize, way: [i64; 2]) {
        self.blocked[axis] = way[axis];
    }

    pub(super) const fn unblock(&mut self) {
        self.blocked = [0; 2];
    }

    /// The board's count in the kernel's pulses.
    pub(super) fn counted(&self) -> Option<PerAxis<Pulses>> {
        self.board.map(|board| {
            PerAxis::new(
                Pulses(board.x.0 - self.offset.x),
                Pulses(board.z.0 - self.offset.z),
            )
        })
    }

    pub(super) const fn max_rate(&self) -> f64 {
        self.rates.each()
    }

    pub(super) const fn newest_end(&self) -> RunTime {
        self.newest.end
    }

    /// Board clock of a time of commanded motion.
    pub(super) fn clock_of(&self, at: RunTime) -> Option<u64> {
        let piece = self.pieces.iter().find(|piece| piece.sample.end >= at);
        piece
            .or(self.pieces.back())
            .map(|piece| piece.clock.unsigned_abs())
    }
}

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
        if !self.is_prepared()
            || !self.motion.backlog.is_empty()
            || self.delivery.backlog() > MOST_WAITING
        {
            return Duration::ZERO;
        }
        let now = self.clock.at(self.now) as Ticks;
        let ticks = |duration| self.clock.ticks(duration) as Ticks;
        let begin = now + ticks(self.config.lookahead());
        let end = self.motion.end.unwrap_or(begin);
        // Besides the lookahead, the time it takes to the board: a pause of the host
        // as long as the lookahead does no harm.
        let most = begin + ticks(self.margin() + FLUSH_EVERY);
        self.clock.duration((most - end).max(0).unsigned_abs())
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
        for (axis, input) in [Input::LimitX, Input::LimitZ].into_iter().enumerate() {
            let blocked = self.motion.blocked[axis];
            if blocked != 0 && moves[axis].signum() == blocked && self.input(input) == Some(true) {
                return Err(Refused::TowardLimit([Axis::X, Axis::Z][axis]));
            }
        }
        let now = self.clock.at(self.now) as Ticks;
        let begin = now + self.clock.ticks(self.config.lookahead()) as Ticks;
        let late = self.earliest() as Ticks;
        let rests = !moved && sample.fine == before.fine;
        if rests && self.motion.finished {
            // Rest takes no place in the board.
            self.motion.newest = sample;
            if self.motion.end.is_none() {
                self.motion.executed = sample.end;
            }
            return Ok(());
        }
        let rest = before.end.saturating_sub(self.motion.end_run);
        let rest = self.clock.ticks(rest) as Ticks;
        let from = match self.motion.end {
            Some(end) if end + rest >= late => (end + rest).min(begin).max(end),
            // Out of rest it may begin later.
            Some(_) if self.motion.rested || self.motion.finished => begin,
            Some(_) => {
                self.late("the kernel has not handed over motion in time");
                return Err(Refused::NotReady);
            }
            None => begin,
        };
        self.reading = self
            .reading
            .filter(|reading| reading.purpose != Purpose::Verify);
        let end = from + self.clock.ticks(duration) as Ticks;
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

    /// Pulses due become runs.
    fn fit(&mut self) {
        self.motion.flush_due = None;
        let now = self.clock.at(self.now) as Ticks;
        let mut entries = Vec::new();
        for (axis, steps) in self.motion.steps.iter_mut().enumerate() {
            let mut fitted = Vec::new();
            steps.fit(now, &mut fitted);
            entries.extend(fitted.into_iter().map(|entry| (axis, entry)));
        }
        entries.sort_by_key(|(_, entry)| entry.first);
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
                0 => (axes.x, self.config.x.invert_direction),
                _ => (axes.z, self.config.z.invert_direction),
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
        if self.motion.flush_due.is_some_and(|due| self.now >= due) {
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
        let queued = !self.motion.backlog.is_empty()
            || self.motion.steps.iter().any(|steps| !steps.is_empty());
        let moving = self.state == LinkState::Moving && self.stopping.is_none();
        if moving && made && !queued && self.reading.is_none() {
            self.read_place(Purpose::Verify);
        }
    }

    /// The board said where the axes stand.
    pub(super) fn place_read(&mut self, purpose: Purpose, board: PerAxis<Pulses>) {
        match purpose {
            Purpose::Stopped => self.stopped(board),
            Purpose::Opening => {
                self.motion.board = Some(board);
                self.enter(LinkState::Locked);
            }
            Purpose::Verify => {
                let motion = &mut self.motion;
                motion.board = Some(board);
                let (x, z) = (board.x.0 - motion.offset.x, board.z.0 - motion.offset.z);
                let kernel = PerAxis::new(Pulses(x), Pulses(z));
                let commanded = motion.commanded;
                self.events.push(Event::Position(kernel));
                if kernel == commanded {
                    self.events.push(Event::Drained);
                    self.enter(if self.known {
                        LinkState::Ready
                    } else {
                        LinkState::Locked
                    });
                    return;
                }
                self.lose_position();
                let text = format!(
                    "commanded X {} Z {} pulses, the board counts X {x} Z {z}",
                    commanded.x.0, commanded.z.0
                );
                self.alarm(611, &text);
                self.give_up_motion();
                self.enter(LinkState::Locked);
            }
        }
    }
}
