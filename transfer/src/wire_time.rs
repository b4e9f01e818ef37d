//! How long bytes take on the line.

use crate::HostTime;

/// Bits of a byte on the wire: start, eight, stop.
const BITS: u64 = 10;
/// How far ahead of the wire bytes are handed to the port: the gaps between two looks of
/// whoever carries them leave no gap on the wire.
pub(crate) const LEAD: HostTime = HostTime::from_millis(20);

/// One direction of a line that is as fast as its rate.
#[derive(Clone, Copy, Debug)]
pub struct WireTime {
    byte: HostTime,
    /// When the last byte that was given will have left.
    free_at: HostTime,
}

impl WireTime {
    /// A line of so many bits a second.
    pub fn new(baud: u32) -> Self {
        let nanos = BITS * 1_000_000_000 / u64::from(baud.max(1));
        Self {
            byte: HostTime::from_nanos(nanos),
            free_at: HostTime::ZERO,
        }
    }

    /// How long so many bytes take.
    pub(crate) fn bytes(&self, count: usize) -> HostTime {
        self.byte * u32::try_from(count).unwrap_or(u32::MAX)
    }

    /// Gives so many bytes; when the last one will have left.
    pub(crate) fn give(&mut self, count: usize, now: HostTime) -> HostTime {
        self.free_at = self.free_at.max(now) + self.bytes(count);
        self.free_at
    }

    /// How many of so many bytes that wait may go to the port now.
    pub(crate) fn due(&self, waiting: usize, now: HostTime) -> usize {
        let ahead = self.free_at.saturating_sub(now + LEAD).as_nanos();
        let kept = ahead.div_ceil(self.byte.as_nanos().max(1));
        waiting.saturating_sub(usize::try_from(kept).unwrap_or(usize::MAX))
    }

    /// How many bytes may be given now so that none is more than the lead ahead.
    pub(crate) fn room(&self, now: HostTime) -> usize {
        let room = (now + LEAD)
            .saturating_sub(self.free_at)
            .min(LEAD)
            .as_nanos();
        // One byte may take longer than the lead.
        let bytes = room.div_ceil(self.byte.as_nanos().max(1));
        usize::try_from(bytes).unwrap_or(usize::MAX)
    }

    /// When all that was given will have left.
    pub(crate) const fn free_at(&self) -> HostTime {
        self.free_at
    }
}
