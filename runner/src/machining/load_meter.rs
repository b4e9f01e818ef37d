//! The load of the cut of a running control at the moment, for readers outside the machine.

use gsk_workpiece::motion::{MotionKind, ToolMotion};

use super::move_load::CutLoad;

/// Least time between two measurements of a cut that continues, ticks.
const INTERVAL_TICKS: u32 = 20;

/// Measures the load of the current cut while it is switched on. The machine does not depend on it.
#[derive(Clone, Debug, Default)]
pub(super) struct LoadMeter {
    is_on: bool,
    /// The load of the current cut; `None` while nothing is cut.
    load: Option<CutLoad>,
    /// Ticks of motion since the last measurement.
    ticks: u32,
}

impl LoadMeter {
    pub(super) fn switch(&mut self, is_on: bool) {
        if self.is_on != is_on {
            *self = Self {
                is_on,
                ..Self::default()
            };
        }
    }

    /// Returns the load of the current cut; 0 while nothing is cut.
    pub(super) fn load(&self) -> CutLoad {
        self.load.unwrap_or_default()
    }

    /// Stores that nothing is cut.
    pub(super) const fn set_idle(&mut self) {
        self.load = None;
        self.ticks = 0;
    }

    /// Counts a motion of a number of ticks with the spindle turning; returns whether its load is
    /// to be measured. A thread is measured once for each turn.
    pub(super) const fn is_due(&mut self, motion: &ToolMotion, ticks: u32) -> bool {
        if !self.is_on {
            return false;
        }
        self.ticks = self.ticks.saturating_add(ticks);
        match &motion.kind {
            MotionKind::Rapid => false,
            MotionKind::Thread(imprints) => !imprints.is_empty(),
            MotionKind::Line | MotionKind::Arc { .. } => {
                self.load.is_none() || self.ticks >= INTERVAL_TICKS
            }
        }
    }

    pub(super) const fn set(&mut self, load: Option<CutLoad>) {
        self.load = load;
        self.ticks = 0;
    }
}
