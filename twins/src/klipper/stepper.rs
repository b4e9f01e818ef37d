//! A stepper and its queue of moves.

use std::collections::VecDeque;

/// Several steps that the host has queued as one move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct StepperMove {
    pub(super) interval: i64,
    pub(super) count: u32,
    pub(super) add: i64,
    pub(super) up: bool,
}

#[derive(Clone, Debug)]
pub(super) struct Stepper {
    queue: VecDeque<StepperMove>,
    /// The current move, with the interval of its next step.
    active: Option<StepperMove>,
    /// Clock of the next step; for a stopped stepper that of the last step.
    next: i64,
    pub(super) position: i64,
    /// Direction of the moves queued next.
    pub(super) up: bool,
    /// After a stop the stepper drops moves until the host resets its step clock.
    needs_clock: bool,
    /// The trsync that stops the stepper.
    pub(super) trsync: Option<u32>,
}

/// The effect of queueing a move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum QueueResult {
    /// The move waits in the queue.
    Waiting,
    /// The move has started; its first step is at this clock.
    Started(i64),
    /// The move was dropped.
    Dropped,
}

impl Stepper {
    pub(super) const fn new() -> Self {
        Self {
            queue: VecDeque::new(),
            active: None,
            next: 0,
            position: 0,
            up: false,
            needs_clock: true,
            trsync: None,
        }
    }

    /// Returns the clock of the next step.
    pub(super) fn due(&self) -> Option<i64> {
        self.active.map(|_| self.next)
    }

    /// Returns the entries of the stepper in the shared queue, without the current move.
    pub(super) fn queue_length(&self) -> usize {
        self.queue.len()
    }

    pub(super) fn reset_step_clock(&mut self, clock: i64) -> Result<(), &'static str> {
        if self.active.is_some() {
            return Err("Can't reset time when stepper active");
        }
        self.next = clock;
        self.needs_clock = false;
        Ok(())
    }

    pub(super) fn queue(&mut self, interval: u32, count: u32, add: i32) -> QueueResult {
        let new = StepperMove {
            interval: interval.into(),
            count,
            add: add.into(),
            up: self.up,
        };
        if self.active.is_some() {
            self.queue.push_back(new);
            return QueueResult::Waiting;
        }
        if self.needs_clock {
            return QueueResult::Dropped;
        }
        self.start_move(new);
        QueueResult::Started(self.next)
    }

    fn start_move(&mut self, new: StepperMove) {
        self.next += new.interval;
        self.active = Some(new);
    }

    /// Makes the due step. Returns its direction and whether the next move of the queue has
    /// started.
    pub(super) fn step(&mut self) -> (bool, bool) {
        let Some(active) = &mut self.active else {
            return (false, false);
        };
        let up = active.up;
        self.position += if up { 1 } else { -1 };
        active.count -= 1;
        if active.count > 0 {
            active.interval += active.add;
            self.next += active.interval;
            return (up, false);
        }
        self.active = None;
        let next = self.queue.pop_front();
        if let Some(next) = next {
            self.start_move(next);
        }
        (up, next.is_some())
    }

    /// Stops at once, clears the queue and resets the direction pin.
    pub(super) fn stop(&mut self) {
        self.queue.clear();
        self.active = None;
        self.up = false;
        self.needs_clock = true;
        self.trsync = None;
    }
}
