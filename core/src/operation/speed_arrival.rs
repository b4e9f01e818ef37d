//! Stages of the wait for the speed arrival signal SAR of the spindle (manual PLC-I 9.4).

use serde::{Deserialize, Serialize};

/// Stage of the check of the spindle speed (SAR) before a cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum SpeedArrival {
    /// The next cut must wait for the signal SAR (speed arrival).
    #[default]
    Due,
    /// A cut has been read; SAR is checked after this many ms.
    Awaited(u32),
    /// SAR has come. Further cuts begin without a check until the next rapid or S function.
    Seen,
}

impl SpeedArrival {
    /// Whether the cut still waits for the speed; `has_arrived` is the signal SAR.
    pub(crate) const fn is_waiting(self, has_arrived: bool) -> bool {
        match self {
            Self::Awaited(0) => !has_arrived,
            Self::Awaited(_) => true,
            Self::Due | Self::Seen => false,
        }
    }

    /// Advances by one tick (1 ms) with the signal SAR.
    pub(crate) const fn tick(&mut self, arrived: bool) {
        *self = match *self {
            Self::Awaited(0) if arrived => Self::Seen,
            Self::Awaited(left) => Self::Awaited(left.saturating_sub(1)),
            same => same,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sar_counts_after_its_delay() {
        let mut arrival = SpeedArrival::Awaited(2);
        for _ in 0..2 {
            assert!(arrival.is_waiting(true), "too early to look");
            arrival.tick(true);
        }
        assert!(arrival.is_waiting(false));
        arrival.tick(false);
        assert_eq!(
            arrival,
            SpeedArrival::Awaited(0),
            "it waits as long as it takes"
        );
        assert!(!arrival.is_waiting(true));
        arrival.tick(true);
        assert_eq!(arrival, SpeedArrival::Seen);
        assert!(
            !arrival.is_waiting(false),
            "later changes are nothing to a cut"
        );
    }
}
