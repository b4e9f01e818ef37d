//! A stepper and its queue of moves.

use std::collections::VecDeque;

/// A number of steps with changing intervals that the host queues as one move.
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
    /// The current move, with the interval of its next step; `None` for a stopped stepper.
    active: Option<StepperMove>,
    /// Clock of the next step, ticks; for a stopped stepper that of the last step.
    next: i64,
    pub(super) position: i64,
    /// Whether the moves that are queued next go in positive direction.
    pub(super) up: bool,
    /// Whether the stepper drops moves until the host resets its step clock, as after a stop.
    needs_clock: bool,
    /// Oid of the trsync that stops the stepper; `None` without one.
    pub(super) trsync: Option<u32>,
}

/// What a stepper did with a queued move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum QueueResult {
    /// The move waits in the queue.
    Waiting,
    /// The move has started; its first step is due at this clock, ticks.
    Started(i64),
    /// The stepper dropped the move, because its step clock is not set.
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

    /// Returns the clock at which the next step is due, ticks; `None` for a stopped stepper.
    pub(super) fn due(&self) -> Option<i64> {
        self.active.map(|_| self.next)
    }

    /// Returns the number of moves of the stepper in the shared queue, without the current
    /// one.
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

    /// Makes the due step. Returns whether it was upwards, and whether the next move of the
    /// queue has started.
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

    /// Stops the stepper at once, empties its queue and resets its direction pin.
    pub(super) fn stop(&mut self) {
        self.queue.clear();
        self.active = None;
        self.up = false;
        self.needs_clock = true;
        self.trsync = None;
    }
}
