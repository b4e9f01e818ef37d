//! Spindle speed arrival (manual PLC-I 9.4): with 175.6 = 1 the first cut after a
//! rapid or an S function begins only when the ladder's SAR (G29.4) stands. What
//! SAR says is looked at 072 ms after the cut was read, so that the ladder has seen
//! the new speed.
//!
//! ```text
//!  S, rapid ──► cut read ──── 072 ────► SAR = 0: waits ... SAR = 1: the cut begins
//! ```

use serde::{Deserialize, Serialize};

use crate::cnc::Cnc;
use crate::command::Action;

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
    pub(super) const fn tick(&mut self, arrived: bool) {
        *self = match *self {
            Self::Awaited(0) if arrived => Self::Seen,
            Self::Awaited(left) => Self::Awaited(left.saturating_sub(1)),
            same => same,
        };
    }
}

impl Cnc {
    /// A command begins: whether it asks for the check, or has to wait for it.
    pub(super) fn await_speed(&mut self, action: &Action) {
        let arrival = &mut self.automatic.arrival;
        match action {
            Action::Rapid { .. } | Action::Spindle(_) => *arrival = Arrival::Due,
            Action::Line { .. }
            | Action::Arc { .. }
            | Action::Thread { .. }
            | Action::Tap { .. }
                if *arrival == Arrival::Due =>
            {
                let checked = self.parameters.awaits_speed() && !self.from_plc.dry_run;
                *arrival = if checked {
                    Arrival::Awaited(self.parameters.value(72).unsigned_abs())
                } else {
                    Arrival::Seen
                };
            }
            _ => {}
        }
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
