//! How many messages a board is given: a small processor that reads too many loses
//! the time for its steps.

use super::super::HostTime;

/// Messages that may go at once; in any second that many more than the rate.
const BURST: f64 = 60.0;
const JITTER: f64 = 5.0;

/// The allowance of messages.
#[derive(Clone, Debug)]
pub(super) struct RateLimit {
    /// Messages a second; none: as many as the wire takes.
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

    /// In no second more than so many.
    pub(super) fn set_rate(&mut self, a_second: Option<u32>) {
        // Some may arrive closer together than they were sent.
        self.rate = a_second.map(|most| (f64::from(most) - BURST - JITTER).max(BURST));
    }

    pub(super) fn refill(&mut self, now: HostTime) {
        let passed = now.saturating_sub(self.at).as_secs_f64();
        self.at = now;
        if let Some(rate) = self.rate {
            self.left = (self.left + rate * passed).min(BURST);
        }
    }

    /// Whether one more message may go.
    pub(super) fn allows(&self) -> bool {
        self.rate.is_none() || self.left >= 1.0
    }

    /// How long so many messages take, once the burst is over.
    pub(super) fn time_for(&self, messages: f64) -> HostTime {
        let seconds = self.rate.map_or(0.0, |rate| messages / rate);
        HostTime::try_from_secs_f64(seconds).unwrap_or_default()
    }

    /// Whether hardly any message may go.
    pub(super) fn is_short(&self) -> bool {
        self.rate.is_some() && self.left < BURST / 4.0
    }

    /// A message went; what is urgent goes without being asked.
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
    fn no_second_has_more_than_the_most() {
        let mut rate_limit = RateLimit::unlimited();
        rate_limit.set_rate(Some(700));
        let mut sent: Vec<u64> = Vec::new();
        for ms in 0..5000 {
            rate_limit.refill(HostTime::from_millis(ms));
            if ms % 50 == 0 {
                // The heartbeat asks nobody.
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
