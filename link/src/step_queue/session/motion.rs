//! Motion handed over to a board with timed steps, and the position of the axes on it.

use std::collections::VecDeque;

use super::path::{Located, Path};
use crate::limits::Limits;
use crate::step_queue::rates::Rates;
use crate::step_queue::slowdown::Slowdown;
use crate::step_queue::step_compress::Ticks;
use crate::step_queue::steps::{QueuedStepRun, Steps};
use crate::{HostTime, LinkConfig, RunTime};
use gsk_units::{PerAxis, Pulses};

/// Number of entries of the board's motion queue that the link leaves unused.
const SPARE: usize = 32;

/// Steps that are waiting for, or are in, the board's motion queue.
#[derive(Clone, Debug)]
pub(super) struct Queue {
    pub(super) steps: [Steps; 2],
    pub(super) flush_due: Option<HostTime>,
    pub(super) slowdown: Slowdown,
    pub(super) backlog: VecDeque<(usize, QueuedStepRun)>,
    /// Board clock of the first step of each run in the board's motion queue, ticks.
    pub(super) queued: VecDeque<Ticks>,
    /// Number of entries of the board's motion queue that the link may use.
    pub(super) slots: usize,
    pub(super) last_step: Option<Ticks>,
}

impl Queue {
    fn new(rates: &Rates) -> Self {
        Self {
            steps: rates.timing.map(Steps::new),
            flush_due: None,
            slowdown: Slowdown::default(),
            backlog: VecDeque::new(),
            queued: VecDeque::new(),
            slots: 0,
            last_step: None,
        }
    }

    /// Sets the usable size of the board's motion queue from the number of entries that the board
    /// has reported.
    pub(super) const fn set_slots(&mut self, slots: u32) {
        self.slots = (slots as usize).saturating_sub(SPARE);
    }

    /// Drops the steps that are not compressed. Before the next steps the link sends step clocks
    /// and directions again.
    pub(super) fn forget_steps(&mut self) {
        for steps in &mut self.steps {
            steps.forget();
        }
    }

    /// Drops all steps in the link, also those already sent.
    fn clear(&mut self) {
        self.forget_steps();
        self.backlog.clear();
        self.queued.clear();
        self.flush_due = None;
        self.slowdown = Slowdown::default();
    }

    /// Whether the link has steps that are not sent yet.
    pub(super) fn is_waiting(&self) -> bool {
        !self.backlog.is_empty() || self.steps.iter().any(|steps| !steps.is_empty())
    }

    /// Returns the board clock of the last step sent in this motion, ticks; `None` before the first
    /// one.
    pub(super) const fn last_step(&self) -> Option<u64> {
        match self.last_step {
            Some(clock) => Some(clock.unsigned_abs()),
            None => None,
        }
    }

    /// Returns the board clock of the first step that is not compressed yet, ticks; `None` without
    /// one.
    pub(super) fn first_due(&self) -> Option<u64> {
        let first = self.steps.iter().filter_map(Steps::first).min();
        first.map(Ticks::unsigned_abs)
    }

    /// Removes the runs that the board has begun by the board clock `now` from the list of runs in
    /// the board's queue.
    pub(super) fn pass(&mut self, now: Ticks) {
        self.queued.retain(|first| *first > now);
    }

    /// Removes and returns the next waiting run with its axis (0 for X, 1 for Z), and counts it as
    /// sent; `None` if no run waits or the board's queue is full.
    pub(super) fn next_entry(&mut self) -> Option<(usize, QueuedStepRun)> {
        if self.queued.len() >= self.slots {
            return None;
        }
        let (axis, entry) = self.backlog.pop_front()?;
        self.queued.push_back(entry.first);
        let last = self.last_step.unwrap_or(Ticks::MIN);
        self.last_step = Some(last.max(entry.last));
        Some((axis, entry))
    }

    /// Returns the board clock of the first step of X and of Z that is not sent yet, ticks; `None`
    /// without one.
    pub(super) fn first_kept(&self) -> [Option<u64>; 2] {
        [0, 1].map(|axis| {
            let mut waiting = self.backlog.iter().filter(|(of, _)| *of == axis);
            let first = waiting.next().map(|(_, entry)| entry.first);
            let first = first.or_else(|| self.steps[axis].first());
            first.map(Ticks::unsigned_abs)
        })
    }
}

/// Whether the board's count is aligned with the kernel's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Alignment {
    /// The counts were never aligned, or the kernel has forgotten its count.
    None,
    /// The counts were aligned, but steps or drive power may have been lost since.
    Stale,
    /// The counts are aligned, and nothing was lost since.
    Exact,
}

/// The pulse counts of board and kernel, and their alignment.
#[derive(Clone, Copy, Debug)]
pub(super) struct PulseCounts {
    alignment: Alignment,
    /// The board's count minus the kernel's, pulses.
    offset: PerAxis<i64>,
    /// The last count that the board has reported; `None` before the first report.
    pub(super) board: Option<PerAxis<Pulses>>,
    /// Commanded position in the last sample, in the kernel's pulses.
    pub(super) commanded: PerAxis<Pulses>,
}

impl PulseCounts {
    const fn new() -> Self {
        Self {
            alignment: Alignment::None,
            offset: PerAxis::new(0, 0),
            board: None,
            commanded: PerAxis::new(Pulses(0), Pulses(0)),
        }
    }

    /// Returns the last count that the board has reported, in the kernel's pulses; `None` before
    /// the first report.
    pub(super) fn counted(&self) -> Option<PerAxis<Pulses>> {
        self.board.map(|board| self.to_kernel(board))
    }

