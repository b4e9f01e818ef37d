//! Motion in the board: what was handed over, and where on it the axes stand.

use std::collections::VecDeque;

use super::super::super::limits::Limits;
use super::super::super::{FINE, HostTime, LinkConfig, RunTime, Sample};
use super::super::fit::Ticks;
use super::super::pace::Pace;
use super::super::rates::Rates;
use super::super::steps::{Entry, Steps};
use crate::units::{PerAxis, Pulses};

/// Places of the board's queue that are never used.
const SPARE: usize = 32;

/// To either side of the stop, for the speed there.
const AVERAGED: usize = 10;
/// Pulses from where an axis turned round it may have stopped on the way there or back.
const TURNING: i64 = 3;

/// A sample as the board has it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) sample: Sample,
    pub(super) clock: Ticks,
}

/// Where and how the axes were stopped.
pub(super) struct Stopped {
    pub(super) kernel: PerAxis<Pulses>,
    /// The place lies on the commanded path.
    pub(super) on_path: bool,
    /// Speed there, mm/min, and the way on which each axis came there.
    pub(super) speed: f64,
    pub(super) way: [i64; 2],
}

/// Motion handed over.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    pub(super) steps: [Steps; 2],
    pub(super) rates: Rates,
    /// Places of the board's queue.
    pub(super) queue: usize,
    pub(super) newest: Sample,
    /// Place of the last sample taken.
    pub(super) commanded: PerAxis<Pulses>,
    /// The board's count and the kernel's were put together.
    pub(super) placed: bool,
    /// Board pulses minus kernel pulses.
    pub(super) offset: PerAxis<i64>,
    /// Where the board stood when it was last asked.
    pub(super) board: Option<PerAxis<Pulses>>,
    /// Clock of the end of the newest sample that was more than rest, and its time;
    /// none: no motion runs.
    pub(super) end: Option<Ticks>,
    pub(super) end_run: RunTime,
    /// The newest sample moved nothing; the kernel said it stands.
    pub(super) rested: bool,
    pub(super) finished: bool,
    /// Rest takes its place all the same.
    pub(super) keeps_time: bool,
    pub(super) pieces: VecDeque<Piece>,
    pub(super) made: VecDeque<Piece>,
    pub(super) executed: RunTime,
    pub(super) flush_due: Option<HostTime>,
    pub(super) pace: Pace,
    pub(super) backlog: VecDeque<(usize, Entry)>,
    /// Clocks of the first steps of what the board has in its queue.
    pub(super) queued: VecDeque<Ticks>,
    pub(super) last_step: Option<Ticks>,
    pub(super) limits: Limits,
}

impl Motion {
    pub(super) fn new(pulses_per_mm: [f64; 2]) -> Self {
        let rates = Rates::unknown();
        Self {
            steps: [Steps::new(rates.timing[0]), Steps::new(rates.timing[1])],
            rates,
            queue: 0,
            newest: Sample::new(RunTime::ZERO, PerAxis::default()),
            commanded: PerAxis::default(),
            placed: false,
            offset: PerAxis::default(),
            board: None,
            end: None,
            end_run: RunTime::ZERO,
            rested: true,
            finished: true,
            keeps_time: false,
            pieces: VecDeque::new(),
            made: VecDeque::new(),
            executed: RunTime::ZERO,
            flush_due: None,
            pace: Pace::default(),
            backlog: VecDeque::new(),
            queued: VecDeque::new(),
            last_step: None,
            limits: Limits::new(pulses_per_mm),
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
        self.end.is_some() && !(self.rested && self.pieces.is_empty()) || self.is_waiting()
    }

    /// Everything queued is dropped, here and in the board.
    pub(super) fn drop_queued(&mut self) {
        self.forget_steps();
        self.backlog.clear();
        self.queued.clear();
        self.flush_due = None;
        self.pace = Pace::default();
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
        self.placed = true;
        self.stand_at(kernel);
        self.executed = at;
        self.newest.end = at;
    }

    /// The axes stand at this place of the kernel.
    pub(super) fn stand_at(&mut self, kernel: PerAxis<Pulses>) {
        self.drop_queued();
        self.commanded = kernel;
        self.newest = Sample::new(self.newest.end, kernel);
        self.pieces.clear();
        self.made.clear();
    }

    /// The axes stand where they were at a clock.
    pub(super) fn stand_unread(&mut self, clock: Ticks) {
        let mut made = self.made.iter().chain(&self.pieces);
        let until = made.clone().take_while(|piece| piece.clock <= clock).last();
        if let Some(piece) = until.or(made.next()).copied() {
            self.stand_at(piece.sample.pulses);
        }
    }

    /// What the board counts, with the high bits it does not tell.
    pub(super) fn board_counts(&self, [x, z]: [u32; 2], config: &LinkConfig) -> PerAxis<Pulses> {
        let known = self.board.unwrap_or_default();
        let whole = |low: u32, invert: bool, known: i64| {
            let low = if invert { low.wrapping_neg() } else { low };
            Pulses(known + i64::from(low.wrapping_sub(known as u32) as i32))
        };
        PerAxis::new(
            whole(x, config.x.is_turned_over(), known.x.0),
            whole(z, config.z.is_turned_over(), known.z.0),
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
            way = [0, 1].map(|axis| way_to(&places[..=place + 1], axis));
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

    /// Pulses have not gone out yet.
    pub(super) fn is_waiting(&self) -> bool {
        !self.backlog.is_empty() || self.steps.iter().any(|steps| !steps.is_empty())
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

    pub(super) const fn newest_end(&self) -> RunTime {
        self.newest.end
    }

    /// The piece of motion under way at a time, or the last one before it.
    pub(super) fn piece_at(&self, at: RunTime) -> Option<Piece> {
        let piece = self.pieces.partition_point(|piece| piece.sample.end < at);
        self.pieces.get(piece).or(self.pieces.back()).copied()
    }
}

/// The way on which an axis came to the last of these places; 0: it stood, or has just
/// turned round.
fn way_to(places: &[Sample], axis: usize) -> i64 {
    let at = |place: &Sample| [place.fine.x, place.fine.z][axis];
    let Some(end) = places.last().map(at) else {
        return 0;
    };
    let mut way = 0;
    for (count, pair) in places.windows(2).rev().enumerate() {
        if count >= AVERAGED && (end - at(&pair[0])).abs() > TURNING * FINE {
            break;
        }
        let moved = (at(&pair[1]) - at(&pair[0])).signum();
        if moved == -way && moved != 0 {
            return 0;
        }
        way = if moved == 0 { way } else { moved };
    }
    way
}
