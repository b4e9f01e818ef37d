//! An axis: its queue of steps with two arguments, its count, and the time of its next step.

use crate::storage::Deque;

use crate::angle::{AngleFollower, QueuedAngle, Segment};
use crate::clock_steps::{ClockRun, ClockStepper, is_before};
use crate::engine::StepPort;
use crate::messages::{QUEUE_SIZE, Reason};

/// Time by which a step on the clock is given to the step output before it is due, ticks: 20 µs.
const AHEAD_TICKS: i32 = 312;
/// Lateness of a step from which on the board shuts down, ticks: 1 ms.
const MAX_PAST_TICKS: i32 = 15_625;
/// Greatest number of steps of an axis at a call.
const STEPS_AT_ONCE: u32 = 5;
/// Number of steps on the clock that may wait in the output, besides the one that it makes.
const WAITING_STEPS: u32 = 3;

/// An entry of the queue.
#[derive(Clone, Copy, Debug)]
pub enum Entry {
    /// A run of steps on the clock.
    Clock(ClockRun),
    /// The start of a thread or tap: from the clock on, wait for the spindle to pass an angle,
    /// counts from its index.
    Begin {
        clock: u32,
        start: u32,
        denominator: u32,
        phase: u32,
        is_reverse: bool,
    },
    /// After the start of a tap: counts from which on the return to the start ends it. Not in the
    /// start itself, so that no entry becomes larger: the board has memory for 2048.
    Depth(u32),
    /// A part of the thread.
    Angle(Segment),
    /// The end of the thread.
    End,
}

/// What the axis does.
#[derive(Clone, Debug)]
pub enum Activity {
    Idle,
    Clock(ClockStepper),
    Angle {
        follower: AngleFollower,
        clock: u32,
        start: u32,
    },
}

/// The angle of the spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SpindleAngle {
    /// Counts since the encoder was configured.
    pub count: i32,
    /// Counts since the index, 0 to `counts_per_turn` - 1.
    pub turn_count: u32,
    /// Counts per turn; 0 without an encoder.
    pub counts_per_turn: u32,
    /// Whether the angle is known: an encoder with an index has passed it.
    pub is_referenced: bool,
}

/// An axis.
#[derive(Clone, Debug)]
pub struct Stepper {
    /// Object number.
    pub oid: u32,
    queue: Deque<Entry, QUEUE_SIZE>,
    /// What the axis does.
    pub activity: Activity,
    /// Count of the steps made, positive minus negative.
    pub position: i32,
    /// Clock of the last step, ticks.
    last: u32,
    /// Whether the axis drops entries until its clock is set, as after a stop.
    is_stopped: bool,
    /// Whether the clock of the last step is known when the queue is done; not after a thread.
    is_clock_known: bool,
    queues_thread: bool,
    /// Greatest phase error of threads that have ended, thousandths of a step.
    ended_error: u32,
    /// Direction of the runs that are queued next.
    pub next_is_up: bool,
    /// Object number of the stop group; `None` without one.
    pub trsync: Option<u32>,
}

impl Stepper {
    /// Creates an axis that is stopped.
    pub const fn new(oid: u32) -> Self {
        Self {
            oid,
            queue: Deque::new(),
            activity: Activity::Idle,
            position: 0,
            last: 0,
            is_stopped: true,
            is_clock_known: false,
            queues_thread: false,
            ended_error: 0,
            next_is_up: false,
            trsync: None,
        }
    }

    /// Returns the number of entries in the queue.
    pub fn queue_length(&self) -> usize {
        self.queue.len()
    }

    /// Whether the axis has nothing to do.
    #[inline(always)]
    pub fn is_idle(&self) -> bool {
        matches!(self.activity, Activity::Idle) && self.queue.is_empty()
    }

    /// Sets the clock of the last step.
    ///
    /// # Errors
    /// The axis is active.
    pub fn reset_step_clock(&mut self, clock: u32) -> Result<(), Reason> {
        if !self.is_idle() {
            return Err(Reason::StepperActive);
        }
        self.last = clock;
        self.is_stopped = false;
        self.is_clock_known = true;
        Ok(())
    }

    /// Returns the greatest phase error of its threads since the last call, thousandths of a step;
    /// 0 without a thread.
    #[inline(never)]
    pub fn take_thread_error(&mut self) -> u32 {
        let current = match &mut self.activity {
            Activity::Angle { follower, .. } if !follower.is_waiting() => follower.take_error(),
            _ => 0,
        };
        core::mem::take(&mut self.ended_error).max(current)
    }

    /// Whether the axis drops entries, as after a stop.
    pub fn is_stopped(&self) -> bool {
        self.is_stopped
    }

