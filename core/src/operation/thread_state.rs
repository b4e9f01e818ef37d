//! What a run keeps of the thread or tap under way.

use serde::{Deserialize, Serialize};

use crate::board::SpindleTrouble;

/// The spindle speed of a thread is compared over so many ticks (106).
const FLUCTUATION_TICKS: u32 = 100;

/// Whether feed hold may stop the motion under way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Protection {
    /// It may.
    #[default]
    None,
    /// A thread or tap, and what follows it until the next command begins.
    Thread,
    /// Hold was asked for in a thread: the first thing after it goes to its end.
    After {
        /// Hold asked for again stops in it; not so the retract of a cycle.
        again: bool,
    },
}

/// How far a tap has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum TapStage {
    /// The spindle turns again for a further start of the thread.
    Restart,
    /// Other functions of the block are finished first, and a spindle that was
    /// started again has come to its speed.
    Ready,
    /// Inwards in phase.
    In,
    /// M05; the tool follows the spindle to its standstill.
    Stopping,
    /// Out in phase with the reversed spindle.
    Out,
    /// M05 again.
    Ending,
    /// Done.
    Done,
}

/// What is watched while a thread is cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct SpindleWatch {
    /// Speed at the last comparison, and ticks since.
    pub rpm: Option<f64>,
    pub ticks: u32,
    /// The spindle has turned in a cut of this run.
    pub turned: bool,
    /// Ticks that a command has waited for the spindle.
    pub waited: u32,
    /// The thread under way is not what it should be: the run ends behind it.
    pub spoilt: Option<SpindleTrouble>,
}

impl SpindleWatch {
    /// Whether the speed has kept within a half per cent for a while.
    pub fn steady(&mut self, rpm: f64) -> bool {
        let before = *self.rpm.get_or_insert(rpm);
        self.ticks += 1;
        if self.ticks < FLUCTUATION_TICKS {
            return false;
        }
        self.ticks = 0;
        self.rpm = Some(rpm);
        (rpm - before).abs() * 200.0 <= rpm + before
    }

    /// `|n - n0| · 200 / (n + n0)` against the limit, %.
    pub(crate) fn fluctuates(&mut self, rpm: f64, limit: f64) -> bool {
        let before = *self.rpm.get_or_insert(rpm);
        self.ticks += 1;
        if limit <= 0.0 || self.ticks < FLUCTUATION_TICKS {
            return false;
        }
        self.ticks = 0;
        self.rpm = Some(rpm);
        (rpm - before).abs() * 200.0 > limit * (rpm + before)
    }
}
