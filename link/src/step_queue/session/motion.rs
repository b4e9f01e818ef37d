//! Motion in the board: what was handed over, and where on it the axes stand.

use std::collections::VecDeque;

use super::path::{Located, Path};
use crate::limits::Limits;
use crate::step_queue::rates::Rates;
use crate::step_queue::slowdown::Slowdown;
use crate::step_queue::step_compress::Ticks;
use crate::step_queue::steps::{Entry, Steps};
use crate::{HostTime, LinkConfig, RunTime};
use gsk_units::{PerAxis, Pulses};

/// Slots of the board's queue that are never used.
const SPARE: usize = 32;
/// Steps that are to be made, up to the queue of the board.
#[derive(Clone, Debug)]
pub(super) struct Queue {
    pub(super) steps: [Steps; 2],
    pub(super) flush_due: Option<HostTime>,
    pub(super) slowdown: Slowdown,
    pub(super) backlog: VecDeque<(usize, Entry)>,
    /// Clocks of the first steps of what the board has in its queue.
    pub(super) queued: VecDeque<Ticks>,
    /// Slots of that queue.
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

    /// The board has so many slots.
    pub(super) const fn set_slots(&mut self, slots: u32) {
        self.slots = (slots as usize).saturating_sub(SPARE);
    }

    /// The board knows no time and no direction of its axes.
    pub(super) fn forget_steps(&mut self) {
        for steps in &mut self.steps {
            steps.forget();
        }
    }

    /// Nothing that waits or is queued is made.
    fn clear(&mut self) {
        self.forget_steps();
        self.backlog.clear();
        self.queued.clear();
        self.flush_due = None;
        self.slowdown = Slowdown::default();
    }

    /// Pulses have not gone out yet.
    pub(super) fn is_waiting(&self) -> bool {
        !self.backlog.is_empty() || self.steps.iter().any(|steps| !steps.is_empty())
    }

    /// Clock of the last step that has gone out since the axes began to move.
    pub(super) const fn last_step(&self) -> Option<u64> {
        match self.last_step {
            Some(clock) => Some(clock.unsigned_abs()),
            None => None,
        }
    }

    /// When the first pulse is due that has not become steps.
    pub(super) fn first_due(&self) -> Option<u64> {
        let first = self.steps.iter().filter_map(Steps::first).min();
        first.map(Ticks::unsigned_abs)
    }

    /// What the board has begun by now has left its queue.
    pub(super) fn pass(&mut self, now: Ticks) {
        self.queued.retain(|first| *first > now);
    }

    /// The next entry, while the queue of the board has a slot for it.
    pub(super) fn next_entry(&mut self) -> Option<(usize, Entry)> {
        if self.queued.len() >= self.slots {
            return None;
        }
        let (axis, entry) = self.backlog.pop_front()?;
        self.queued.push_back(entry.first);
        let last = self.last_step.unwrap_or(Ticks::MIN);
        self.last_step = Some(last.max(entry.last));
        Some((axis, entry))
    }

    /// The first steps of each axis that have not gone to the wire, as clocks.
    pub(super) fn first_kept(&self) -> [Option<u64>; 2] {
        [0, 1].map(|axis| {
            let mut waiting = self.backlog.iter().filter(|(of, _)| *of == axis);
            let first = waiting.next().map(|(_, entry)| entry.first);
            let first = first.or_else(|| self.steps[axis].first());
            first.map(Ticks::unsigned_abs)
        })
    }
}

/// Whether the board's count and the kernel's go together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Alignment {
    /// They were never put together, or the kernel has forgotten its own.
    None,
    /// They were; steps may have been lost since, or the drives been without power.
    Stale,
    /// They do.
    Exact,
}

/// The board's count and the kernel's.
#[derive(Clone, Copy, Debug)]
pub(super) struct Count {
    alignment: Alignment,
    /// Board pulses minus kernel pulses.
    offset: PerAxis<i64>,
    /// Where the board stood when it was last asked.
    pub(super) board: Option<PerAxis<Pulses>>,
    /// Position of the last sample taken.
    pub(super) commanded: PerAxis<Pulses>,
}

impl Count {
    const fn new() -> Self {
        Self {
            alignment: Alignment::None,
            offset: PerAxis::new(0, 0),
            board: None,
            commanded: PerAxis::new(Pulses(0), Pulses(0)),
        }
    }

