//! The machine time in a report, by kind of motion.

use serde::Serialize;

use super::tool_word;
use crate::move_output::round_to_millionth;
use crate::times::{TimeUse, TimesByUse, ToolTime};

/// Machine time of each kind of motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct TimeReport {
    /// Machine time of rapids, s.
    pub rapid: f64,
    /// Machine time of straight and circular cuts, s.
    pub feed: f64,
    /// Machine time of threads and taps, s.
    pub thread: f64,
    /// Machine time of dwells (G04), s.
    pub dwell: f64,
    /// Time of M, S and T functions, and of other waits of the slides, s.
    pub other: f64,
}

/// Machine time of a tool, by kind of motion.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ToolTimeReport {
    /// The T word of the tool's first cut, as digits.
    pub tool: String,
    /// Machine time of the tool, by kind of motion.
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
    /// Returns the kinds of motion with a time above zero, with their times in s.
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

    /// Returns the time in which tools are in the material, s: cuts, threads and taps.
    pub(super) fn cutting_s(&self) -> f64 {
        self.feed + self.thread
    }

    /// Returns the sum of the times of all kinds, s.
    pub(crate) fn total_s(&self) -> f64 {
        self.rapid + self.feed + self.thread + self.dwell + self.other
    }
}
