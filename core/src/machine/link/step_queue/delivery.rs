//! Messages reach the board once and in order, or the link is lost.
//!
//! Every block of the board carries the number of the block it expects next. An
//! empty block that says the same number again complains about a block that came
//! damaged.

use core::time::Duration;
use std::collections::VecDeque;

use super::super::HostTime;
use super::block::{self, CONTENT, LEAST};
use super::meter::Meter;

/// Unanswered bytes before the board has said how many it can keep, and when it
/// does not say.
const FIRST_WINDOW: usize = 64;
const USUAL_WINDOW: usize = 1024;
/// Blocks under way at once.
const MOST_BLOCKS: u64 = 12;
/// Sent again after this or four round trips; doubled to the most.
const LEAST_WAIT: Duration = Duration::from_millis(25);
const MOST_WAIT: Duration = Duration::from_secs(1);
/// Blocks and bytes of the window that motion leaves to what is urgent.
const KEPT_BLOCKS: u64 = 2;
const KEPT_BYTES: usize = 20;
/// A line that takes longer than this to answer is slow; it is not waited for longer
/// than that.
const USUAL_TRIP: Duration = Duration::from_millis(25);
/// A block that has waited so long for its answer tells of a line that may take as
/// long as that.
const LONG_TRIP: Duration = Duration::from_millis(8);
const SUSPECTED_TRIP: Duration = Duration::from_millis(75);
/// Bytes of a message.
const USUAL_MESSAGE: f64 = 8.0;
const SLOWEST_TRIP: Duration = Duration::from_millis(200);
/// Without progress for so long the board is lost.
const SILENCE: Duration = Duration::from_millis(500);
/// Between two tries to learn the next number, and how many.
const RESYNC_EVERY: Duration = Duration::from_millis(100);
/// A number that cannot be the next, said for so long: the board counts anew.
const STRANGE: Duration = Duration::from_millis(100);

/// A message and what it is for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Message {
    pub(super) bytes: Vec<u8>,
    /// Board clock before which it must have arrived.
    pub(super) due: Option<u64>,
    /// It moves an axis: dropped when motion is.
    pub(super) motion: bool,
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
pub(super) enum Heard {
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
pub(super) enum Trouble {
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
pub(super) struct Delivery {
    window: usize,
    urgent: VecDeque<Message>,
    waiting: VecDeque<Message>,
    /// Blocks the board has not confirmed, the oldest first.
    under_way: VecDeque<Sent>,
    /// Number of the next block to send; of the next one the board expects.
    next: u64,
    expected: u64,
    last_empty: Option<u64>,
    /// Complaints below this are about blocks that were sent again already.
    deaf_below: u64,
    again: bool,
    round_trip: Option<Duration>,
    last_trip: Duration,
    wait: Duration,
    progressed: HostTime,
    strange_since: Option<HostTime>,
    /// Tries to learn the number the board expects; none: it is known.
    resync: Option<(u32, HostTime)>,
    marks: [u64; 5],
    meter: Meter,
    pub(super) outgoing: Vec<u8>,
    pub(super) blocks: u64,
    pub(super) resent: u64,
}

impl Delivery {
    pub(super) fn new() -> Self {
        Self {
            window: FIRST_WINDOW,
            urgent: VecDeque::new(),
            waiting: VecDeque::new(),
            under_way: VecDeque::new(),
            next: 0,
            expected: 0,
            last_empty: None,
            deaf_below: 0,
            again: false,
            round_trip: None,
            last_trip: Duration::ZERO,
            wait: LEAST_WAIT,
            progressed: HostTime::ZERO,
            strange_since: None,
            resync: None,
            marks: [u64::MAX; 5],
            meter: Meter::unlimited(),
            outgoing: Vec::new(),
            blocks: 0,
            resent: 0,
        }
    }

    /// Forgets everything and learns anew which block the board expects.
    pub(super) fn begin(&mut self) {
        *self = Self {
            resync: Some((0, HostTime::ZERO)),
            blocks: self.blocks,
            resent: self.resent,
            window: self.window,
            meter: self.meter.clone(),
            ..Self::new()
        };
    }

    /// So many bytes the board keeps; `None`: it does not say.
    pub(super) fn set_window(&mut self, bytes: Option<u32>) {
        let bytes = bytes.map_or(USUAL_WINDOW, |bytes| bytes as usize);
        self.window = bytes.clamp(FIRST_WINDOW, 1 << 16);
    }

    /// In no second the board is given more messages; none: as many as the wire takes.
    pub(super) fn set_most_messages(&mut self, a_second: Option<u32>) {
        self.meter.set_most(a_second);
    }

    /// Motion waits for the wire, for answers, or for its share of the messages.
    pub(super) fn is_congested(&self) -> bool {
        self.waiting.iter().any(|message| message.motion)
    }

