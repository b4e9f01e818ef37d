//! Decides when the kernel may make its next tick, and detects a board that ran dry.

use core::time::Duration;

use super::LinkedControl;
use crate::board::BoardReport;
use crate::run_state::RunState;
use gsk_link::{HostTime, LinkState, Protocol, RunTime};
use gsk_messages::{Message, say};

/// Most ticks of the host's clock that the kernel catches up.
const MAX_CATCH_UP_TICKS: u64 = 40;
/// Gaps between two polls of the port up to this are normal.
const NORMAL_POLL_GAP: Duration = Duration::from_millis(30);
/// Duration of the motion that the board may have made since its last report; the link
/// queries it every 20 ms.
const REPORT_AGE: Duration = Duration::from_millis(25);
/// After an absence of the host of this duration, a program in a dwell or a wait is
/// stopped.
const SLEEP_THRESHOLD: Duration = Duration::from_secs(1);
/// Time by which the board may execute motion later than the host's clock predicts.
const BLOCKED_MARGIN: Duration = Duration::from_millis(100);
const TICK: Duration = Duration::from_millis(1);

/// Host time that the kernel has not used for ticks yet.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TickPace {
    unused: Duration,
    /// Host time since which moving slides have had no free lookahead, and the permitted
    /// duration; `None` while there is some.
    blocked_since: Option<(HostTime, Duration)>,
}

/// Host time and kernel time of a link.
#[derive(Clone, Copy, Debug)]
pub(super) struct LinkClock {
    pub(super) now: HostTime,
    /// Kernel time since the link was opened.
    pub(super) run: RunTime,
    pub(super) pace: TickPace,
}

impl LinkClock {
    pub(super) fn new(now: HostTime) -> Self {
        Self {
            now,
            run: RunTime::ZERO,
            pace: TickPace::default(),
        }
    }

    /// Advances the host time to `now` and returns the time since the last call.
    pub(super) fn advance(&mut self, now: HostTime) -> Duration {
        let gap = now.saturating_sub(self.now);
        self.now = self.now.max(now);
        self.pace.add_time(gap);
        gap
    }
}

/// Whether a tick has switched the control on or off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PowerChange {
    /// The control has executed the tick: its power is on.
    Tick,
    /// The power has just been lost or has come back: the pulse count starts at zero.
    Lost,
    /// The power of the control is still off.
    None,
}

/// Power state of the control, derived from its tick count.
#[derive(Clone, Copy, Debug)]
pub(super) struct PowerWatch {
    /// The control's tick count at the last check. If it stops or jumps back, the power was
    /// off.
    ticks: u64,
    on: bool,
}

impl PowerWatch {
    pub(super) const fn new(ticks: u64) -> Self {
        Self { ticks, on: true }
    }

    /// Compares the control's tick count after a tick with the previous one.
    pub(super) const fn tick(&mut self, ticks: u64) -> PowerChange {
        let before = core::mem::replace(&mut self.ticks, ticks);
        let was_on = self.on;
        self.on = ticks != before;
        if ticks > before {
            PowerChange::Tick
        } else if was_on || self.on {
            PowerChange::Lost
        } else {
            PowerChange::None
        }
    }
}

impl TickPace {
    fn add_time(&mut self, time: Duration) {
        self.unused = (self.unused + time).min(TICK * MAX_CATCH_UP_TICKS as u32);
    }

    fn take_tick(&mut self) -> bool {
        match self.unused.checked_sub(TICK) {
            Some(rest) => {
                self.unused = rest;
                true
            }
            None => false,
        }
    }
}

impl LinkedControl {
    /// Whether the kernel may make a tick now. While slides move the board sets the pace,
    /// otherwise the host's clock does.
    pub fn can_tick(&mut self) -> bool {
        if self.thread.is_active() || !self.reports.are_delivered() {
            // The board cuts the pass and the control follows, or reports wait for the
            // control. The free lookahead does not matter in either case.
            self.clock.pace.blocked_since = None;
            return self.clock.pace.take_tick();
        }
        // A thread that waits for its index takes time in the board and stays as far ahead
        // of it as motion does. A pause of the host must not separate the start of the
        // thread from the index that the control saw.
        let orders = &self.control.orders;
        let waits = self.spindle.view.is_some() && orders.spindle.waits_for_angle;
        let moves = self.motion.moved || orders.is_moving || waits;
        if !moves || !self.link.takes_motion() {
            self.clock.pace.blocked_since = None;
            return self.clock.pace.take_tick();
        }
        let free_lookahead = self.link.free_lookahead();
        if self.link.waits_for_spindle() {
            // The link watches that the spindle turns.
            self.clock.pace.blocked_since = None;
            return free_lookahead > Duration::ZERO;
        }
        // Time without a pulse, at the lowest feeds, is also ahead of the board.
        let since_last_motion = self.clock.run.saturating_sub(self.motion.last_motion_end);
        if free_lookahead > since_last_motion
            || (waits && free_lookahead > Duration::ZERO)
            || (free_lookahead > Duration::ZERO && self.clock.pace.take_tick())
        {
            self.clock.pace.blocked_since = None;
            return true;
        }
        let ahead = self.link.outstanding().max(self.config.lookahead());
        let (since, limit) = *self
            .clock
            .pace
            .blocked_since
            .get_or_insert((self.clock.now, ahead + BLOCKED_MARGIN));
        if self.clock.now.saturating_sub(since) > limit {
            self.clock.pace.blocked_since = None;
            self.stop_late_run(say::board_full_too_long(limit.as_millis()));
        }
        false
    }

    /// Handles a time in which this program did not run (`gap`), measured by the host's
    /// clock or the wall clock. Motion that the board has run out of does not continue, and
    /// after a sleep no program does.
    pub fn handle_host_gap(&mut self, gap: Duration) {
        // A board of timed steps detects the absence on its own.
        if self.config.protocol != Protocol::Line || self.thread.is_active() {
            return;
        }
        let orders = &self.control.orders;
        let ran_dry = gap > NORMAL_POLL_GAP && gap + REPORT_AGE > self.link.outstanding();
        let starved = orders.is_feeding && ran_dry && self.link.takes_motion();
        if self.link.state() == LinkState::Moving {
            if starved || gap >= self.config.lookahead() {
                self.link.stop_after_absence();
            }
        } else if gap >= SLEEP_THRESHOLD && orders.run.run_state == RunState::Run {
            self.stop_late_run(say::computer_busy());
        }
    }

    /// Stops the run because of `why`: the board executes the motion that it holds, no more
    /// follows, and the counts are compared.
    fn stop_late_run(&mut self, why: Message) {
        self.report(BoardReport::RunStopped);
        self.reports.late_motion = Some((why, self.clock.now));
        if let Err(refused) = self.link.finish() {
            self.reject_motion(refused);
        }
    }
}
