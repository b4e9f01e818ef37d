//! The send queue: delivers messages to the board once and in order, with retransmission.
//!
//! Each block of the board has the sequence number of the block that it expects next. An
//! empty block that repeats the number is a NAK: a block was damaged.

use core::time::Duration;
use std::collections::VecDeque;

use super::super::HostTime;
use super::block::{self, CONTENT, LEAST};
use super::rate_limit::RateLimit;
use super::round_trip::{RoundTrip, SLOWEST_TRIP, USUAL_TRIP};
use super::sequence::Sequence;

/// Size of the receive window before the board has reported it, bytes.
const FIRST_WINDOW: usize = 64;
/// Size of the receive window of a board that does not report it, bytes.
const USUAL_WINDOW: usize = 1024;
/// Greatest number of blocks that are sent and not confirmed.
const MOST_BLOCKS: u64 = 12;
/// Number of unconfirmed blocks that are reserved for urgent messages.
const KEPT_BLOCKS: u64 = 2;
/// Number of bytes of the receive window that are reserved for urgent messages.
const KEPT_BYTES: usize = 20;
/// Age of an unconfirmed block from which on the link assumes that the serial line is slow.
const LONG_TRIP: Duration = Duration::from_millis(8);
/// Round trip that the link assumes for a serial line that may be slow.
const SUSPECTED_TRIP: Duration = Duration::from_millis(75);
/// Assumed average length of a message, bytes.
const USUAL_MESSAGE: f64 = 8.0;
/// Time without a confirmation after which the board is lost.
const SILENCE: Duration = Duration::from_millis(500);

/// A message that waits to be sent, with its delivery requirements.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct QueuedMessage {
    pub(super) bytes: Vec<u8>,
    /// Board clock before which the message must arrive, ticks; `None` for any time.
    pub(super) due: Option<u64>,
    /// Whether the message is part of motion and is dropped together with it.
    pub(super) motion: bool,
    /// The axis of a step message, whose first step is at `due`; `None` for other messages.
    pub(super) axis: Option<usize>,
    /// Whether the link stops when the message is late. Otherwise a late message is dropped.
    pub(super) vital: bool,
    /// The kind of a query whose reply must not be mistaken for that to an older query; `None` for
    /// other messages.
    pub(super) mark: Option<Mark>,
}

impl QueuedMessage {
    /// Creates a message from its bytes, with no delivery requirements.
    pub(super) const fn plain(bytes: Vec<u8>) -> Self {
        Self {
            bytes,
            due: None,
            motion: false,
            axis: None,
            vital: false,
            mark: None,
        }
    }

    fn is_late(&self, earliest: u64) -> bool {
        self.due.is_some_and(|due| due < earliest)
    }
}

/// The kind of a query of which only the newest one is of interest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mark {
    Uptime,
    Position,
    Group,
    Config,
    Switch,
}

/// The acknowledgement that a block from the board contains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ack {
    /// The board expects the block with this sequence number next.
    Expects(u64),
    /// The board has sent a sequence number that is not possible.
    Strange,
}

/// Two board clocks, ticks, for the check whether a message arrives in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Times {
    /// The current board clock.
    pub(super) now: u64,
    /// The latest board clock at which a message that is sent now arrives.
    pub(super) earliest: u64,
    /// The clock at which a retransmission sent now arrives at the latest, on a line that does
    /// not answer.
    pub(super) again: u64,
}

/// The reason for which the link must stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SendError {
    /// The board has not confirmed any block within the time limit.
    Silent,
    /// The board has restarted its sequence: it was reset.
    Restarted,
    /// A message with a due time would arrive too late.
    Late,
}

#[derive(Clone, Debug)]
struct Sent {
    messages: Vec<QueuedMessage>,
    bytes: usize,
    /// Host time at which the block was sent first.
    first: HostTime,
    /// Host time at which the block was sent last.
    at: HostTime,
}

/// The messages for a board that wait or are not confirmed.
#[derive(Clone, Debug)]
pub(super) struct SendQueue {
    window: usize,
    urgent: VecDeque<QueuedMessage>,
    waiting: VecDeque<QueuedMessage>,
    /// Unconfirmed blocks, the oldest first.
    in_flight: VecDeque<Sent>,
    sequence: Sequence,
    round_trip: RoundTrip,
    /// Whether the board has sent a NAK that the link has not handled yet.
    nak_received: bool,
    /// Host time at which the board last confirmed a block.
    progressed: HostTime,
    /// Sequence number of the block with the newest query of each kind.
    marks: [u64; 5],
    /// Board clock of the first step of X and of Z in the last confirmed block, ticks; `None`
    /// without a step.
    confirmed_steps: [Option<u64>; 2],
    /// Board clock of the first dropped step of X and of Z, ticks; `None` without one.
    dropped_steps: [Option<u64>; 2],
    rate_limit: RateLimit,
    pub(super) outgoing: Vec<u8>,
    pub(super) blocks: u64,
    pub(super) resent: u64,
}