    /// Appends an entry at the clock `now`. After a stop the axis drops entries until its clock
    /// is set: the host has then received the stop.
    ///
    /// # Errors
    /// The entry is invalid or its first step is late.
    pub fn queue(&mut self, entry: Entry, now: u32) -> Result<(), Reason> {
        if self.is_stopped {
            return Ok(());
        }
        match entry {
            Entry::Clock(run) if run.count == 0 => return Err(Reason::InvalidCount),
            Entry::Clock(_) if self.queues_thread => return Err(Reason::AngleMissing),
            Entry::Clock(_) if !self.is_clock_known => return Err(Reason::ClockUnset),
            Entry::Clock(run) => {
                let first = self.last.wrapping_add(run.interval);
                if self.is_idle() && is_before(first, now) {
                    return Err(Reason::TimerTooClose);
                }
            }
            Entry::Begin { .. } => {
                if self.queues_thread {
                    return Err(Reason::AngleMissing);
                }
                self.queues_thread = true;
                // The steps of a thread have no time that the host knows.
                self.is_clock_known = false;
            }
            Entry::Angle(_) | Entry::Depth(_) | Entry::End if !self.queues_thread => {
                return Err(Reason::AngleMissing);
            }
            Entry::Angle(_) | Entry::Depth(_) => {}
            Entry::End => self.queues_thread = false,
        }
        self.queue
            .push_back(entry)
            .map_err(|_| Reason::QueueOverflow)
    }

    /// Starts the next entry of an idle axis.
    fn start_next(&mut self) {
        match self.queue.pop_front() {
            Some(Entry::Clock(run)) => {
                self.activity = Activity::Clock(ClockStepper::new(run, self.last));
            }
            Some(Entry::Begin {
                clock,
                start,
                denominator,
                phase,
                is_reverse,
            }) => {
                let mut follower = AngleFollower::new(denominator, phase, is_reverse);
                if let Some(Entry::Depth(depth)) = self.queue.front() {
                    follower.end_at_start(*depth as i32);
                    self.queue.pop_front();
                }
                self.activity = Activity::Angle {
                    follower,
                    clock,
                    start,
                };
            }
            // After a tap the segments that it did not reach are left.
            Some(Entry::Angle(_) | Entry::Depth(_) | Entry::End) | None => {}
        }
    }

    /// Takes some counts of the spindle at the clock `now`; `from` is the angle before them.
    /// Returns whether a thread has started.
    ///
    /// # Errors
    /// The axis cannot follow.
    #[inline]
    pub fn turn(&mut self, counts: i32, from: SpindleAngle, now: u32) -> Result<bool, Reason> {
        let Activity::Angle {
            follower,
            clock,
            start,
        } = &mut self.activity
        else {
            return Ok(false);
        };
        let queue = &mut self.queue;
        let mut next = || match queue.pop_front() {
            Some(Entry::Angle(segment)) => QueuedAngle::Segment(segment),
            Some(_) => QueuedAngle::End,
            None => QueuedAngle::Empty,
        };
        let along = follower.along(counts);
        if !follower.is_waiting() {
            return follower.turn(along, next).map(|()| false);
        }
        if !from.is_referenced || is_before(now, *clock) {
            return Ok(false);
        }
        let ahead = follower.along(*start as i32 - from.turn_count as i32);
        let distance = if ahead <= 0 {
            ahead + from.counts_per_turn as i32
        } else {
            ahead
        };
        if distance > along {
            return Ok(false);
        }
        follower.start(&mut next)?;
        follower.turn(along - distance, next)?;
        Ok(true)
    }

    /// Gives the output the steps that are due at the clock `now`, ticks. The queue runs on the
    /// clock `queue_now`, which is slower in a planned stop. Returns whether a thread has ended.
    ///
    /// # Errors
    /// A step is late.
    #[inline(always)]
    pub fn make_steps(
        &mut self,
        axis: usize,
        now: u32,
        queue_now: u32,
        port: &mut impl StepPort,
    ) -> Result<bool, Reason> {
        for _ in 0..STEPS_AT_ONCE {
            match &mut self.activity {
                Activity::Clock(run) => {
                    let ahead = run.next.wrapping_sub(queue_now) as i32;
                    // On the slowed clock the time of a step is not known before it is due.
                    let most = if queue_now == now { AHEAD_TICKS } else { 0 };
                    if ahead > most {
                        return Ok(false);
                    }
                    if ahead < -MAX_PAST_TICKS {
                        return Err(Reason::StepperPast);
                    }
                    let is_up = run.is_up();
                    let at = now.wrapping_add(ahead.max(0) as u32);
                    if !port.try_step(axis, is_up, at, WAITING_STEPS) {
                        return Ok(false);
                    }
                    self.position = self.position.wrapping_add(if is_up { 1 } else { -1 });
                    self.last = run.next;
                    if !run.made_step() {
                        self.activity = Activity::Idle;
                        self.start_next();
                    }
                }
                Activity::Angle { follower, .. } => {
                    let Some(is_up) = follower.due_step() else {
                        let is_ended = follower.is_ended();
                        if is_ended {
                            self.ended_error = self.ended_error.max(follower.take_error());
                            self.activity = Activity::Idle;
                        }
                        return Ok(is_ended);
                    };
                    if !port.try_step(axis, is_up, now, 0) {
                        return Ok(false);
                    }
                    self.position = self.position.wrapping_add(if is_up { 1 } else { -1 });
                    follower.made_step(is_up);
                }
                Activity::Idle => {
                    if self.queue.is_empty() {
                        return Ok(false);
                    }
                    self.start_next();
                }
            }
        }
        Ok(false)
    }

    /// Stops the axis and clears its queue. `undone` is the sum of the steps that the output has
    /// taken but not made.
    pub fn stop(&mut self, undone: i32) {
        self.queue.clear();
        self.activity = Activity::Idle;
        self.position = self.position.wrapping_sub(undone);
        self.is_stopped = true;
        self.queues_thread = false;
        self.next_is_up = false;
        self.trsync = None;
    }
}
