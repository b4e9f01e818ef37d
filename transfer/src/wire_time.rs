//! Transmission times of bytes on a serial line.

use crate::PortTime;

/// Bits per byte: start bit, 8 data bits, stop bit.
const BITS_PER_BYTE: u64 = 10;
/// Time by which the port gets bytes before the line needs them. The line stays busy while the
/// caller is between two calls.
pub(crate) const PORT_LOOKAHEAD: PortTime = PortTime::from_millis(20);

/// Timing of one direction of a serial line.
#[derive(Clone, Copy, Debug)]
pub struct WireTime {
    byte_time: PortTime,
    /// Time at which the last queued byte has left the line.
    idle_at: PortTime,
}

impl WireTime {
    /// Creates the timing for a line of `baud` bits per second.
    pub fn new(baud: u32) -> Self {
        let nanos = BITS_PER_BYTE * 1_000_000_000 / u64::from(baud.max(1));
        Self {
            byte_time: PortTime::from_nanos(nanos),
            idle_at: PortTime::ZERO,
        }
    }

    /// Returns the transmission time of `count` bytes.
    pub(crate) fn transmission_time(&self, count: usize) -> PortTime {
        self.byte_time * u32::try_from(count).unwrap_or(u32::MAX)
    }

    /// Adds `count` bytes to the line and returns the time at which the last one has left.
    pub(crate) fn queue(&mut self, count: usize, now: PortTime) -> PortTime {
        self.idle_at = self.idle_at.max(now) + self.transmission_time(count);
        self.idle_at
    }

    /// Returns how many of `waiting` queued bytes the port may take now.
    pub(crate) fn sendable(&self, waiting: usize, now: PortTime) -> usize {
        let ahead = self.idle_at.saturating_sub(now + PORT_LOOKAHEAD).as_nanos();
        let kept = ahead.div_ceil(self.byte_time.as_nanos().max(1));
        waiting.saturating_sub(usize::try_from(kept).unwrap_or(usize::MAX))
    }

    /// Returns how many bytes may be queued now without exceeding [`PORT_LOOKAHEAD`].
    pub(crate) fn free_bytes(&self, now: PortTime) -> usize {
        let free = (now + PORT_LOOKAHEAD)
            .saturating_sub(self.idle_at)
            .min(PORT_LOOKAHEAD)
            .as_nanos();
        // One byte may take longer than the lookahead.
        let bytes = free.div_ceil(self.byte_time.as_nanos().max(1));
        usize::try_from(bytes).unwrap_or(usize::MAX)
    }

    /// Returns the time at which all queued bytes have left the line.
    pub(crate) const fn idle_at(&self) -> PortTime {
        self.idle_at
    }
}