    /// The board's count in the kernel's pulses.
    pub(super) fn counted(&self) -> Option<PerAxis<Pulses>> {
        self.board.map(|board| self.to_kernel(board))
    }

    /// A count of the board as the kernel's.
    pub(super) const fn to_kernel(self, board: PerAxis<Pulses>) -> PerAxis<Pulses> {
        PerAxis::new(
            Pulses(board.x.0 - self.offset.x),
            Pulses(board.z.0 - self.offset.z),
        )
    }

    /// Where the axes stand since both were put together; of axes that move, where they
    /// are to go.
    pub(super) fn position(&self) -> Option<PerAxis<Pulses>> {
        (self.alignment != Alignment::None).then_some(self.commanded)
    }

    /// Whether no step was lost and no drive without power since both were put together.
    pub(super) const fn is_exact(&self) -> bool {
        matches!(self.alignment, Alignment::Exact)
    }

    /// Steps may have been lost.
    pub(super) const fn mark_stale(&mut self) {
        if self.is_exact() {
            self.alignment = Alignment::Stale;
        }
    }

    /// The kernel has forgotten its own.
    pub(super) const fn forget(&mut self) {
        self.alignment = Alignment::None;
    }

    /// What the board counts, with the high bits it does not tell.
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

/// Where and how the axes were stopped.
pub(super) struct Stopped {
    pub(super) kernel: PerAxis<Pulses>,
    /// The position lies on the commanded path.
    pub(super) on_path: bool,
    /// Speed there, mm/min, and the way on which each axis came there.
    pub(super) speed: f64,
    pub(super) way: [i64; 2],
}

/// Motion handed over.
#[derive(Clone, Debug)]
pub(super) struct StepMotion {
    pub(super) rates: Rates,
    pub(super) queue: Queue,
    pub(super) path: Path,
    pub(super) count: Count,
    pub(super) limits: Limits,
}

impl StepMotion {
    pub(super) fn new(pulses_per_mm: [f64; 2]) -> Self {
        let rates = Rates::unknown();
        Self {
            queue: Queue::new(&rates),
            rates,
            path: Path::new(),
            count: Count::new(),
            limits: Limits::new(pulses_per_mm),
        }
    }

    pub(super) fn set_up(&mut self, config: &LinkConfig, processor: &str, rate: f64) {
        self.rates = Rates::new(config, processor, rate);
        self.queue.steps = self.rates.timing.map(Steps::new);
    }

    /// The board has been reset, or is a new one.
    pub(super) fn forget_board(&mut self) {
        self.drop_queued();
        self.count.board = None;
        self.queue.last_step = None;
    }

    /// Steps are queued or being made.
    pub(super) fn is_under_way(&self) -> bool {
        self.path.is_under_way() || self.queue.is_waiting()
    }

    /// Everything queued is dropped, here and in the board.
    pub(super) fn drop_queued(&mut self) {
        self.queue.clear();
        self.path.end_motion();
    }

    /// The axes stand at this position of the kernel, and of the board.
    pub(super) fn align(&mut self, kernel: PerAxis<Pulses>, board: PerAxis<Pulses>, at: RunTime) {
        self.count.offset = PerAxis::new(board.x.0 - kernel.x.0, board.z.0 - kernel.z.0);
        self.count.alignment = Alignment::Exact;
        self.stand_at(kernel);
        self.path.executed = at;
        self.path.newest.end = at;
    }

    /// The axes stand at this position of the kernel.
    pub(super) fn stand_at(&mut self, kernel: PerAxis<Pulses>) {
        self.drop_queued();
        self.count.commanded = kernel;
        self.path.stand_at(kernel);
    }

    /// The axes stand where each was at a clock.
    pub(super) fn stand_at_clocks(&mut self, clocks: [Ticks; 2]) {
        if let Some(kernel) = self.path.at(clocks) {
            self.stand_at(kernel);
        }
    }

    /// Where on the commanded path the board stopped.
    pub(super) fn stopped_at(
        &mut self,
        board: PerAxis<Pulses>,
        now: u64,
        pulses_per_mm: [f64; 2],
    ) -> Stopped {
        let kernel = self.count.to_kernel(board);
        let (on_path, Located { speed, way }) = self.path.locate(kernel, now, pulses_per_mm);
        self.stand_at(kernel);
        self.count.board = Some(board);
        self.queue.last_step = None;
        Stopped {
            kernel,
            on_path,
            speed,
            way,
        }
    }
}
