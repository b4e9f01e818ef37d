//! Limits the number of messages per second: a small processor that reads too many messages
//! makes its steps late.

use super::super::HostTime;

/// Number of messages that may be sent at once after a pause.
const BURST: f64 = 60.0;
/// Number of messages that a second may contain at the board in addition to those sent in a second,
/// because transmission times vary.
const JITTER: f64 = 5.0;

/// Limits the messages per second, with a token bucket.
#[derive(Clone, Debug)]
pub(super) struct RateLimit {
    /// Number of messages per second that may be sent once the burst is used up; `None` without a
    /// limit.
    rate: Option<f64>,
    left: f64,
    at: HostTime,
}

impl RateLimit {
    pub(super) const fn unlimited() -> Self {
        Self {
            rate: None,
            left: BURST,
            at: HostTime::ZERO,
        }
    }

    /// Sets the greatest number of messages that the board may receive in any second; `None` for no
    /// limit.
    pub(super) fn set_rate(&mut self, a_second: Option<u32>) {
        // Messages may arrive closer together than they were sent.
        self.rate = a_second.map(|most| (f64::from(most) - BURST - JITTER).max(BURST));
    }

    pub(super) fn refill(&mut self, now: HostTime) {
        let passed = now.saturating_sub(self.at).as_secs_f64();
        self.at = now;
        if let Some(rate) = self.rate {
            self.left = (self.left + rate * passed).min(BURST);
        }
    }

    /// Whether the limit permits another message now.
    pub(super) fn allows(&self) -> bool {
        self.rate.is_none() || self.left >= 1.0
    }

    /// Returns the time that sending a number of messages takes once the burst is used up; 0
    /// without a limit.
    pub(super) fn time_for(&self, messages: f64) -> HostTime {
        let seconds = self.rate.map_or(0.0, |rate| messages / rate);
        HostTime::try_from_secs_f64(seconds).unwrap_or_default()
    }

    /// Whether less than a quarter of the permitted burst remains.
    pub(super) fn is_short(&self) -> bool {
        self.rate.is_some() && self.left < BURST / 4.0
    }

    /// Counts a sent message. Urgent messages are sent without [`allows`](Self::allows).
    pub(super) fn take(&mut self) {
        if self.rate.is_some() {
            self.left -= 1.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_second_exceeds_the_limit() {
        let mut rate_limit = RateLimit::unlimited();
        rate_limit.set_rate(Some(700));
        let mut sent: Vec<u64> = Vec::new();
        for ms in 0..5000 {
            rate_limit.refill(HostTime::from_millis(ms));
            if ms % 50 == 0 {
                // The heartbeat is urgent: it ignores the limit.
                rate_limit.take();
                sent.push(ms);
            }
            while !(1000..=1500).contains(&ms) && rate_limit.allows() {
                rate_limit.take();
                sent.push(ms);
            }
        }
        let most = (0..5000)
            .map(|from| {
                sent.iter()
                    .filter(|at| (from..from + 1000).contains(*at))
                    .count()
            })
            .max();
        assert!((690..=700).contains(&most.unwrap()), "{most:?}");
    }
}
