//! The commanded path, executed and pending, and the position of a stop on it.

use std::collections::VecDeque;

use crate::step_queue::step_compress::Ticks;
use crate::{FINE, RunTime, Sample};
use gsk_units::{PerAxis, Pulses};

/// Number of executed samples that are stored to find the position of a stop on the path.
const REMEMBERED: usize = 800;
/// Number of samples before and after the position of a stop from which the speed is computed.
const AVERAGED: usize = 10;
/// Distance from a reversal within which the direction before a stop is not certain, pulses.
const TURNING: i64 = 3;

/// A sample of the commanded position, and the board clock at its end, ticks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) sample: Sample,
    pub(super) clock: Ticks,
}

/// The commanded path: samples that are executed and samples that are pending.
#[derive(Clone, Debug)]
pub(super) struct Path {
    pub(super) newest: Sample,
    /// Board clock at the end of the motion, ticks; `None` without motion.
    pub(super) end: Option<Ticks>,
    /// Kernel time at the end of the last motion.
    end_run: RunTime,
    /// Whether the newest sample contains no motion.
    pub(super) rested: bool,
    /// Whether the kernel has reported a standstill.
    pub(super) finished: bool,
    /// Whether samples without motion delay the following motion in the board by their duration.
    pub(super) keeps_time: bool,
    pieces: VecDeque<Piece>,
    made: VecDeque<Piece>,
    pub(super) executed: RunTime,
}

/// Speed and directions of the axes at the position of a stop.
pub(super) struct Located {
    /// Speed of the axes before the stop, mm/min.
    pub(super) speed: f64,
    /// Direction of each axis before the stop, 1, -1 or 0.
    pub(super) direction: [i64; 2],
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

    /// Ends the motion: clears the board clock of its end and marks the path as finished and at
    /// rest.
    pub(super) const fn end_motion(&mut self) {
        self.end = None;
        self.finished = true;
        self.rested = true;
    }

    /// Stores `kernel`, in the kernel's pulses, as position of the axes at standstill, and drops
    /// all samples.
    pub(super) fn stand_at(&mut self, kernel: PerAxis<Pulses>) {
        self.newest = Sample::new(self.newest.end, kernel);
        self.pieces.clear();
        self.made.clear();
    }

    /// Adds a sample without motion that takes no time in the board.
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

    /// Adds a sample without motion that takes no time in the board.
    pub(super) const fn rest(&mut self, sample: Sample) {
        self.newest = sample;
        if self.end.is_none() {
            self.executed = sample.end;
        }
    }

    /// Returns the duration of the samples without motion after the end of the motion.
    pub(super) const fn rest_after_end(&self) -> RunTime {
        self.newest.end.saturating_sub(self.end_run)
    }

    /// Whether the axes are at rest after the newest sample: the next sample may be late.
    pub(super) const fn is_at_rest(&self) -> bool {
        self.rested || self.finished
    }

    /// Whether motion is pending or being executed.
    pub(super) fn is_under_way(&self) -> bool {
        self.end.is_some() && !(self.rested && self.pieces.is_empty())
    }

    /// Counts the samples that end at or before the board clock `now`, ticks, as executed.
    pub(super) fn pass(&mut self, now: Ticks) {
        while let Some(piece) = self.pieces.pop_front_if(|piece| piece.clock <= now) {
            self.executed = self.executed.max(piece.sample.end);
            self.made.push_back(piece);
            if self.made.len() > REMEMBERED {
                self.made.pop_front();
            }
        }
    }

    /// Clears the end of the motion if the board has executed all samples.
    pub(super) fn end_if_made(&mut self) {
        if self.pieces.is_empty() {
            self.end = None;
        }
    }

    /// Returns the commanded position of X at the first board clock and of Z at the second, in the
    /// kernel's pulses; `None` without samples.
    pub(super) fn at(&self, clocks: [Ticks; 2]) -> Option<PerAxis<Pulses>> {
        let at = |clock: Ticks| {
            let mut made = self.made.iter().chain(&self.pieces);
            let until = made.clone().take_while(|piece| piece.clock <= clock).last();
            until.or(made.next()).map(|piece| piece.sample.pulses)
        };
        let [x, z] = clocks.map(at);
        Some(PerAxis::new(x?.x, z?.z))
    }

    /// Returns the pending sample that contains the kernel time `at`, or the last pending one if
    /// all end before it; `None` if no sample is pending.
    pub(super) fn piece_at(&self, at: RunTime) -> Option<Piece> {
        let piece = self.pieces.partition_point(|piece| piece.sample.end < at);
        self.pieces.get(piece).or(self.pieces.back()).copied()
    }

    /// Returns the samples that the board may have begun by the board clock `now`, ticks.
    fn reached(&self, now: u64) -> Vec<Sample> {
        let begun = self
            .pieces
            .partition_point(|piece| piece.clock.unsigned_abs() <= now);
        let ahead = self.pieces.iter().take(begun.max(1));
        let reached = self.made.iter().chain(ahead);
        reached.map(|piece| piece.sample).collect()
    }

    /// Finds the position `kernel`, in the kernel's pulses, on the path up to the board clock
    /// `now`. Returns whether the position is on the path, and the speed and direction of the axes
    /// there; 0 if it is not. Without any motion the position must be unchanged.
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
        // Search from the end: after a reversal the later position is more likely.
        let found = path.windows(2).rposition(|pair| {
            within(pair[0].pulses.x, pair[1].pulses.x, x)
                && within(pair[0].pulses.z, pair[1].pulses.z, z)
        });
        let Some(found) = found else {
            let on_path = path.last().is_none_or(|last| last.pulses == kernel);
            let (speed, direction) = (0.0, [0; 2]);
            return (on_path, Located { speed, direction });
        };
        // Average over several samples: a single one may have a pulse more or less.
        let from = path[found.saturating_sub(AVERAGED)];
        let to = path[(found + AVERAGED).min(path.len() - 1)];
        let moved = [to.fine.x - from.fine.x, to.fine.z - from.fine.z];
        let minutes = (to.end.saturating_sub(from.end)).as_secs_f64().max(1e-3) / 60.0;
        let [x, z] = [0, 1].map(|axis| moved[axis] as f64 / FINE as f64 / pulses_per_mm[axis]);
        self.executed = self.executed.max(path[found].end);
        let located = Located {
            speed: libm::hypot(x, z) / minutes,
            direction: [0, 1].map(|axis| last_direction(&path[..=found + 1], axis)),
        };
        (true, located)
    }
}

/// Returns the direction of an axis (0 for X, 1 for Z) at the last sample, 1 or -1; 0 without
/// motion or shortly after a reversal.
fn last_direction(samples: &[Sample], axis: usize) -> i64 {
    let at = |sample: &Sample| [sample.fine.x, sample.fine.z][axis];
    let Some(end) = samples.last().map(at) else {
        return 0;
    };
    let mut direction = 0;
    for (count, pair) in samples.windows(2).rev().enumerate() {
        if count >= AVERAGED && (end - at(&pair[0])).abs() > TURNING * FINE {
            break;
        }
        let moved = (at(&pair[1]) - at(&pair[0])).signum();
        if moved == -direction && moved != 0 {
            return 0;
        }
        direction = if moved == 0 { direction } else { moved };
    }
    direction
}
