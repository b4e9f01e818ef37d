//! Digital and PWM outputs with their queues and their time limits.

use crate::storage::Deque;

use crate::clock_steps::is_before;
use crate::messages::Reason;

/// Greatest number of queued values of an output.
const QUEUE: usize = 8;

/// An output.
#[derive(Clone, Debug, Default)]
pub struct OutputChannel {
    /// Object number.
    pub oid: u32,
    pub pin: u32,
    /// Period of the PWM, ticks; 0 for a digital output.
    pub cycle_ticks: u32,
    /// Value after a stop.
    pub default: u32,
    /// Time within which the host must renew another value than the default, ticks; 0 without
    /// a limit.
    pub max_duration: u32,
    /// Clocks and values.
    pub queue: Deque<(u32, u32), QUEUE>,
    /// Clock at which the time limit ends, ticks.
    pub ends: Option<u32>,
}

impl OutputChannel {
    /// Queues a value for a clock; `now` is the current one, ticks.
    ///
    /// # Errors
    /// The value is late, or one too many.
    pub fn queue(&mut self, clock: u32, value: u32, now: u32) -> Result<(), Reason> {
        if self.queue.is_empty() {
            if self.ends.is_some_and(|end| is_before(end, clock)) {
                return Err(self.exceeded());
            }
            if is_before(clock, now) {
                return Err(Reason::TimerTooClose);
            }
        }
        self.queue
            .push_back((clock, value))
            .map_err(|_| Reason::QueueOverflow)
    }

    /// Returns the value that is due at the clock `now`; `None` to keep the value.
    ///
    /// # Errors
    /// The host has not renewed the value.
    pub fn due_value(&mut self, now: u32) -> Result<Option<u32>, Reason> {
        let Some((clock, value)) = self.queue.front().copied() else {
            return match self.ends {
                Some(end) if !is_before(now, end) => Err(if self.cycle_ticks == 0 {
                    Reason::MissedDigital
                } else {
                    Reason::MissedPwm
                }),
                _ => Ok(None),
            };
        };
        if is_before(now, clock) {
            return Ok(None);
        }
        self.queue.pop_front();
        self.ends = None;
        if value != self.default && self.max_duration > 0 {
            let end = clock.wrapping_add(self.max_duration);
            match self.queue.front() {
                Some((next, _)) if is_before(end, *next) => return Err(self.exceeded()),
                Some(_) => {}
                None => self.ends = Some(end),
            }
        }
        Ok(Some(value))
    }

    /// Drops all queued values.
    pub fn clear(&mut self) {
        self.queue.clear();
        self.ends = None;
    }

    const fn exceeded(&self) -> Reason {
        if self.cycle_ticks == 0 {
            Reason::ExceedsDigital
        } else {
            Reason::ExceedsPwm
        }
    }
}
