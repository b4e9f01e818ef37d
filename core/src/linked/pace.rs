//! When the kernel may make its next tick, and when the board ran dry.

use core::time::Duration;

use super::Linked;
use crate::board::BoardReport;
use crate::run_state::RunState;
use gsk_link::{HostTime, LinkState, Protocol, RunTime};
use gsk_messages::{Message, say};

/// Ticks of the host's clock that are caught up at most.
const MOST_DUE: u64 = 40;
/// Shorter gaps between two looks at the port are everyday.
const EVERYDAY: Duration = Duration::from_millis(30);
/// The board may have made so much more than it has reported: it is asked every 20 ms.
const UNREPORTED: Duration = Duration::from_millis(25);
/// A program that stood still for so long, in a dwell or waiting, does not go on by itself.
const ASLEEP: Duration = Duration::from_secs(1);
/// The board may make motion this much later than the host's clock says.
const PATIENCE: Duration = Duration::from_millis(100);
const TICK: Duration = Duration::from_millis(1);

/// Time of the host that the kernel has not used.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pace {
    passed: Duration,
    /// Since when moving slides have had no room, and how long that may take.
    blocked: Option<(HostTime, Duration)>,
}

/// Time of the host and of the kernel.
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

    /// The host's clock goes on; by how much.
    pub(super) fn passes(&mut self, now: HostTime) -> Duration {
        let gap = now.saturating_sub(self.now);
        self.now = self.now.max(now);
        self.pace.passes(gap);
        gap
    }
}

/// What a tick says of the power of the control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PowerEvent {
    /// The control has ticked.
    Tick,
    /// Its power has just gone off or come back: its count of pulses begins anew.
    Lost,
    /// It is still off.
    None,
}

/// Power of the control, as its ticks show it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Power {
    /// Ticks of the control at the last look: a stop or a jump back is the power.
    ticks: u64,
    on: bool,
}

impl Power {
    pub(super) const fn new(ticks: u64) -> Self {
        Self { ticks, on: true }
    }

    /// A tick is over, and the control counts so many.
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
    /// Whether the kernel may make a tick now. While slides move the board sets the
    /// time, else the host's clock does.
    pub fn may_tick(&mut self) -> bool {
        if self.thread.pass.is_some() || !self.reports.are_heard() {
            // The board cuts by itself, the control looks on; or it is to hear what
            // happened, whatever there is room for.
            self.clock.pace.blocked = None;
            return self.clock.pace.take();
        }
        // A thread that waits for its index takes time in the board, and keeps as far
        // ahead of it as motion does: a pause of the host must not part its begin from
        // the index that it was shown.
        let orders = &self.control.orders;
        let waits = self.spindle.view.is_some() && orders.spindle.waits;
        let moves = self.motion.moved || orders.moving || waits;
        if !moves || !self.link.takes_motion() {
            self.clock.pace.blocked = None;
            return self.clock.pace.take();
        }
        let room = self.link.free_lookahead();
        // Time without a pulse, at the lowest feeds, is ahead of the board too.
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

    /// The host was away for so long, by its own clock or by the one on the wall: motion
    /// that the board has run out of does not go on, and after a sleep no program does.
    pub fn judge_absence(&mut self, gap: Duration) {
        // A board of timed steps notices by itself.
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

    /// What was handed over is made; nothing more follows, and the count is compared.
    fn stop_late(&mut self, why: Message) {
        self.report(BoardReport::Stopped);
        self.reports.late = Some((why, self.clock.now));
        if let Err(refused) = self.link.finish() {
            self.refuse(refused);
        }
    }
}
