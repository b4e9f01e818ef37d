//! Sequence numbers of blocks: that of the next block to send, and that of the block that the board
//! expects next.

use core::time::Duration;

use crate::HostTime;

/// Interval of queries for the sequence number that the board expects.
const RESYNC_EVERY: Duration = Duration::from_millis(100);
/// Time during which a board sends only impossible sequence numbers, after which it counts as
/// restarted.
const UNEXPECTED: Duration = Duration::from_millis(100);

/// The sequence numbers of the blocks sent to a board. Only their low four bits are on the wire.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sequence {
    /// Sequence number of the next block to send.
    next: u64,
    /// Sequence number of the next block that the board expects.
    expected: u64,
    /// The number in the last empty block of the board; `None` before the first one.
    last_empty: Option<u64>,
    /// Sequence number below which NAKs are ignored: their blocks were retransmitted already.
    ignored_below: u64,
    /// Host time since which the board has sent only impossible numbers; `None` if its last number
    /// is possible.
    unexpected_since: Option<HostTime>,
    /// Number of queries for the expected number, and host time of the last one; `None` if the
    /// expected number is known.
    resync: Option<(u32, HostTime)>,
}

impl Sequence {
    /// Creates the sequence of a board that must be queried for the number that it expects.
    pub(super) fn unknown() -> Self {
        Self {
            resync: Some((0, HostTime::ZERO)),
            ..Self::default()
        }
    }

    /// Whether the sequence number that the board expects is known.
    pub(super) const fn is_synced(&self) -> bool {
        self.resync.is_none()
    }

    /// Returns how many queries for the expected block number have been due since it became
    /// unknown; 0 if it is known.
    pub(super) const fn tries(&self) -> u32 {
        match self.resync {
            Some((tries, _)) => tries,
            None => 0,
        }
    }

    /// Whether a query for the expected number is due; counts a due query as sent.
    pub(super) fn is_resync_due(&mut self, now: HostTime) -> bool {
        let tries = self.tries();
        let due = self
            .resync
            .is_some_and(|(_, last)| tries == 0 || now.saturating_sub(last) >= RESYNC_EVERY);
        if due {
            self.resync = Some((tries + 1, now));
        }
        due
    }

    /// Takes the low four bits of the number that the board expects, from its answer.
    pub(super) fn sync(&mut self, sequence: u8) {
        self.next = 16 + u64::from(sequence);
        self.expected = self.next;
        self.last_empty = Some(self.next);
        self.resync = None;
    }

    /// Returns the sequence number of the next block to send.
    pub(super) const fn next(&self) -> u64 {
        self.next
    }

    /// Returns the sequence number of the next block and counts it as sent.
    pub(super) const fn take(&mut self) -> u64 {
        let next = self.next;
        self.next += 1;
        next
    }

    /// Takes the number in a block of the board. Returns the number that the board expects
    /// and the count of newly confirmed blocks; `None` if the number is impossible.
    pub(super) fn received(&mut self, sequence: u8, now: HostTime) -> Option<(u64, u64)> {
        let ahead = u64::from(sequence.wrapping_sub((self.expected & 0x0F) as u8) & 0x0F);
        let expects = self.expected + ahead;
        if expects > self.next {
            self.unexpected_since.get_or_insert(now);
            return None;
        }
        self.unexpected_since = None;
        self.expected = expects;
        Some((expects, ahead))
    }

    /// Whether an empty block of the board with the number `expects` is a NAK for a block that was
    /// not retransmitted yet; stores the number. `under_way`: blocks are unconfirmed.
    pub(super) fn is_nak(&mut self, expects: u64, under_way: bool) -> bool {
        let complains =
            self.last_empty == Some(expects) && under_way && expects >= self.ignored_below;
        if complains {
            self.ignore_naks();
        }
        self.last_empty = Some(expects);
        complains
    }

    /// Ignores NAKs for all blocks sent so far. The board answers duplicates like missing
    /// blocks.
    pub(super) const fn ignore_naks(&mut self) {
        self.ignored_below = self.next;
    }

    /// Whether the board has restarted its sequence, which shows that it was reset.
    pub(super) fn is_reset(&self, now: HostTime) -> bool {
        self.unexpected_since
            .is_some_and(|since| now.saturating_sub(since) >= UNEXPECTED)
    }
}