    /// Converts a count of the board to the kernel's pulses.
    pub(super) const fn to_kernel(self, board: PerAxis<Pulses>) -> PerAxis<Pulses> {
        PerAxis::new(
            Pulses(board.x.0 - self.offset.x),
            Pulses(board.z.0 - self.offset.z),
        )
    }

    /// Returns the last commanded position, in the kernel's pulses: at standstill that of the axes,
    /// during motion their target. `None` if the counts of board and kernel are not aligned.
    pub(super) fn position(&self) -> Option<PerAxis<Pulses>> {
        (self.alignment != Alignment::None).then_some(self.commanded)
    }

    /// Whether the counts of board and kernel are aligned and no step and no drive power was lost
    /// since.
    pub(super) const fn is_exact(&self) -> bool {
        matches!(self.alignment, Alignment::Exact)
    }

    /// Marks the alignment of the counts as stale: steps or drive power may be lost.
    pub(super) const fn mark_stale(&mut self) {
        if self.is_exact() {
            self.alignment = Alignment::Stale;
        }
    }

    /// Discards the alignment of the counts.
    pub(super) const fn forget(&mut self) {
        self.alignment = Alignment::None;
    }

    /// Extends the low 32 bits of the board's counts of X and Z, pulses, to the full counts that
    /// are nearest to the last ones. Changes the sign of an axis with an inverted direction.
    pub(super) fn board_counts(&self, [x, z]: [u32; 2], config: &LinkConfig) -> PerAxis<Pulses> {
        let known = self.board.unwrap_or_default();
        let whole = |low: u32, invert: bool, known: i64| {
            let low = if invert { low.wrapping_neg() } else { low };
            Pulses(known + i64::from(low.wrapping_sub(known as u32) as i32))
        };
        PerAxis::new(
            whole(x, config.x.is_direction_inverted(), known.x.0),
            whole(z, config.z.is_direction_inverted(), known.z.0),
        )
    }
}

/// Position, speed and directions with which the axes were stopped.
pub(super) struct Stopped {
    pub(super) kernel: PerAxis<Pulses>,
    /// Whether the position of the stop is on the commanded path.
    pub(super) on_path: bool,
    /// Speed of the axes before the stop, mm/min.
    pub(super) speed: f64,
    /// Direction of each axis before the stop, 1, -1 or 0.
    pub(super) direction: [i64; 2],
}

/// The motion passed to the board, with its path, counts and limits.
#[derive(Clone, Debug)]
pub(super) struct StepMotion {
    pub(super) rates: Rates,
    pub(super) queue: Queue,
    pub(super) path: Path,
    pub(super) count: PulseCounts,
    pub(super) limits: Limits,
}

impl StepMotion {
    pub(super) fn new(pulses_per_mm: [f64; 2]) -> Self {
        let rates = Rates::unknown();
        Self {
            queue: Queue::new(&rates),
            rates,
            path: Path::new(),
            count: PulseCounts::new(),
            limits: Limits::new(pulses_per_mm),
        }
    }

    pub(super) fn set_up(&mut self, config: &LinkConfig, processor: &str, rate: f64) {
        self.rates = Rates::new(config, processor, rate);
        self.queue.steps = self.rates.timing.map(Steps::new);
    }

    /// Discards the motion and the count of a board that was reset or reopened.
    pub(super) fn forget_board(&mut self) {
        self.drop_queued();
        self.count.board = None;
        self.queue.last_step = None;
    }

    /// Whether steps are queued or being executed by the board.
    pub(super) fn is_under_way(&self) -> bool {
        self.path.is_under_way() || self.queue.is_waiting()
    }

    /// Drops all motion that is queued in the link.
    pub(super) fn drop_queued(&mut self) {
        self.queue.clear();
        self.path.end_motion();
    }

    /// Stores that the count `board` of the board and the count `kernel` of the kernel, both in
    /// pulses, are the same position, at standstill at the kernel time `at`.
    pub(super) fn align(&mut self, kernel: PerAxis<Pulses>, board: PerAxis<Pulses>, at: RunTime) {
        self.count.offset = PerAxis::new(board.x.0 - kernel.x.0, board.z.0 - kernel.z.0);
        self.count.alignment = Alignment::Exact;
        self.stand_at(kernel);
        self.path.executed = at;
        self.path.newest.end = at;
    }

    /// Stores `kernel`, in the kernel's pulses, as position of the axes at standstill, and drops
    /// all queued motion.
    pub(super) fn stand_at(&mut self, kernel: PerAxis<Pulses>) {
        self.drop_queued();
        self.count.commanded = kernel;
        self.path.stand_at(kernel);
    }

    /// Sets the position of the axes at standstill from the commanded path: that of X at the first
    /// board clock, that of Z at the second, ticks. Without effect if there is no path.
    pub(super) fn stand_at_clocks(&mut self, clocks: [Ticks; 2]) {
        if let Some(kernel) = self.path.at(clocks) {
            self.stand_at(kernel);
        }
    }

    /// Finds the position of a stop, `board` in the board's pulses, on the commanded path up to the
    /// board clock `now`. Sets it as position of the axes at standstill and returns it with the
    /// speed before the stop.
    pub(super) fn stopped_at(
        &mut self,
        board: PerAxis<Pulses>,
        now: u64,
        pulses_per_mm: [f64; 2],
    ) -> Stopped {
        let kernel = self.count.to_kernel(board);
        let (on_path, Located { speed, direction }) = self.path.locate(kernel, now, pulses_per_mm);
        self.stand_at(kernel);
        self.count.board = Some(board);
        self.queue.last_step = None;
        Stopped {
            kernel,
            on_path,
            speed,
            direction,
        }
    }
}
