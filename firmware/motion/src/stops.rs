//! What stops the axes without the host: stop groups (Klipper's `trsync`) with their inputs,
//! guard inputs, and the lease.

use crate::clock_steps::is_before;

/// A stop group.
#[derive(Clone, Copy, Debug, Default)]
pub struct StopGroup {
    /// Object number.
    pub oid: u32,
    pub can_trigger: bool,
    pub reason: u32,
    pub expire_reason: u32,
    /// Clock at which the group triggers if the host does not renew it, ticks.
    pub expires: Option<u32>,
    /// Clock of the next report, ticks.
    pub report: Option<u32>,
    pub report_ticks: u32,
}

/// An input that triggers a stop group.
#[derive(Clone, Copy, Debug, Default)]
pub struct StopInput {
    /// Object number.
    pub oid: u32,
    pub pin: u32,
    /// Clock of the next sample, ticks; `None` if the input is not watched.
    pub next: Option<u32>,
    pub sample_ticks: u32,
    pub sample_count: u32,
    pub is_high: bool,
    pub trsync: u32,
    pub reason: u32,
    /// Number of successive samples with the expected level.
    pub matching: u32,
}

impl StopInput {
    /// Starts to watch the input from the clock `from` on.
    pub fn watch(&mut self, from: u32) {
        self.next = Some(from);
        self.matching = 0;
    }

    /// Samples the input if a sample is due; returns whether it has had the expected level for
    /// long enough. An input without the expected level is sampled at each call.
    pub fn sample(&mut self, is_high: bool, now: u32) -> bool {
        let Some(next) = self.next else {
            return false;
        };
        if is_before(now, next) {
            return false;
        }
        if is_high != self.is_high {
            self.matching = 0;
            self.next = Some(now);
            return false;
        }
        // The first sample may be long due: the input is sampled when its level changes.
        let from = if self.matching == 0 { now } else { next };
        self.matching += 1;
        self.next = Some(from.wrapping_add(self.sample_ticks));
        if self.matching < self.sample_count {
            return false;
        }
        self.next = None;
        true
    }
}

/// Levels of pins that make inputs act. As long as no pin has its level, the inputs need not be
/// looked up.
#[derive(Clone, Copy, Debug, Default)]
pub struct WatchedLevels {
    pins: u32,
    high: u32,
    was_active: bool,
}

impl WatchedLevels {
    /// Creates the levels of no pin.
    pub const fn new() -> Self {
        Self {
            pins: 0,
            high: 0,
            was_active: false,
        }
    }

    /// Whether a pin has its level now, or had it at the last call.
    #[inline(always)]
    pub fn needs_check(&mut self, levels: u32) -> bool {
        let is_active = self.pins & (levels ^ !self.high) != 0;
        let needs_check = is_active || self.was_active;
        self.was_active = is_active;
        needs_check
    }
}

impl FromIterator<(u32, bool)> for WatchedLevels {
    fn from_iter<T: IntoIterator<Item = (u32, bool)>>(pins: T) -> Self {
        let mut levels = Self::new();
        for (pin, is_high) in pins {
            levels.pins |= 1 << pin;
            levels.high |= u32::from(is_high) << pin;
        }
        levels
    }
}

/// An input that shuts the board down at any time after the configuration.
#[derive(Clone, Copy, Debug, Default)]
pub struct Guard {
    pub pin: u32,
    pub is_high: bool,
    /// Time for which the level must remain, ticks.
    pub ticks: u32,
    since: Option<u32>,
}

impl Guard {
    /// Creates a guard on a pin that trips if the level `is_high` remains for a time.
    pub const fn new(pin: u32, is_high: bool, ticks: u32) -> Self {
        Self {
            pin,
            is_high,
            ticks,
            since: None,
        }
    }

    /// Checks the level; returns whether the guard trips.
    pub fn check(&mut self, is_high: bool, now: u32) -> bool {
        if is_high != self.is_high {
            self.since = None;
            return false;
        }
        let since = *self.since.get_or_insert(now);
        now.wrapping_sub(since) >= self.ticks
    }
}

/// Binary logarithm of the time of a planned stop, ticks: 2^20 ticks are 67 ms.
pub const STOP_SHIFT: u32 = 20;

/// A planned stop: the clock and the angle on which the queue runs slow down evenly to a
/// standstill, so that the axes remain on the path.
#[derive(Clone, Copy, Debug)]
pub struct PlannedStop {
    begun: u32,
    /// Part of a count of the spindle that is not used yet, in 2^-16.
    part: u32,
}

impl PlannedStop {
    /// Begins the stop at the clock `now`, ticks.
    pub const fn new(now: u32) -> Self {
        Self {
            begun: now,
            part: 0,
        }
    }

    fn elapsed(&self, now: u32) -> u32 {
        now.wrapping_sub(self.begun).min(1 << STOP_SHIFT)
    }

    /// Whether the axes have reached the standstill.
    pub fn is_over(&self, now: u32) -> bool {
        self.elapsed(now) == 1 << STOP_SHIFT
    }

    /// Returns the slowed clock, ticks.
    pub fn slowed_clock(&self, now: u32) -> u32 {
        let elapsed = u64::from(self.elapsed(now));
        let lost = (elapsed * elapsed) >> (STOP_SHIFT + 1);
        self.begun.wrapping_add((elapsed - lost) as u32)
    }

    /// Takes one count of the spindle; returns whether the axes follow it.
    pub fn takes_count(&mut self, now: u32) -> bool {
        let rate = ((1 << STOP_SHIFT) - self.elapsed(now)) >> (STOP_SHIFT - 16);
        self.part += rate;
        let takes = self.part >= 1 << 16;
        if takes {
            self.part -= 1 << 16;
        }
        takes
    }
}
