//! The commanded path, behind the axes and before them, and where on it they stopped.

use std::collections::VecDeque;

use crate::step_queue::step_compress::Ticks;
use crate::{FINE, RunTime, Sample};
use gsk_units::{PerAxis, Pulses};

/// Samples remembered behind the axes, to tell where on the path a stop was.
const REMEMBERED: usize = 800;
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

/// The commanded path, behind the axes and before them.
#[derive(Clone, Debug)]
pub(super) struct Path {
    pub(super) newest: Sample,
    /// Clock of the end of the newest sample that was more than rest, and its time;
    /// none: no motion runs.
    pub(super) end: Option<Ticks>,
    end_run: RunTime,
    /// The newest sample moved nothing; the kernel said it stands.
    pub(super) rested: bool,
    pub(super) finished: bool,
    /// Rest takes its place all the same.
    pub(super) keeps_time: bool,
    pieces: VecDeque<Piece>,
    made: VecDeque<Piece>,
    pub(super) executed: RunTime,
}

/// Where on the path the axes were stopped.
pub(super) struct Located {
    /// Speed there, mm/min, and the way on which each axis came there.
    pub(super) speed: f64,
    pub(super) way: [i64; 2],
}

impl Path {
    pub(super) const fn new() -> Self {
        Self {
            newest: Sample::new(RunTime::ZERO, PerAxis::new(Pulses(0), Pulses(0))),
            end: None,
            end_run: RunTime::ZERO,
            rested: true,
            finished: true,
            keeps_time: false,
            pieces: VecDeque::new(),
            made: VecDeque::new(),
            executed: RunTime::ZERO,
        }
    }

    /// No motion runs.
    pub(super) const fn end_motion(&mut self) {
        self.end = None;
        self.finished = true;
        self.rested = true;
    }

    /// The axes stand at this position of the kernel.
    pub(super) fn stand_at(&mut self, kernel: PerAxis<Pulses>) {
        self.newest = Sample::new(self.newest.end, kernel);
        self.pieces.clear();
        self.made.clear();
    }

    /// The newest sample takes the board between these clocks.
    pub(super) fn push(&mut self, sample: Sample, from: Ticks, end: Ticks, rests: bool) {
        if self.end != Some(from) {
            // The position where this motion begins.
            let sample = self.newest;
            self.pieces.push_back(Piece {
                sample,
                clock: from,
            });
        }
        self.pieces.push_back(Piece { sample, clock: end });
        self.end = Some(end);
        self.end_run = sample.end;
        self.rested = rests;
        self.finished = false;
        self.newest = sample;
    }

    /// A sample of rest that takes no time in the board.
    pub(super) const fn rest(&mut self, sample: Sample) {
        self.newest = sample;
        if self.end.is_none() {
            self.executed = sample.end;
        }
    }

    /// Rest behind the end of the motion.
    pub(super) const fn rest_after_end(&self) -> RunTime {
        self.newest.end.saturating_sub(self.end_run)
    }

    /// The next sample may come any time later.
    pub(super) const fn is_at_rest(&self) -> bool {
        self.rested || self.finished
    }

    /// Motion is under way, or was handed over.
    pub(super) fn is_under_way(&self) -> bool {
        self.end.is_some() && !(self.rested && self.pieces.is_empty())
    }

    /// What is over by a clock is made.
    pub(super) fn pass(&mut self, now: Ticks) {
        while let Some(piece) = self.pieces.pop_front_if(|piece| piece.clock <= now) {
            self.executed = self.executed.max(piece.sample.end);
            self.made.push_back(piece);
            if self.made.len() > REMEMBERED {
                self.made.pop_front();
            }
        }
    }

    /// Motion has ended, and all of it is made.
    pub(super) fn end_if_made(&mut self) {
        if self.pieces.is_empty() {
            self.end = None;
        }
    }

    /// Where each axis was at a clock.
    pub(super) fn at(&self, clocks: [Ticks; 2]) -> Option<PerAxis<Pulses>> {
        let at = |clock: Ticks| {
            let mut made = self.made.iter().chain(&self.pieces);
            let until = made.clone().take_while(|piece| piece.clock <= clock).last();
            until.or(made.next()).map(|piece| piece.sample.pulses)
        };
        let [x, z] = clocks.map(at);
        Some(PerAxis::new(x?.x, z?.z))
    }

    /// The piece of motion under way at a time, or the last one before it.
    pub(super) fn piece_at(&self, at: RunTime) -> Option<Piece> {
        let piece = self.pieces.partition_point(|piece| piece.sample.end < at);
        self.pieces.get(piece).or(self.pieces.back()).copied()
    }

    /// Where the board may be by now: what it cannot have made yet is no position to stand at.
    fn reached(&self, now: u64) -> Vec<Sample> {
        let begun = self
            .pieces
            .partition_point(|piece| piece.clock.unsigned_abs() <= now);
        let ahead = self.pieces.iter().take(begun.max(1));
        let reached = self.made.iter().chain(ahead);
        reached.map(|piece| piece.sample).collect()
    }

    /// Where on the path this position lies, and whether it lies on it at all: with no
    /// motion to go by the axes must not have moved.
    pub(super) fn locate(
        &mut self,
        kernel: PerAxis<Pulses>,
        now: u64,
        pulses_per_mm: [f64; 2],
    ) -> (bool, Located) {
        let (x, z) = (kernel.x.0, kernel.z.0);
        let path = self.reached(now);
        let within =
            |a: Pulses, b: Pulses, at: i64| (a.0.min(b.0) - 1..=a.0.max(b.0) + 1).contains(&at);
        // From behind: after a reversal the later one is the likelier.
        let found = path.windows(2).rposition(|pair| {
            within(pair[0].pulses.x, pair[1].pulses.x, x)
                && within(pair[0].pulses.z, pair[1].pulses.z, z)
        });
        let Some(found) = found else {
            let on_path = path.last().is_none_or(|last| last.pulses == kernel);
            let (speed, way) = (0.0, [0; 2]);
            return (on_path, Located { speed, way });
        };
        // Over some samples: one alone may have a pulse more or less.
        let from = path[found.saturating_sub(AVERAGED)];
        let to = path[(found + AVERAGED).min(path.len() - 1)];
        let moved = [to.fine.x - from.fine.x, to.fine.z - from.fine.z];
        let minutes = (to.end.saturating_sub(from.end)).as_secs_f64().max(1e-3) / 60.0;
        let [x, z] = [0, 1].map(|axis| moved[axis] as f64 / FINE as f64 / pulses_per_mm[axis]);
        self.executed = self.executed.max(path[found].end);
        let located = Located {
            speed: libm::hypot(x, z) / minutes,
            way: [0, 1].map(|axis| way_to(&path[..=found + 1], axis)),
        };
        (true, located)
    }
}

/// The way on which an axis came to the last of these samples; 0: it stood, or has just
/// turned round.
fn way_to(samples: &[Sample], axis: usize) -> i64 {
    let at = |sample: &Sample| [sample.fine.x, sample.fine.z][axis];
    let Some(end) = samples.last().map(at) else {
        return 0;
    };
    let mut way = 0;
    for (count, pair) in samples.windows(2).rev().enumerate() {
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
