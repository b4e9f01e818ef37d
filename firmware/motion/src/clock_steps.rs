//! Steps on the clock of the board: runs of steps with intervals that grow by the same amount,
//! as Klipper's `queue_step` gives them.

/// A run of steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ClockRun {
    /// Interval before the first step, ticks.
    pub interval: u32,
    /// Number of steps.
    pub count: u16,
    /// Amount by which the interval grows at each step, ticks.
    pub add: i16,
    /// Whether the steps are positive.
    pub is_up: bool,
}

/// Whether the clock `left` is before `right`, on a clock that wraps.
pub const fn is_before(left: u32, right: u32) -> bool {
    (left.wrapping_sub(right) as i32) < 0
}

/// The run that is being made.
#[derive(Clone, Copy, Debug)]
pub struct ClockStepper {
    run: ClockRun,
    /// Clock of the next step, ticks.
    pub next: u32,
}

impl ClockStepper {
    /// Starts a run after a step at the clock `last`, ticks.
    pub const fn new(run: ClockRun, last: u32) -> Self {
        Self {
            run,
            next: last.wrapping_add(run.interval),
        }
    }

    /// Whether the next step is positive.
    pub const fn is_up(&self) -> bool {
        self.run.is_up
    }

    /// Notes that the next step is made; returns whether the run has further steps.
    pub const fn made_step(&mut self) -> bool {
        self.run.count -= 1;
        if self.run.count == 0 {
            return false;
        }
        self.run.interval = self.run.interval.wrapping_add(self.run.add as i32 as u32);
        self.next = self.next.wrapping_add(self.run.interval);
        true
    }
}
