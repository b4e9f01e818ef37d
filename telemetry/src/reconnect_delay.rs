//! The time between two attempts to connect.

/// Time after the first failed attempt, ms.
const FIRST_DELAY_MS: u64 = 250;
/// Greatest time between two attempts, ms: with the time of an attempt, a broker that returns is
/// found within five seconds.
const MAX_DELAY_MS: u64 = 2000;

/// The time between two attempts to connect; it doubles with each failure.
#[derive(Clone, Copy, Debug)]
pub struct ReconnectDelay {
    next_ms: u64,
}

impl Default for ReconnectDelay {
    fn default() -> Self {
        Self {
            next_ms: FIRST_DELAY_MS,
        }
    }
}

impl ReconnectDelay {
    /// Returns the time until the next attempt, ms, and lengthens the one after it.
    pub fn take_ms(&mut self) -> u64 {
        let delay = self.next_ms;
        self.next_ms = (delay * 2).min(MAX_DELAY_MS);
        delay
    }

    /// Begins again with the shortest time, after a connection.
    pub fn reset(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn delays_double_up_to_two_seconds() {
        let mut delay = ReconnectDelay::default();
        let taken: Vec<u64> = (0..6).map(|_| delay.take_ms()).collect();
        assert_eq!(taken, [250, 500, 1000, 2000, 2000, 2000]);
        delay.reset();
        assert_eq!(delay.take_ms(), 250);
    }
}
