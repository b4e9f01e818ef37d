//! Sequence numbers of the blocks: which one goes next, and which one the board expects.

use core::time::Duration;

use crate::HostTime;

/// Between two tries to learn the next number, and how many.
const RESYNC_EVERY: Duration = Duration::from_millis(100);
/// A number that cannot be the next, said for so long: the board counts anew.
const UNEXPECTED: Duration = Duration::from_millis(100);

/// Blocks are numbered; on the wire go the low four bits.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sequence {
    /// Of the next block to send, and of the next one the board expects.
    next: u64,
    expected: u64,
    /// What the last empty block of the board said that it expects.
    last_empty: Option<u64>,
    /// Complaints below this are about blocks that were sent again already.
    ignored_below: u64,
    /// Since when the board has said numbers that cannot be.
    unexpected_since: Option<HostTime>,
    /// Tries to learn the number the board expects; none: it is known.
    resync: Option<(u32, HostTime)>,
}

impl Sequence {
    /// The board is to be asked which number it expects.
    pub(super) fn unknown() -> Self {
        Self {
            resync: Some((0, HostTime::ZERO)),
            ..Self::default()
        }
    }

    /// Whether it is known which number the board expects.
    pub(super) const fn is_synced(&self) -> bool {
        self.resync.is_none()
    }

    /// How often it was asked.
    pub(super) const fn tries(&self) -> u32 {
        match self.resync {
            Some((tries, _)) => tries,
            None => 0,
        }
    }

    /// Whether it is to be asked now.
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

    /// The board has said which it expects.
    pub(super) fn sync(&mut self, sequence: u8) {
        self.next = 16 + u64::from(sequence);
        self.expected = self.next;
        self.last_empty = Some(self.next);
        self.resync = None;
    }

    /// Number of the next block.
    pub(super) const fn next(&self) -> u64 {
        self.next
    }

    /// The same, for a block that is sent now.
    pub(super) const fn take(&mut self) -> u64 {
        let next = self.next;
        self.next += 1;
        next
    }

    /// The number that the board expects next, and how many blocks have arrived since it
    /// last said one; none: that cannot be.
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

    /// Whether an empty block of the board says that a block came damaged, which was not
    /// sent again already.
    pub(super) fn is_nak(&mut self, expects: u64, under_way: bool) -> bool {
        let complains =
            self.last_empty == Some(expects) && under_way && expects >= self.ignored_below;
        if complains {
            self.ignore_naks();
        }
        self.last_empty = Some(expects);
        complains
    }

    /// All blocks so far are sent again: blocks that come twice are answered as if
    /// something were missing.
    pub(super) const fn ignore_naks(&mut self) {
        self.ignored_below = self.next;
    }

    /// Whether the board counts its blocks anew: it was reset.
    pub(super) fn is_reset(&self, now: HostTime) -> bool {
        self.unexpected_since
            .is_some_and(|since| now.saturating_sub(since) >= UNEXPECTED)
    }
}
