//! Messages reach the board once and in order, or the link is lost.
//!
//! Every block of the board carries the number of the block it expects next. An
//! empty block that says the same number again complains about a block that came
//! damaged.

use core::time::Duration;
use std::collections::VecDeque;

use super::super::HostTime;
use super::block::{self, CONTENT, LEAST};
use super::rate_limit::RateLimit;
use super::round_trip::{RoundTrip, SLOWEST_TRIP, USUAL_TRIP};
use super::sequence::Sequence;

/// Unanswered bytes before the board has said how many it can keep, and when it
/// does not report.
const FIRST_WINDOW: usize = 64;
const USUAL_WINDOW: usize = 1024;
/// Blocks under way at once.
const MOST_BLOCKS: u64 = 12;
/// Blocks and bytes of the window that motion leaves to what is urgent.
const KEPT_BLOCKS: u64 = 2;
const KEPT_BYTES: usize = 20;
/// A block that has waited so long for its answer tells of a line that may take as
/// long as that.
const LONG_TRIP: Duration = Duration::from_millis(8);
const SUSPECTED_TRIP: Duration = Duration::from_millis(75);
/// Bytes of a message.
const USUAL_MESSAGE: f64 = 8.0;
/// Without progress for so long the board is lost.
const SILENCE: Duration = Duration::from_millis(500);
/// A message and what it is for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Message {
    pub(super) bytes: Vec<u8>,
    /// Board clock before which it must have arrived.
    pub(super) due: Option<u64>,
    /// It moves an axis: dropped when motion is.
    pub(super) motion: bool,
    /// It makes steps of this axis, the first at `due`.
    pub(super) axis: Option<usize>,
    /// It must not be left out when it is late.
    pub(super) vital: bool,
    /// It asks for a reply that must not be mistaken for an older one.
    pub(super) mark: Option<Mark>,
}

impl Message {
    /// Whenever there is room.
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

/// Replies that must belong to the newest question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mark {
    Uptime,
    Position,
    Group,
    Config,
    Switch,
}

/// What a block of the board tells of the blocks sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ack {
    /// So many blocks have arrived.
    Expects(u64),
    /// A number that cannot be.
    Strange,
}

/// Board clocks that tell what is still in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Times {
    /// The clock now.
    pub(super) now: u64,
    /// Nothing that is sent now is sure to arrive before this.
    pub(super) earliest: u64,
    /// The same, on a line that does not answer.
    pub(super) again: u64,
}

/// What went wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SendError {
    /// No answer.
    Silent,
    /// The board counts its blocks anew: it was reset.
    Restarted,
    /// A message would come too late for the time it names.
    Late,
}

#[derive(Clone, Debug)]
struct Sent {
    messages: Vec<Message>,
    bytes: usize,
    /// When it was sent first, and when last.
    first: HostTime,
    at: HostTime,
}

/// What is on its way to the board.
#[derive(Clone, Debug)]
pub(super) struct SendQueue {
    window: usize,
    urgent: VecDeque<Message>,
    waiting: VecDeque<Message>,
    /// Blocks the board has not confirmed, the oldest first.
    in_flight: VecDeque<Sent>,
    sequence: Sequence,
    round_trip: RoundTrip,
    /// The board has complained about a block that came damaged.
    nak_received: bool,
    /// When the board last confirmed something.
    progressed: HostTime,
    /// Number of the block that held the newest question of each kind.
    marks: [u64; 5],
    /// First steps of each axis in the block that was confirmed last, and in what was
    /// dropped, as clocks.
    confirmed_steps: [Option<u64>; 2],
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

    /// Forgets everything and learns anew which block the board expects.
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

    /// So many bytes the board keeps; `None`: it does not report.
    pub(super) fn set_window(&mut self, bytes: Option<u32>) {
        let bytes = bytes.map_or(USUAL_WINDOW, |bytes| bytes as usize);
        self.window = bytes.clamp(FIRST_WINDOW, 1 << 16);
    }

    /// In no second the board is given more messages; none: as many as the wire takes.
    pub(super) fn set_message_rate(&mut self, a_second: Option<u32>) {
        self.rate_limit.set_rate(a_second);
    }

    /// Motion waits for the wire, for answers, or for its share of the messages.
    pub(super) fn is_congested(&self) -> bool {
        self.waiting.iter().any(|message| message.motion)
    }

