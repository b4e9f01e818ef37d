//! State of the thread or tap that a run has under way.

use serde::{Deserialize, Serialize};

use crate::board::SpindleFault;

/// Interval between two comparisons of the spindle speed during a thread, ticks (106).
const FLUCTUATION_TICKS: u32 = 100;

/// Whether feed hold can stop the current motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum HoldProtection {
    /// Feed hold stops the motion without restriction.
    #[default]
    None,
    /// A thread or tap is being executed, or has ended and the next command has not begun: feed
    /// hold waits.
    Thread,
    /// Feed hold was requested in a thread. The first command after the thread runs to its
    /// end.
    After {
        /// Whether a second feed hold stops that command; false for the retract of a cycle.
        again: bool,
    },
}

/// The stage of a tap that is being executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum TapStage {
    /// The spindle starts again for a further start of the thread.
    Restart,
    /// The tap waits for other functions of the block and for a restarted spindle to reach
    /// its speed.
    Ready,
    /// The tool feeds in, in phase with the spindle.
    In,
    /// M05 was output: the tool follows the spindle to its standstill.
    Stopping,
    /// The tool feeds out, in phase with the reversed spindle.
    Out,
    /// M05 was output at the end of the tap: the spindle stops.
    Ending,
    /// The tap has ended.
    Done,
}

/// Supervises the spindle speed during a thread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct SpindleWatch {
    /// Speed at the last comparison, r/min (`None` before the first one), and ticks since
    /// then.
    pub rpm: Option<f64>,
    pub ticks: u32,
    /// Whether the spindle has turned during a cut of this run.
    #[serde(rename = "turned")]
    pub has_turned: bool,
    /// Number of ticks for which the current command has waited for the spindle.
    #[serde(rename = "waited")]
    pub waited_ticks: u32,
    /// Fault of the spindle during the current thread, after which the run ends; `None` without
    /// one.
    #[serde(rename = "spoilt")]
    pub fault: Option<SpindleFault>,
}

impl SpindleWatch {
    /// Compares the speed at intervals of [`FLUCTUATION_TICKS`]. Returns true at the end of
    /// an interval in which it changed by at most 0.5 %.
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

    /// Compares the spindle speed `rpm` at intervals of [`FLUCTUATION_TICKS`]. Returns true at
    /// the end of an interval in which the speed changed by more than `limit` %: `|n - n0| ·
    /// 200 / (n + n0)`. Always returns false if `limit` is 0 or less.
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