impl SendQueue {
    pub(super) fn new() -> Self {
        Self {
            window: FIRST_WINDOW,
            urgent: VecDeque::new(),
            waiting: VecDeque::new(),
            in_flight: VecDeque::new(),
            sequence: Sequence::default(),
            round_trip: RoundTrip::default(),
            nak_received: false,
            progressed: HostTime::ZERO,
            marks: [u64::MAX; 5],
            confirmed_steps: [None; 2],
            dropped_steps: [None; 2],
            rate_limit: RateLimit::unlimited(),
            outgoing: Vec::new(),
            blocks: 0,
            resent: 0,
        }
    }

    /// Drops all messages and starts to query the sequence number that the board expects.
    pub(super) fn begin(&mut self) {
        *self = Self {
            sequence: Sequence::unknown(),
            blocks: self.blocks,
            resent: self.resent,
            window: self.window,
            rate_limit: self.rate_limit.clone(),
            ..Self::new()
        };
    }

    /// Sets the receive window of the board, bytes; `None` if the board does not report it.
    pub(super) fn set_window(&mut self, bytes: Option<u32>) {
        let bytes = bytes.map_or(USUAL_WINDOW, |bytes| bytes as usize);
        self.window = bytes.clamp(FIRST_WINDOW, 1 << 16);
    }

    /// Sets the greatest number of messages per second; `None` for no limit.
    pub(super) fn set_message_rate(&mut self, a_second: Option<u32>) {
        self.rate_limit.set_rate(a_second);
    }

    /// Whether messages of the motion wait, because the receive window is full or the rate limit is
    /// reached.
    pub(super) fn is_congested(&self) -> bool {
        self.waiting.iter().any(|message| message.motion)
    }

    /// Returns the time for sending all waiting messages and a number `more` of further
    /// messages of usual length.
    pub(super) fn time_for(&self, more: f64) -> Duration {
        let bytes = self.backlog() as f64 + more * USUAL_MESSAGE;
        let windows = bytes / self.window.saturating_sub(KEPT_BYTES).max(1) as f64;
        let trip = self.round_trip.usual().min(SLOWEST_TRIP);
        let by_window = trip.mul_f64(windows);
        let by_count = self.rate_limit.time_for(self.waiting.len() as f64 + more);
        by_count.max(by_window)
    }

    /// Does not count `gap`, the time for which the host was suspended, as round trip of the
    /// unconfirmed blocks.
    pub(super) fn skip_absence(&mut self, gap: Duration) {
        for sent in &mut self.in_flight {
            sent.first += gap;
        }
    }

    /// Whether messages of the motion wait because the rate limit is reached.
    pub(super) fn is_rate_limited(&self) -> bool {
        self.is_congested() && self.rate_limit.is_short()
    }

    /// Returns the round trip of the last confirmed block if it was slow; otherwise `None`.
    pub(super) fn last_slow_trip(&self) -> Option<Duration> {
        self.round_trip.last_slow()
    }

    /// Returns the time by which a message sent at the host time `now` may arrive later than on a
    /// fast serial line.
    pub(super) fn slowness_now(&self, now: HostTime) -> Duration {
        let oldest = self.in_flight.front();
        let waits = oldest.map_or(Duration::ZERO, |sent| now.saturating_sub(sent.first));
        if waits < LONG_TRIP {
            return self.round_trip.slowness();
        }
        // The line may stay silent: allow for its current delay.
        let waits = waits.clamp(SUSPECTED_TRIP, SLOWEST_TRIP);
        waits
            .saturating_sub(USUAL_TRIP)
            .max(self.round_trip.slowness())
    }

    /// Returns the host time at which the board last confirmed a block.
    pub(super) const fn progressed(&self) -> HostTime {
        self.progressed
    }

    /// Whether the sequence number that the board expects is known.
    pub(super) const fn is_synced(&self) -> bool {
        self.sequence.is_synced()
    }

    /// Returns how many queries for the sequence number that the board expects were sent since it
    /// became unknown; 0 if it is known.
    pub(super) const fn tries(&self) -> u32 {
        self.sequence.tries()
    }