    /// Time until all messages that wait, and so many more, have gone.
    pub(super) fn time_for(&self, more: f64) -> Duration {
        let bytes = self.backlog() as f64 + more * USUAL_MESSAGE;
        let windows = bytes / self.window.saturating_sub(KEPT_BYTES).max(1) as f64;
        let trip = self.round_trip.usual().min(SLOWEST_TRIP);
        let by_window = trip.mul_f64(windows);
        let by_count = self.rate_limit.time_for(self.waiting.len() as f64 + more);
        by_count.max(by_window)
    }

    /// The host was away for so long: what came meanwhile is heard only now.
    pub(super) fn skip_absence(&mut self, gap: Duration) {
        for sent in &mut self.in_flight {
            sent.first += gap;
        }
    }

    /// Motion waits because the board is not to be given more messages now.
    pub(super) fn is_rate_limited(&self) -> bool {
        self.is_congested() && self.rate_limit.is_short()
    }

    /// How long the last block that was confirmed was under way, where that is long.
    pub(super) fn last_slow_trip(&self) -> Option<Duration> {
        self.round_trip.last_slow()
    }

    /// How much longer than usual it may take now.
    pub(super) fn slowness_now(&self, now: HostTime) -> Duration {
        let oldest = self.in_flight.front();
        let waits = oldest.map_or(Duration::ZERO, |sent| now.saturating_sub(sent.first));
        if waits < LONG_TRIP {
            return self.round_trip.slowness();
        }
        // What goes now may be all that goes before the line answers again.
        let waits = waits.clamp(SUSPECTED_TRIP, SLOWEST_TRIP);
        waits
            .saturating_sub(USUAL_TRIP)
            .max(self.round_trip.slowness())
    }

    /// When the board last confirmed something.
    pub(super) const fn progressed(&self) -> HostTime {
        self.progressed
    }

    /// Whether it is known which block the board expects.
    pub(super) const fn is_synced(&self) -> bool {
        self.sequence.is_synced()
    }

    /// How often that was asked.
    pub(super) const fn tries(&self) -> u32 {
        self.sequence.tries()
    }

    /// Nothing waits and nothing is unconfirmed.
    pub(super) fn is_empty(&self) -> bool {
        self.urgent.is_empty() && self.waiting.is_empty() && self.in_flight.is_empty()
    }

    /// Bytes that wait or are unconfirmed.
    pub(super) fn backlog(&self) -> usize {
        self.waiting.iter().map(|message| message.bytes.len()).sum()
    }

    pub(super) fn push(&mut self, message: Message) {
        if message.axis.is_some() {
            // Motion begins anew.
            self.dropped_steps = [None; 2];
        }
        self.waiting.push_back(message);
    }

    /// Before everything that waits.
    pub(super) fn push_urgent(&mut self, message: Message) {
        self.urgent.push_back(message);
    }

    /// Drops all motion the board has not got. Blocks that may have arrived keep
    /// their number: either the old one was taken, or the new one will be.
    pub(super) fn drop_motion(&mut self) {
        self.dropped_steps = self.first_missing(false);
        self.waiting.retain(|message| !message.motion);
        for sent in &mut self.in_flight {
            sent.messages.retain(|message| !message.motion);
        }
    }

    /// The first steps of each axis that the board has not confirmed, as clocks; of the
    /// block it confirmed last, too, when it may have given up in it.
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

    /// Whether a reply that came with `expects` answers the newest question.
    pub(super) fn answers(&self, mark: Mark, expects: u64) -> bool {
        self.marks[mark as usize] < expects
    }

    /// A block came.
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
                // From its first sending: a line that has become slow shows at once,
                // and a lost block does not make much of a difference.
                self.round_trip.add(now.saturating_sub(sent.first));
                self.confirmed_steps = first_steps(&sent.messages);
            }
        }
        self.progressed = now;
        self.round_trip.reset_wait();
    }

    /// Puts on the wire what may go.
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

    /// Blocks that are in doubt go once more, unless a step in them would come late:
    /// they may have arrived, and their confirmation be on its way. Only when the step
    /// should have been made there is nothing left to wait for.
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
            // Longer than that no confirmation takes.
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
        // Blocks that come twice are answered as if something were missing.
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
                        // What is renewed all the time does no harm when it is missing.
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

/// Clocks of the first steps of each axis in some messages.
fn first_steps<'a>(messages: impl IntoIterator<Item = &'a Message>) -> [Option<u64>; 2] {
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