    /// Time until all messages that wait, and so many more, have gone.
    pub(super) fn time_for(&self, more: f64) -> Duration {
        let bytes = self.backlog() as f64 + more * USUAL_MESSAGE;
        let windows = bytes / self.window.saturating_sub(KEPT_BYTES).max(1) as f64;
        let trip = self.round_trip.unwrap_or_default().min(SLOWEST_TRIP);
        let by_window = trip.mul_f64(windows);
        let by_count = self.meter.time_for(self.waiting.len() as f64 + more);
        by_count.max(by_window)
    }

    /// The host was away for so long: what came meanwhile is heard only now.
    pub(super) fn was_away(&mut self, gap: Duration) {
        for sent in &mut self.under_way {
            sent.first += gap;
        }
    }

    /// Motion waits because the board is not to be given more messages now.
    pub(super) fn is_rationed(&self) -> bool {
        self.is_congested() && self.meter.is_short()
    }

    /// How long the last block that was confirmed was under way, there and back, when
    /// that is longer than a line takes whose blocks wait for one another. One that was
    /// lost counts from its first sending: what goes now may be lost as well.
    pub(super) fn last_slow_trip(&self) -> Option<Duration> {
        (self.last_trip > USUAL_TRIP).then_some(self.last_trip.min(SLOWEST_TRIP))
    }

    /// How much longer than usual a message took of late.
    pub(super) fn slowness(&self) -> Duration {
        let trip = self.round_trip.unwrap_or_default();
        trip.min(SLOWEST_TRIP).saturating_sub(USUAL_TRIP)
    }

    /// How much longer than usual it may take now.
    pub(super) fn slowness_now(&self, now: HostTime) -> Duration {
        let oldest = self.under_way.front();
        let waits = oldest.map_or(Duration::ZERO, |sent| now.saturating_sub(sent.first));
        if waits < LONG_TRIP {
            return self.slowness();
        }
        // What goes now may be all that goes before the line answers again.
        let waits = waits.clamp(SUSPECTED_TRIP, SLOWEST_TRIP);
        waits.saturating_sub(USUAL_TRIP).max(self.slowness())
    }

    /// When the board last confirmed something.
    pub(super) const fn progressed(&self) -> HostTime {
        self.progressed
    }

    pub(super) const fn is_synced(&self) -> bool {
        self.resync.is_none()
    }

    pub(super) const fn tries(&self) -> u32 {
        match self.resync {
            Some((tries, _)) => tries,
            None => 0,
        }
    }

    /// Nothing waits and nothing is unconfirmed.
    pub(super) fn is_empty(&self) -> bool {
        self.urgent.is_empty() && self.waiting.is_empty() && self.under_way.is_empty()
    }

    /// Bytes that wait or are unconfirmed.
    pub(super) fn backlog(&self) -> usize {
        self.waiting.iter().map(|message| message.bytes.len()).sum()
    }

    pub(super) fn say(&mut self, message: Message) {
        self.waiting.push_back(message);
    }

    /// Before everything that waits.
    pub(super) fn say_first(&mut self, message: Message) {
        self.urgent.push_back(message);
    }

    /// Drops all motion the board has not got. Blocks that may have arrived keep
    /// their number: either the old one was taken, or the new one will be.
    pub(super) fn drop_motion(&mut self) {
        self.waiting.retain(|message| !message.motion);
        for sent in &mut self.under_way {
            sent.messages.retain(|message| !message.motion);
        }
    }

    /// Whether a reply that came with `expects` answers the newest question.
    pub(super) fn answers(&self, mark: Mark, expects: u64) -> bool {
        self.marks[mark as usize] < expects
    }

    /// A block came.
    pub(super) fn hear(&mut self, sequence: u8, is_empty: bool, now: HostTime) -> Option<Heard> {
        if self.resync.is_some() {
            if !is_empty {
                return None;
            }
            self.next = 16 + u64::from(sequence);
            self.expected = self.next;
            self.last_empty = Some(self.next);
            self.progressed = now;
            self.resync = None;
            return None;
        }
        let ahead = u64::from(sequence.wrapping_sub((self.expected & 0x0F) as u8) & 0x0F);
        let expects = self.expected + ahead;
        if expects > self.next {
            self.strange_since.get_or_insert(now);
            return Some(Heard::Strange);
        }
        self.strange_since = None;
        if ahead > 0 {
            self.confirm(ahead, now);
            self.expected = expects;
        }
        if is_empty {
            let complains = self.last_empty == Some(expects)
                && !self.under_way.is_empty()
                && expects >= self.deaf_below;
            if complains {
                self.again = true;
                self.deaf_below = self.next;
            }
            self.last_empty = Some(expects);
        }
        Some(Heard::Expects(expects))
    }

