//! Status reports of the board: when one is asked for, and what the last one said.

use core::time::Duration;

use super::ANSWER_TIME;
use crate::line::response::{BoardState, StatusReport};
use crate::{HostTime, Pins};
use gsk_units::{PerAxis, Pulses};

/// A position that was reported for so long is where the slides stand: behind a reset the
/// pulse timer of a board goes on with what it has been handed.
const STEADY: Duration = Duration::from_millis(150);

/// Where the board was by its last count, in the kernel's pulses.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Count {
    /// It and the kernel's have not been put together.
    Unknown,
    /// Its reports still count from there.
    Live(PerAxis<Pulses>),
    /// It has begun to count anew since.
    Stale(PerAxis<Pulses>),
}

/// What the board reports of itself.
#[derive(Clone, Debug)]
pub(super) struct Reports {
    /// When a report was asked for that has not come.
    pub(super) queried_at: Option<HostTime>,
    last_query: HostTime,
    /// When the newest question was asked that was answered.
    answered: HostTime,
    pub(super) status: Option<StatusReport>,
    /// Switches as last reported; a restart says nothing about them.
    pub(super) pins: Pins,
    still_since: Option<HostTime>,
    count: Count,
    /// When the count last changed.
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
            count: Count::Unknown,
            changed: now,
        }
    }

    /// What the board was doing when it last reported.
    pub(super) fn state(&self) -> Option<BoardState> {
        self.status.map(|status| status.state)
    }

    /// Since when the board has reported itself standing.
    pub(super) const fn still_since(&self) -> Option<HostTime> {
        self.still_since
    }

    /// Takes a report; how long it was waited for, if it was asked for.
    pub(super) fn take(&mut self, status: StatusReport, now: HostTime) -> Option<Duration> {
        let queried_at = self.queried_at.take();
        self.answered = queried_at.unwrap_or(self.answered);
        self.status = Some(status);
        self.pins = status.pins;
        queried_at.map(|queried_at| now.saturating_sub(queried_at))
    }

    /// The board stands, or does not.
    pub(super) fn note_standstill(&mut self, state: BoardState, now: HostTime) {
        if state == BoardState::Idle {
            self.still_since.get_or_insert(now);
        } else {
            self.still_since = None;
        }
    }

    /// What was reported says nothing about the standstill to come.
    pub(super) const fn forget_standstill(&mut self) {
        self.still_since = None;
    }

    /// What was reported holds no more, and no report is on its way.
    pub(super) const fn invalidate(&mut self) {
        self.status = None;
        self.queried_at = None;
    }

    /// The same, of a standstill too.
    pub(super) const fn forget(&mut self) {
        self.invalidate();
        self.still_since = None;
    }

    /// Whether a report is due.
    pub(super) fn is_due(&self, interval: Duration, now: HostTime) -> bool {
        self.queried_at.is_none() && now.saturating_sub(self.last_query) >= interval
    }

    /// A report is asked for now.
    pub(super) const fn query_status_if_due(&mut self, now: HostTime) {
        self.queried_at = Some(now);
        self.last_query = now;
    }

    /// The next report is due at once.
    pub(super) const fn hurry(&mut self) {
        self.last_query = HostTime::ZERO;
    }

    /// A question without an answer is given up, so that it is asked again.
    pub(super) fn give_up_question(&mut self, now: HostTime) {
        if !self.is_responding(now) {
            self.queried_at = None;
        }
    }

    /// Whether a question was answered that was asked no earlier than this.
    pub(super) fn has_answered_since(&self, moment: HostTime) -> bool {
        self.answered >= moment
    }

    /// Whether the board answers what it is asked.
    fn is_responding(&self, now: HostTime) -> bool {
        self.queried_at
            .is_none_or(|queried_at| now.saturating_sub(queried_at) < ANSWER_TIME)
    }

    /// Where the board was by its last count.
    pub(super) const fn position(&self) -> Option<PerAxis<Pulses>> {
        match self.count {
            Count::Unknown => None,
            Count::Live(position) | Count::Stale(position) => Some(position),
        }
    }

    /// The count of the board and that of the kernel are put together here.
    pub(super) const fn align(&mut self, kernel: PerAxis<Pulses>) {
        self.count = Count::Live(kernel);
    }

    /// Whether its reports still count from where both were put together.
    pub(super) const fn counts(&self) -> bool {
        matches!(self.count, Count::Live(_))
    }

    /// The board has counted so far, in the kernel's pulses.
    pub(super) fn count(&mut self, kernel: PerAxis<Pulses>, now: HostTime) {
        if let Count::Live(before) = self.count {
            if before != kernel {
                self.changed = now;
            }
            self.count = Count::Live(kernel);
        }
    }

    /// The board counts anew: its last count stays what it was.
    pub(super) const fn freeze_count(&mut self) {
        if let Count::Live(position) = self.count {
            self.count = Count::Stale(position);
        }
    }

    /// The count says nothing any more.
    pub(super) const fn forget_count(&mut self) {
        self.count = Count::Unknown;
    }

    /// Whether it may still change: it has changed of late.
    pub(super) fn is_settling(&self, now: HostTime) -> bool {
        now.saturating_sub(self.changed) < STEADY
    }
}
