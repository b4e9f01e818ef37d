//! Decides when the kernel may make its next tick, and detects a board that ran dry.

use core::time::Duration;

use super::Linked;
use crate::board::BoardReport;
use crate::run_state::RunState;
use gsk_link::{HostTime, LinkState, Protocol, RunTime};
use gsk_messages::{Message, say};

/// Most ticks of the host's clock that the kernel catches up.
const MOST_DUE: u64 = 40;
/// Gaps between two polls of the port up to this are normal.
const EVERYDAY: Duration = Duration::from_millis(30);
/// Motion that the board may have made since its last report: it is queried every 20 ms.
const UNREPORTED: Duration = Duration::from_millis(25);
/// A program that was halted for this long, in a dwell or a wait, does not continue on its
/// own.
const ASLEEP: Duration = Duration::from_secs(1);
/// The board may execute motion this much later than the host's clock says.
const PATIENCE: Duration = Duration::from_millis(100);
const TICK: Duration = Duration::from_millis(1);

/// Host time that the kernel has not used.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pace {
    passed: Duration,
    /// Since when moving slides have had no free lookahead, and how long that may last.
    blocked: Option<(HostTime, Duration)>,
}

/// Host time and kernel time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock {
    pub(super) now: HostTime,
    /// Kernel time since the link was opened.
    pub(super) run: RunTime,
    pub(super) pace: Pace,
}

impl Clock {
    pub(super) fn new(now: HostTime) -> Self {
        Self {
            now,
            run: RunTime::ZERO,
            pace: Pace::default(),
        }
    }

    /// Advances the host time and returns the difference.
    pub(super) fn passes(&mut self, now: HostTime) -> Duration {
        let gap = now.saturating_sub(self.now);
        self.now = self.now.max(now);
        self.pace.passes(gap);
        gap
    }
}

/// What a tick shows about the power of the control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PowerEvent {
    /// The control has ticked.
    Tick,
    /// The power has just gone off or come back: the pulse count starts again.
    Lost,
    /// The power is still off.
    None,
}

/// Power state of the control, derived from its tick count.
#[derive(Clone, Copy, Debug)]
pub(super) struct Power {
    /// The control's tick count at the last check. If it stops or jumps back, the power was
    /// off.
    ticks: u64,
    on: bool,
}

impl Power {
    pub(super) const fn new(ticks: u64) -> Self {
        Self { ticks, on: true }
    }

    /// Compares the control's tick count after a tick with the last one.
    pub(super) const fn tick(&mut self, ticks: u64) -> PowerEvent {
        let before = core::mem::replace(&mut self.ticks, ticks);
        let was_on = self.on;
        self.on = ticks != before;
        if ticks > before {
            PowerEvent::Tick
        } else if was_on || self.on {
            PowerEvent::Lost
        } else {
            PowerEvent::None
        }
    }
}

impl Pace {
    fn passes(&mut self, time: Duration) {
        self.passed = (self.passed + time).min(TICK * MOST_DUE as u32);
    }

    fn take(&mut self) -> bool {
        match self.passed.checked_sub(TICK) {
            Some(rest) => {
                self.passed = rest;
                true
            }
            None => false,
        }
    }
}

impl Linked {
    /// Whether the kernel may make a tick now. While slides move the board sets the time,
    /// otherwise the host's clock does.
    pub fn may_tick(&mut self) -> bool {
        if self.thread.pass.is_some() || !self.reports.are_heard() {
            // The board cuts the pass and the control follows, or reports wait for the
            // control. The free lookahead does not matter in either case.
            self.clock.pace.blocked = None;
            return self.clock.pace.take();
        }
        // A thread that waits for its index takes time in the board and stays as far ahead
        // of it as motion does. A pause of the host must not separate the start of the
        // thread from the index that the control saw.
        let orders = &self.control.orders;
        let waits = self.spindle.view.is_some() && orders.spindle.waits;
        let moves = self.motion.moved || orders.moving || waits;
        if !moves || !self.link.takes_motion() {
            self.clock.pace.blocked = None;
            return self.clock.pace.take();
        }
        let room = self.link.free_lookahead();
        // Time without a pulse, at the lowest feeds, is also ahead of the board.
        let unheard = self.clock.run.saturating_sub(self.motion.last);
        if room > unheard
            || (waits && room > Duration::ZERO)
            || (room > Duration::ZERO && self.clock.pace.take())
        {
            self.clock.pace.blocked = None;
            return true;
        }
        let ahead = self.link.outstanding().max(self.config.lookahead());
        let (since, limit) = *self
            .clock
            .pace
            .blocked
            .get_or_insert((self.clock.now, ahead + PATIENCE));
        if self.clock.now.saturating_sub(since) > limit {
            self.clock.pace.blocked = None;
            self.stop_late(say::board_full_too_long(limit.as_millis()));
        }
        false
    }

    /// Handles an absence of the host, measured by its own clock or by the wall clock.
    /// Motion that the board has run out of does not continue, and after a sleep no program
    /// does.
    pub fn judge_absence(&mut self, gap: Duration) {
        // A board of timed steps detects the absence on its own.
        if self.config.protocol != Protocol::Line || self.thread.pass.is_some() {
            return;
        }
        let orders = &self.control.orders;
        let dry = gap > EVERYDAY && gap + UNREPORTED > self.link.outstanding();
        let starved = orders.feeding && dry && self.link.takes_motion();
        if self.link.state() == LinkState::Moving {
            if starved || gap >= self.config.lookahead() {
                self.link.stop_after_absence();
            }
        } else if gap >= ASLEEP && orders.run.state == RunState::Run {
            self.stop_late(say::computer_busy());
        }
    }

    /// Ends the run: the motion in the board is executed, no more follows, and the counts
    /// are compared.
    fn stop_late(&mut self, why: Message) {
        self.report(BoardReport::Stopped);
        self.reports.late = Some((why, self.clock.now));
        if let Err(refused) = self.link.finish() {
            self.refuse(refused);
        }
    }
}