    fn confirm(&mut self, count: u64, now: HostTime) {
        for _ in 0..count {
            if let Some(sent) = self.under_way.pop_front() {
                // From its first sending: a line that has become slow shows at once,
                // and a lost block does not make much of a difference.
                let trip = now.saturating_sub(sent.first);
                let smooth = self.round_trip.map_or(trip, |old| (old * 7 + trip) / 8);
                self.round_trip = Some(smooth);
                self.last_trip = trip;
            }
        }
        self.progressed = now;
        let trip = self.round_trip.unwrap_or_default();
        self.wait = (trip * 4).clamp(LEAST_WAIT, MOST_WAIT);
    }

    /// Puts on the wire what may go.
    pub(super) fn send(&mut self, now: HostTime, times: Option<Times>) -> Result<(), Trouble> {
        self.meter.pass(now);
        if let Some((tries, last)) = self.resync {
            if tries == 0 || now.saturating_sub(last) >= RESYNC_EVERY {
                self.outgoing.extend(block::block(0, &[]));
                self.resync = Some((tries + 1, now));
            }
            return Ok(());
        }
        if self
            .strange_since
            .is_some_and(|since| now.saturating_sub(since) >= STRANGE)
        {
            return Err(Trouble::Restarted);
        }
        if !self.under_way.is_empty() && now.saturating_sub(self.progressed) >= SILENCE {
            return Err(Trouble::Silent);
        }
        let overdue = self
            .under_way
            .front()
            .is_some_and(|sent| now.saturating_sub(sent.at) >= self.wait);
        if (overdue || self.again) && self.outgoing.is_empty() {
            self.send_again(now, times, overdue)?;
        }
        self.send_new(now, times)
    }

    /// Blocks that are in doubt go once more, unless a step in them would come late:
    /// they may have arrived, and their confirmation be on its way. Only when the step
    /// should have been made there is nothing left to wait for.
    fn send_again(
        &mut self,
        now: HostTime,
        times: Option<Times>,
        overdue: bool,
    ) -> Result<(), Trouble> {
        if let Some(times) = times {
            for sent in &mut self.under_way {
                sent.messages
                    .retain(|message| message.vital || !message.is_late(times.again));
            }
            let due_in = |sent: &Sent| {
                let vital = sent.messages.iter().filter(|message| message.vital);
                vital.filter_map(|message| message.due).min()
            };
            // Longer than that no confirmation takes.
            let patience = 2 * self.round_trip.unwrap_or_default() + USUAL_TRIP;
            let missed = |sent: &Sent| {
                due_in(sent).is_some_and(|due| due < times.now)
                    && now.saturating_sub(sent.first) >= patience
            };
            if self.under_way.iter().any(missed) {
                return Err(Trouble::Late);
            }
            let due = self.under_way.iter().filter_map(due_in).min();
            if due.is_some_and(|due| due < times.again) {
                return Ok(());
            }
        }
        self.again = false;
        if overdue {
            self.wait = (self.wait * 2).min(MOST_WAIT);
        }
        // Blocks that come twice are answered as if something were missing.
        self.deaf_below = self.next;
        let first = self.next - self.under_way.len() as u64;
        for (number, sent) in (first..).zip(&mut self.under_way) {
            let content: Vec<u8> = sent
                .messages
                .iter()
                .flat_map(|message| message.bytes.clone())
                .collect();
            self.outgoing.extend(block::block(number, &content));
            sent.at = now;
            self.resent += 1;
        }
        Ok(())
    }

    fn send_new(&mut self, now: HostTime, times: Option<Times>) -> Result<(), Trouble> {
        loop {
            let under_way: usize = self.under_way.iter().map(|sent| sent.bytes).sum();
            let blocks = self.under_way.len() as u64;
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
                let space = self.window.saturating_sub(under_way + kept_bytes);
                let space = space.min(CONTENT + LEAST).saturating_sub(LEAST);
                if blocks + kept_blocks >= MOST_BLOCKS {
                    break;
                }
                while let Some(message) = queue.front() {
                    if let Some(times) = times
                        && message.is_late(times.earliest)
                    {
                        if message.vital {
                            return Err(Trouble::Late);
                        }
                        // What is renewed all the time does no harm when it is missing.
                        queue.pop_front();
                        continue;
                    }
                    let full = content.len() + message.bytes.len() > space;
                    if full || !(urgent || self.meter.allows()) {
                        break;
                    }
                    self.meter.count();
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
                self.marks[mark as usize] = self.next;
            }
            if self.under_way.is_empty() {
                self.progressed = now;
            }
            let bytes = block::block(self.next, &content);
            self.under_way.push_back(Sent {
                messages,
                bytes: bytes.len(),
                first: now,
                at: now,
            });
            self.outgoing.extend(bytes);
            self.next += 1;
            self.blocks += 1;
        }
    }
}

#[cfg(test)]
mod tests;