    /// Whether no message waits or is unconfirmed.
    pub(super) fn is_empty(&self) -> bool {
        self.urgent.is_empty() && self.waiting.is_empty() && self.in_flight.is_empty()
    }

    /// Returns the total number of bytes in the waiting messages that are not urgent.
    pub(super) fn backlog(&self) -> usize {
        self.waiting.iter().map(|message| message.bytes.len()).sum()
    }

    pub(super) fn push(&mut self, message: QueuedMessage) {
        if message.axis.is_some() {
            // A new motion begins.
            self.dropped_steps = [None; 2];
        }
        self.waiting.push_back(message);
    }

    /// Adds a message before all messages that are not urgent.
    pub(super) fn push_urgent(&mut self, message: QueuedMessage) {
        self.urgent.push_back(message);
    }

    /// Drops all motion that is not confirmed. A block that may have arrived keeps its
    /// sequence number: the board accepts either the old or the new content.
    pub(super) fn drop_motion(&mut self) {
        self.dropped_steps = self.first_missing(false);
        self.waiting.retain(|message| !message.motion);
        for sent in &mut self.in_flight {
            sent.messages.retain(|message| !message.motion);
        }
    }

    /// Returns the board clock of the first unconfirmed step of X and of Z, ticks; `None` without
    /// one. With `in_last` the last confirmed block counts as unconfirmed, because the board may
    /// have shut down in it.
    pub(super) fn first_missing(&self, in_last: bool) -> [Option<u64>; 2] {
        let last = if in_last {
            self.confirmed_steps
        } else {
            [None; 2]
        };
        let sent = self.in_flight.iter().flat_map(|sent| &sent.messages);
        let waiting = first_steps(sent.chain(&self.waiting));
        [0, 1].map(|axis| {
            let known = [last[axis], self.dropped_steps[axis], waiting[axis]];
            known.into_iter().flatten().min()
        })
    }

    /// Whether a reply in a block of the board with the sequence number `expects` may answer the
    /// newest query of the kind `mark`.
    pub(super) fn answers(&self, mark: Mark, expects: u64) -> bool {
        self.marks[mark as usize] < expects
    }

    /// Takes the low four bits of the sequence number of a block of the board and returns what the
    /// board acknowledges; `None` while the expected number is unknown. `is_empty`: the block has
    /// no content.
    pub(super) fn block_received(
        &mut self,
        sequence: u8,
        is_empty: bool,
        now: HostTime,
    ) -> Option<Ack> {
        if !self.is_synced() {
            if is_empty {
                self.sequence.sync(sequence);
                self.progressed = now;
            }
            return None;
        }
        let Some((expects, arrived)) = self.sequence.received(sequence, now) else {
            return Some(Ack::Strange);
        };
        if arrived > 0 {
            self.confirm(arrived, now);
        }
        if is_empty && self.sequence.is_nak(expects, !self.in_flight.is_empty()) {
            self.nak_received = true;
        }
        Some(Ack::Expects(expects))
    }

    fn confirm(&mut self, count: u64, now: HostTime) {
        for _ in 0..count {
            if let Some(sent) = self.in_flight.pop_front() {
                // From the first transmission: this shows a slow line immediately, and a
                // lost block has little effect.
                self.round_trip.add(now.saturating_sub(sent.first));
                self.confirmed_steps = first_steps(&sent.messages);
            }
        }
        self.progressed = now;
        self.round_trip.reset_wait();
    }

    /// Sends the blocks that receive window, rate limit and timeouts allow. `times` are the board
    /// clocks for the check of due times; `None` for no check.
    ///
    /// # Errors
    /// The link must stop: the board does not answer or was reset, or a vital message is late.
    pub(super) fn send(&mut self, now: HostTime, times: Option<Times>) -> Result<(), SendError> {
        self.rate_limit.refill(now);
        if !self.is_synced() {
            if self.sequence.is_resync_due(now) {
                self.outgoing.extend(block::encode_block(0, &[]));
            }
            return Ok(());
        }
        if self.sequence.is_reset(now) {
            return Err(SendError::Restarted);
        }
        if !self.in_flight.is_empty() && now.saturating_sub(self.progressed) >= SILENCE {
            return Err(SendError::Silent);
        }
        let overdue = self
            .in_flight
            .front()
            .is_some_and(|sent| now.saturating_sub(sent.at) >= self.round_trip.wait());
        if (overdue || self.nak_received) && self.outgoing.is_empty() {
            self.retransmit(now, times, overdue)?;
        }
        self.send_new(now, times)
    }

