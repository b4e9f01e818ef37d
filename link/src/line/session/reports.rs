//! Status reports of a line board: pending queries and the last report.

use core::time::Duration;

use super::ANSWER_TIME;
use crate::line::response::{BoardState, StatusReport};
use crate::{HostTime, Pins};
use gsk_units::{PerAxis, Pulses};

/// Time for which the reported position must be constant to count as a standstill: after a
/// reset the pulse timer of the board finishes its segments.
const STEADY: Duration = Duration::from_millis(150);

/// The position by the board's last count, in the kernel's pulses.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ReportedPosition {
    /// The position is unknown, because the counts of board and kernel were never aligned.
    Unknown,
    /// The position by the board's last count, while the counts of board and kernel are aligned.
    Live(PerAxis<Pulses>),
    /// The position before the board restarted its count; it may be out of date.
    Stale(PerAxis<Pulses>),
}

/// The last status report and the pending query for the next one.
#[derive(Clone, Debug)]
pub(super) struct Reports {
    /// Host time at which the pending status query was sent; `None` without one.
    pub(super) queried_at: Option<HostTime>,
    last_query: HostTime,
    /// Host time at which the newest of the answered status queries was sent.
    answered: HostTime,
    pub(super) status: Option<StatusReport>,
    /// The switches that the last status report names; kept when the board restarts.
    pub(super) pins: Pins,
    still_since: Option<HostTime>,
    count: ReportedPosition,
    /// Host time at which the reported position last changed.
    changed: HostTime,
}

impl Reports {
    pub(super) fn new(now: HostTime) -> Self {
        Self {
            queried_at: None,
            last_query: now,
            answered: now,
            status: None,
            pins: Pins::default(),
            still_since: None,
            count: ReportedPosition::Unknown,
            changed: now,
        }
    }

    /// Returns the board's state in the last report; `None` without a report.
    pub(super) fn state(&self) -> Option<BoardState> {
        self.status.map(|status| status.state)
    }

    /// Returns the host time of the first report of the current standstill; `None` during motion.
    pub(super) const fn still_since(&self) -> Option<HostTime> {
        self.still_since
    }

    /// Stores a report and returns the round trip of its query; `None` if it was not queried.
    pub(super) fn take(&mut self, status: StatusReport, now: HostTime) -> Option<Duration> {
        let queried_at = self.queried_at.take();
        self.answered = queried_at.unwrap_or(self.answered);
        self.status = Some(status);
        self.pins = status.pins;
        queried_at.map(|queried_at| now.saturating_sub(queried_at))
    }

    /// Stores the host time `now` as the start of a standstill if `state` is idle and no start is
    /// stored. Clears the start if `state` is not idle.
    pub(super) fn note_standstill(&mut self, state: BoardState, now: HostTime) {
        if state == BoardState::Idle {
            self.still_since.get_or_insert(now);
        } else {
            self.still_since = None;
        }
    }

    /// Clears the time since which the board reports standstill.
    pub(super) const fn forget_standstill(&mut self) {
        self.still_since = None;
    }

    /// Discards the last report and the pending query.
    pub(super) const fn invalidate(&mut self) {
        self.status = None;
        self.queried_at = None;
    }

    /// Discards the last report, the pending query and the time of the standstill.
    pub(super) const fn forget(&mut self) {
        self.invalidate();
        self.still_since = None;
    }

    /// Whether a status query is due after `interval`; never while a query is pending.
    pub(super) fn is_due(&self, interval: Duration, now: HostTime) -> bool {
        self.queried_at.is_none() && now.saturating_sub(self.last_query) >= interval
    }

    /// Records that a status query is sent at time `now`.
    pub(super) const fn note_query(&mut self, now: HostTime) {
        self.queried_at = Some(now);
        self.last_query = now;
    }

    /// Makes the next query due immediately.
    pub(super) const fn hurry(&mut self) {
        self.last_query = HostTime::ZERO;
    }

    /// Forgets the pending status query if its answer is overdue: the link then repeats the query.
    pub(super) fn give_up_question(&mut self, now: HostTime) {
        if !self.is_responding(now) {
            self.queried_at = None;
        }
    }

    /// Whether the board has answered a status query that was sent at or after the host time
    /// `moment`.
    pub(super) fn has_answered_since(&self, moment: HostTime) -> bool {
        self.answered >= moment
    }

    /// Whether no status query has been pending for longer than [`ANSWER_TIME`].
    fn is_responding(&self, now: HostTime) -> bool {
        self.queried_at
            .is_none_or(|queried_at| now.saturating_sub(queried_at) < ANSWER_TIME)
    }

    /// Returns the position by the board's last count, in the kernel's pulses; `None` if the counts
    /// of board and kernel were never aligned.
    pub(super) const fn position(&self) -> Option<PerAxis<Pulses>> {
        match self.count {
            ReportedPosition::Unknown => None,
            ReportedPosition::Live(position) | ReportedPosition::Stale(position) => Some(position),
        }
    }

    /// Records that the counts of board and kernel are aligned at the position `kernel`.
    pub(super) const fn align(&mut self, kernel: PerAxis<Pulses>) {
        self.count = ReportedPosition::Live(kernel);
    }

    /// Whether the counts of board and kernel are aligned, so that reports give the position.
    pub(super) const fn counts(&self) -> bool {
        matches!(self.count, ReportedPosition::Live(_))
    }

    /// Records the board's count, converted to the kernel's pulses, if the counts are aligned.
    pub(super) fn count(&mut self, kernel: PerAxis<Pulses>, now: HostTime) {
        if let ReportedPosition::Live(before) = self.count {
            if before != kernel {
                self.changed = now;
            }
            self.count = ReportedPosition::Live(kernel);
        }
    }

    /// Keeps the last position as out of date, because the board restarts its count.
    pub(super) const fn freeze_count(&mut self) {
        if let ReportedPosition::Live(position) = self.count {
            self.count = ReportedPosition::Stale(position);
        }
    }

    /// Discards the position and the alignment of the counts.
    pub(super) const fn forget_count(&mut self) {
        self.count = ReportedPosition::Unknown;
    }

    /// Whether the reported position has changed within the last [`STEADY`]: the axes may still
    /// move.
    pub(super) fn is_settling(&self, now: HostTime) -> bool {
        now.saturating_sub(self.changed) < STEADY
    }
}
