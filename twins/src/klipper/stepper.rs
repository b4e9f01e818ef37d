//! A stepper and its queue.

use std::collections::VecDeque;

/// Steps the host has queued as one.
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
    /// The move under way, with the interval of its next step.
    active: Option<StepperMove>,
    /// Clock of the next step, or of the last one when it stands.
    next: i64,
    pub(super) position: i64,
    /// Direction of what is queued next.
    pub(super) up: bool,
    /// After a stop what is queued is dropped until the clock is set.
    needs_clock: bool,
    /// The stop group it belongs to.
    pub(super) trsync: Option<u32>,
}

/// What a queued move leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum QueueResult {
    /// It waits behind others.
    Waiting,
    /// It starts at this clock.
    Started(i64),
    /// It was dropped.
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

    /// Clock of the next step.
    pub(super) fn due(&self) -> Option<i64> {
        self.active.map(|_| self.next)
    }

    /// Entries it has in the common queue; the move under way has left it.
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

    /// Makes the step that is due; the way it goes, and whether the next move of the
    /// queue began.
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

    /// At once, whatever is queued; the direction pin falls back, too.
    pub(super) fn stop(&mut self) {
        self.queue.clear();
        self.active = None;
        self.up = false;
        self.needs_clock = true;
        self.trsync = None;
    }
}
