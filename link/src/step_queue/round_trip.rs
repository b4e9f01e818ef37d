//! Measures the round trip of blocks and derives the retransmission timeout.

use core::time::Duration;

/// Least time without confirmation before a retransmission; normally it is four smoothed round
/// trips.
const LEAST_WAIT: Duration = Duration::from_millis(25);
/// Greatest time without confirmation before a retransmission; each retransmission doubles it up to
/// this.
const MOST_WAIT: Duration = Duration::from_secs(1);
/// Greatest round trip at which a serial line does not count as slow.
pub(super) const USUAL_TRIP: Duration = Duration::from_millis(25);
/// Greatest round trip for which the link leaves time; a longer one counts as this.
pub(super) const SLOWEST_TRIP: Duration = Duration::from_millis(200);

/// Measured round trips of blocks, and the retransmission timeout derived from them.
#[derive(Clone, Copy, Debug)]
pub(super) struct RoundTrip {
    /// Smoothed round trip of a block; `None` before the first confirmed block.
    smooth: Option<Duration>,
    last: Duration,
    /// The retransmission timeout: a block is sent again if it is not confirmed within this time.
    wait: Duration,
}

impl Default for RoundTrip {
    fn default() -> Self {
        Self {
            smooth: None,
            last: Duration::ZERO,
            wait: LEAST_WAIT,
        }
    }
}

impl RoundTrip {
    /// Adds the round trip of a confirmed block to the average.
    pub(super) fn add(&mut self, trip: Duration) {
        self.smooth = Some(self.smooth.map_or(trip, |old| (old * 7 + trip) / 8));
        self.last = trip;
    }

    /// Returns the smoothed round trip of a block; 0 if unknown.
    pub(super) fn usual(&self) -> Duration {
        self.smooth.unwrap_or_default()
    }

    /// Returns the current retransmission timeout.
    pub(super) const fn wait(&self) -> Duration {
        self.wait
    }

    /// Resets the retransmission timeout after a confirmed block.
    pub(super) fn reset_wait(&mut self) {
        self.wait = (self.usual() * 4).clamp(LEAST_WAIT, MOST_WAIT);
    }

    /// Doubles the retransmission timeout after a retransmission.
    pub(super) fn wait_longer(&mut self) {
        self.wait = (self.wait * 2).min(MOST_WAIT);
    }

    /// Returns the round trip of the last confirmed block if it was slow, limited to
    /// [`SLOWEST_TRIP`]; otherwise `None`. For a retransmitted block it counts from the first
    /// transmission: the next block may be lost, too.
    pub(super) fn last_slow(&self) -> Option<Duration> {
        (self.last > USUAL_TRIP).then_some(self.last.min(SLOWEST_TRIP))
    }

    /// Returns the time by which the smoothed round trip exceeds [`USUAL_TRIP`]; 0 on a fast line.
    pub(super) fn slowness(&self) -> Duration {
        self.usual().min(SLOWEST_TRIP).saturating_sub(USUAL_TRIP)
    }
}
