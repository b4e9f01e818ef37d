//! State of the thread or tap that a run has under way.

use serde::{Deserialize, Serialize};

use crate::board::SpindleFault;

/// Interval between two comparisons of the spindle speed during a thread, ticks (106).
const FLUCTUATION_TICKS: u32 = 100;

/// Whether feed hold can stop the motion under way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum HoldProtection {
    /// Feed hold stops the motion.
    #[default]
    None,
    /// A thread or tap is under way, or its end until the next command begins: feed hold
    /// waits.
    Thread,
    /// Feed hold was requested in a thread. The first command after the thread runs to its
    /// end.
    After {
        /// Whether a second feed hold stops that command. Not so for the retract of a
        /// cycle.
        again: bool,
    },
}

/// Stage of a tap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum TapStage {
    /// The spindle starts again for a further start of the thread.
    Restart,
    /// The tap waits for other functions of the block and for a restarted spindle to reach
    /// its speed.
    Ready,
    /// Feeding in, in phase with the spindle.
    In,
    /// M05: the tool follows the spindle to its standstill.
    Stopping,
    /// Feeding out, in phase with the reversed spindle.
    Out,
    /// M05 at the end: the spindle stops.
    Ending,
    /// The tap is finished.
    Done,
}

/// Supervision of the spindle during a thread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct SpindleWatch {
    /// Speed at the last comparison, r/min, and ticks since then.
    pub rpm: Option<f64>,
    pub ticks: u32,
    /// Whether the spindle has turned during a cut of this run.
    #[serde(rename = "turned")]
    pub has_turned: bool,
    /// Ticks that the command under way has waited for the spindle.
    #[serde(rename = "waited")]
    pub waited_ticks: u32,
    /// Fault of the spindle during the thread under way: the run ends after the thread.
    #[serde(rename = "spoilt")]
    pub fault: Option<SpindleFault>,
}

impl SpindleWatch {
    /// Whether the speed has stayed within 0.5 % for [`FLUCTUATION_TICKS`].
    pub fn check_steady(&mut self, rpm: f64) -> bool {
        let before = *self.rpm.get_or_insert(rpm);
        self.ticks += 1;
        if self.ticks < FLUCTUATION_TICKS {
            return false;
        }
        self.ticks = 0;
        self.rpm = Some(rpm);
        (rpm - before).abs() * 200.0 <= rpm + before
    }

    /// Whether `|n - n0| · 200 / (n + n0)` exceeds the limit, %.
    pub(crate) fn check_fluctuation(&mut self, rpm: f64, limit: f64) -> bool {
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
