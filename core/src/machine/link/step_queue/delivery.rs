//! Messages reach the board once and in order, or the link is lost.
//!
//! Every block of the board carries the number of the block it expects next. An
//! empty block that says the same number again complains about a block that came
//! damaged.

use core::time::Duration;
use std::collections::VecDeque;

use super::super::HostTime;
use super::block::{self, CONTENT, LEAST};

/// Unanswered bytes before the board has said how many it can keep, and when it
/// does not say.
const FIRST_WINDOW: usize = 64;
const USUAL_WINDOW: usize = 1024;
/// Blocks under way at once.
const MOST_BLOCKS: u64 = 12;
/// Sent again after this or four round trips; doubled to the most.
const LEAST_WAIT: Duration = Duration::from_millis(25);
const MOST_WAIT: Duration = Duration::from_secs(1);
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
}

/// Replies that must belong to the newest question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mark {
    Uptime,
    Position,
    Group,
    Config,
}

/// What a block of the board tells of the blocks sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Heard {
    /// So many blocks have arrived.
    Expects(u64),
    /// A number that cannot be.
    Strange,
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
    at: HostTime,
    again: bool,
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
    wait: Duration,
    progressed: HostTime,
    strange_since: Option<HostTime>,
    /// Tries to learn the number the board expects; none: it is known.
    resync: Option<(u32, HostTime)>,
    marks: [u64; 4],
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
            wait: LEAST_WAIT,
            progressed: HostTime::ZERO,
            strange_since: None,
            resync: None,
            marks: [u64::MAX; 4],
            outgoing: Vec::new(),
            blocks: 0,
            resent: 0,
        }
    }

    /// Forgets everything and learns anew which block the board expects.
    pub(super) fn begin(&mut self) {
        let (blocks, resent, window) = (self.blocks, self.resent, self.window);
        *self = Self {
            resync: Some((0, HostTime::ZERO)),
            blocks,
            resent,
            window,
            ..Self::new()
        };
    }

    /// So many bytes the board keeps; `None`: it does not say.
    pub(super) fn set_window(&mut self, bytes: Option<u32>) {
        let bytes = bytes.map_or(USUAL_WINDOW, |bytes| bytes as usize);
        self.window = bytes.clamp(FIRST_WINDOW, 1 << 16);
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

    /// Messages that would come too late are not sent any more, except vital ones.
    pub(super) fn drop_late(&mut self, earliest: u64) {
        let in_time =
            |message: &Message| message.vital || message.due.is_none_or(|due| due >= earliest);
        self.waiting.retain(in_time);
        self.urgent.retain(in_time);
        for sent in &mut self.under_way {
            sent.messages.retain(in_time);
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
            if let Some(sent) = self.under_way.pop_front()
                && !sent.again
            {
                let trip = now.saturating_sub(sent.at);
                let smooth = self.round_trip.map_or(trip, |old| (old * 7 + trip) / 8);
                self.round_trip = Some(smooth);
            }
        }
        self.progressed = now;
        let trip = self.round_trip.unwrap_or_default();
        self.wait = (trip * 4).clamp(LEAST_WAIT, MOST_WAIT);
    }

    /// Puts on the wire what may go; `earliest` is the board clock before which
    /// nothing timed can arrive any more.
    pub(super) fn send(&mut self, now: HostTime, earliest: Option<u64>) -> Result<(), Trouble> {
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
        if overdue {
            self.wait = (self.wait * 2).min(MOST_WAIT);
        }
        if (overdue || self.again) && self.outgoing.is_empty() {
            self.again = false;
            self.send_again(now, earliest)?;
        }
        self.send_new(now, earliest)
    }

    fn send_again(&mut self, now: HostTime, earliest: Option<u64>) -> Result<(), Trouble> {
        let late = |message: &Message| message.due.zip(earliest).is_some_and(|(due, at)| due < at);
        if self
            .under_way
            .iter()
            .any(|sent| sent.messages.iter().any(late))
        {
            self.again = true;
            return Err(Trouble::Late);
        }
        let first = self.next - self.under_way.len() as u64;
        for (number, sent) in (first..).zip(&mut self.under_way) {
            let content: Vec<u8> = sent
                .messages
                .iter()
                .flat_map(|message| message.bytes.clone())
                .collect();
            self.outgoing.extend(block::block(number, &content));
            sent.at = now;
            sent.again = true;
            self.resent += 1;
        }
        Ok(())
    }

    fn send_new(&mut self, now: HostTime, earliest: Option<u64>) -> Result<(), Trouble> {
        loop {
            let under_way: usize = self.under_way.iter().map(|sent| sent.bytes).sum();
            let space = self.window.saturating_sub(under_way).min(CONTENT + LEAST);
            if self.under_way.len() as u64 >= MOST_BLOCKS || space <= LEAST {
                return Ok(());
            }
            let mut messages = Vec::new();
            let mut content = Vec::new();
            for queue in [&mut self.urgent, &mut self.waiting] {
                while let Some(message) = queue.front() {
                    if message.due.zip(earliest).is_some_and(|(due, at)| due < at) {
                        return Err(Trouble::Late);
                    }
                    if content.len() + message.bytes.len() > space - LEAST {
                        break;
                    }
                    content.extend_from_slice(&message.bytes);
                    messages.extend(queue.pop_front());
                }
                if !queue.is_empty() {
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
                at: now,
                again: false,
            });
            self.outgoing.extend(bytes);
            self.next += 1;
            self.blocks += 1;
        }
    }
}

#[cfg(test)]
mod tests;
