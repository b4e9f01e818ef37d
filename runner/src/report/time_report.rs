//! The machine time in a report, by kind of motion.

use serde::Serialize;

use super::tool_word;
use crate::move_output::round_to_millionth;
use crate::times::{TimeUse, TimesByUse, ToolTime};

/// Seconds of each kind of motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct TimeReport {
    /// Rapids, s.
    pub rapid: f64,
    /// Straight and circular cuts, s.
    pub feed: f64,
    /// Threads and taps, s.
    pub thread: f64,
    /// Dwells (G04), s.
    pub dwell: f64,
    /// M, S and T functions, and other waits of the slides, s.
    pub other: f64,
}

/// Machine time of a tool.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ToolTimeReport {
    /// The T word it first cuts with.
    pub tool: String,
    /// Its seconds of each kind.
    #[serde(flatten)]
    pub seconds: TimeReport,
}

impl From<&TimesByUse> for TimeReport {
    fn from(spent: &TimesByUse) -> Self {
        let on = |what| round_to_millionth(spent.seconds_of(what));
        Self {
            rapid: on(TimeUse::Rapid),
            feed: on(TimeUse::Feed),
            thread: on(TimeUse::Thread),
            dwell: on(TimeUse::Dwell),
            other: on(TimeUse::Other),
        }
    }
}

impl From<&ToolTime> for ToolTimeReport {
    fn from(time: &ToolTime) -> Self {
        Self {
            tool: tool_word((time.tool, time.offset)),
            seconds: TimeReport::from(&time.times),
        }
    }
}

impl TimeReport {
    /// The kinds with a time above zero, with their seconds.
    pub(super) fn nonzero_kinds(&self) -> impl Iterator<Item = (TimeUse, f64)> {
        [
            (TimeUse::Rapid, self.rapid),
            (TimeUse::Feed, self.feed),
            (TimeUse::Thread, self.thread),
            (TimeUse::Dwell, self.dwell),
            (TimeUse::Other, self.other),
        ]
        .into_iter()
        .filter(|(_, seconds)| *seconds > 0.0)
    }

    /// Time with the tool in the material, s.
    pub(super) fn cutting_s(&self) -> f64 {
        self.feed + self.thread
    }

    /// Sum of all kinds, s.
    pub(super) fn total_s(&self) -> f64 {
        self.rapid + self.feed + self.thread + self.dwell + self.other
    }
}