    /// Retransmits the unconfirmed blocks, unless a step in them would be late. Such a block may
    /// have arrived, with its confirmation in transit. When the due time of the step has passed
    /// without a confirmation, returns [`SendError::Late`].
    fn retransmit(
        &mut self,
        now: HostTime,
        times: Option<Times>,
        overdue: bool,
    ) -> Result<(), SendError> {
        if let Some(times) = times {
            for sent in &mut self.in_flight {
                sent.messages
                    .retain(|message| message.vital || !message.is_late(times.again));
            }
            let due_in = |sent: &Sent| {
                let vital = sent.messages.iter().filter(|message| message.vital);
                vital.filter_map(|message| message.due).min()
            };
            // Greatest time for a confirmation.
            let timeout = 2 * self.round_trip.usual() + USUAL_TRIP;
            let missed = |sent: &Sent| {
                due_in(sent).is_some_and(|due| due < times.now)
                    && now.saturating_sub(sent.first) >= timeout
            };
            if self.in_flight.iter().any(missed) {
                return Err(SendError::Late);
            }
            let due = self.in_flight.iter().filter_map(due_in).min();
            if due.is_some_and(|due| due < times.again) {
                return Ok(());
            }
        }
        self.nak_received = false;
        if overdue {
            self.round_trip.wait_longer();
        }
        // The board answers duplicates like missing blocks.
        self.sequence.ignore_naks();
        let first = self.sequence.next() - self.in_flight.len() as u64;
        for (number, sent) in (first..).zip(&mut self.in_flight) {
            let content: Vec<u8> = sent
                .messages
                .iter()
                .flat_map(|message| message.bytes.clone())
                .collect();
            self.outgoing.extend(block::encode_block(number, &content));
            sent.at = now;
            self.resent += 1;
        }
        Ok(())
    }

    fn send_new(&mut self, now: HostTime, times: Option<Times>) -> Result<(), SendError> {
        loop {
            let in_flight: usize = self.in_flight.iter().map(|sent| sent.bytes).sum();
            let blocks = self.in_flight.len() as u64;
            let mut messages = Vec::new();
            let mut content = Vec::new();
            for urgent in [true, false] {
                let (queue, kept_blocks, kept_bytes) = match urgent {
                    true => (&mut self.urgent, 0, 0),
                    false => (
                        &mut self.waiting,
                        KEPT_BLOCKS,
                        KEPT_BYTES.min(self.window / 4),
                    ),
                };
                let space = self.window.saturating_sub(in_flight + kept_bytes);
                let space = space.min(CONTENT + LEAST).saturating_sub(LEAST);
                if blocks + kept_blocks >= MOST_BLOCKS {
                    break;
                }
                while let Some(message) = queue.front() {
                    if let Some(times) = times
                        && message.is_late(times.earliest)
                    {
                        if message.vital {
                            return Err(SendError::Late);
                        }
                        // A message that is renewed periodically may be dropped.
                        queue.pop_front();
                        continue;
                    }
                    let full = content.len() + message.bytes.len() > space;
                    if full || !(urgent || self.rate_limit.allows()) {
                        break;
                    }
                    self.rate_limit.take();
                    content.extend_from_slice(&message.bytes);
                    messages.extend(queue.pop_front());
                }
                if urgent && !queue.is_empty() {
                    break;
                }
            }
            if messages.is_empty() {
                return Ok(());
            }
            for mark in messages.iter().filter_map(|message| message.mark) {
                self.marks[mark as usize] = self.sequence.next();
            }
            if self.in_flight.is_empty() {
                self.progressed = now;
            }
            let bytes = block::encode_block(self.sequence.take(), &content);
            self.in_flight.push_back(Sent {
                messages,
                bytes: bytes.len(),
                first: now,
                at: now,
            });
            self.outgoing.extend(bytes);
            self.blocks += 1;
        }
    }
}

/// Returns the board clock of the first step of X and of Z in some messages, ticks; `None` without
/// a step.
fn first_steps<'a>(messages: impl IntoIterator<Item = &'a QueuedMessage>) -> [Option<u64>; 2] {
    let mut first: [Option<u64>; 2] = [None; 2];
    for message in messages {
        if let (Some(axis), Some(due)) = (message.axis, message.due) {
            let first = &mut first[axis];
            *first = Some(first.map_or(due, |first| first.min(due)));
        }
    }
    first
}

#[cfg(test)]
mod tests;
