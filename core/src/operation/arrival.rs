//! Waiting for the spindle speed arrival signal SAR (manual PLC-I 9.4): its stages.

use serde::{Deserialize, Serialize};

/// How far the check has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Arrival {
    /// The next cut looks at SAR.
    #[default]
    Due,
    /// A cut has been read; so many ms from now SAR is looked at.
    Awaited(u32),
    /// Cuts follow cuts at the same speed.
    Seen,
}

impl Arrival {
    /// Whether a cut still waits.
    pub(crate) const fn awaited(self, arrived: bool) -> bool {
        match self {
            Self::Awaited(0) => !arrived,
            Self::Awaited(_) => true,
            Self::Due | Self::Seen => false,
        }
    }

    /// One millisecond.
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
        let mut arrival = Arrival::Awaited(2);
        for _ in 0..2 {
            assert!(arrival.awaited(true), "too early to look");
            arrival.tick(true);
        }
        assert!(arrival.awaited(false));
        arrival.tick(false);
        assert_eq!(arrival, Arrival::Awaited(0), "it waits as long as it takes");
        assert!(!arrival.awaited(true));
        arrival.tick(true);
        assert_eq!(arrival, Arrival::Seen);
        assert!(
            !arrival.awaited(false),
            "later changes are nothing to a cut"
        );
    }
}
