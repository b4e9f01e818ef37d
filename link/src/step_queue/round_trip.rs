//! How long a block takes to the board and its answer back, and when it is sent again.

use core::time::Duration;

/// Sent again after this or four round trips; doubled to the most.
const LEAST_WAIT: Duration = Duration::from_millis(25);
const MOST_WAIT: Duration = Duration::from_secs(1);
/// A line that takes longer than this to answer is slow; it is not waited for longer
/// than that.
pub(super) const USUAL_TRIP: Duration = Duration::from_millis(25);
pub(super) const SLOWEST_TRIP: Duration = Duration::from_millis(200);

/// Round trips of late.
#[derive(Clone, Copy, Debug)]
pub(super) struct RoundTrip {
    /// The usual one, smoothed.
    smooth: Option<Duration>,
    last: Duration,
    /// An answer is waited for so long.
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
    /// A block was confirmed after so long.
    pub(super) fn add(&mut self, trip: Duration) {
        self.smooth = Some(self.smooth.map_or(trip, |old| (old * 7 + trip) / 8));
        self.last = trip;
    }

    /// The usual round trip; zero: not known yet.
    pub(super) fn usual(&self) -> Duration {
        self.smooth.unwrap_or_default()
    }

    /// How long an answer is waited for before a block is sent again.
    pub(super) const fn wait(&self) -> Duration {
        self.wait
    }

    /// A block was confirmed: the next is waited for as usual.
    pub(super) fn reset_wait(&mut self) {
        self.wait = (self.usual() * 4).clamp(LEAST_WAIT, MOST_WAIT);
    }

    /// Nothing was confirmed in time.
    pub(super) fn wait_longer(&mut self) {
        self.wait = (self.wait * 2).min(MOST_WAIT);
    }

    /// How long the last block that was confirmed was under way, there and back, when
    /// that is longer than a line takes whose blocks wait for one another. One that was
    /// lost counts from its first sending: what goes now may be lost as well.
    pub(super) fn last_slow(&self) -> Option<Duration> {
        (self.last > USUAL_TRIP).then_some(self.last.min(SLOWEST_TRIP))
    }

    /// How much longer than usual a message took of late.
    pub(super) fn slowness(&self) -> Duration {
        self.usual().min(SLOWEST_TRIP).saturating_sub(USUAL_TRIP)
    }
}
