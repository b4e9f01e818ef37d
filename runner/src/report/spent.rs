//! The machine time in a report, by kind of motion.

use serde::Serialize;

use super::tool_word;
use crate::moves::rounded;
use crate::times::{Spending, Spent, ToolTime};

/// Seconds of each kind of motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Seconds {
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
pub struct ToolSeconds {
    /// The T word it first cuts with.
    pub tool: String,
    /// Its seconds of each kind.
    #[serde(flatten)]
    pub seconds: Seconds,
}

impl From<&Spent> for Seconds {
    fn from(spent: &Spent) -> Self {
        let on = |what| rounded(spent.on(what));
        Self {
            rapid: on(Spending::Rapid),
            feed: on(Spending::Feed),
            thread: on(Spending::Thread),
            dwell: on(Spending::Dwell),
            other: on(Spending::Other),
        }
    }
}

impl From<&ToolTime> for ToolSeconds {
    fn from(time: &ToolTime) -> Self {
        Self {
            tool: tool_word((time.tool, time.offset)),
            seconds: Seconds::from(&time.spent),
        }
    }
}

impl Seconds {
    /// The kinds with a time above zero, with their seconds.
    pub(super) fn kinds(&self) -> impl Iterator<Item = (Spending, f64)> {
        [
            (Spending::Rapid, self.rapid),
            (Spending::Feed, self.feed),
            (Spending::Thread, self.thread),
            (Spending::Dwell, self.dwell),
            (Spending::Other, self.other),
        ]
        .into_iter()
        .filter(|(_, seconds)| *seconds > 0.0)
    }

    /// Time with the tool in the material, s.
    pub(super) fn cutting(&self) -> f64 {
        self.feed + self.thread
    }

    /// Sum of all kinds, s.
    pub(super) fn whole(&self) -> f64 {
        self.rapid + self.feed + self.thread + self.dwell + self.other
    }
}
