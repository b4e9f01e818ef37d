//! Adds up the machine time of a program by kind of motion and by tool.
//!
//! Time between two moves (M, S and T functions, the turret, spindle acceleration) counts for
//! the tool that works after it.

use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_messages::{Message, say};

/// The kind of activity that takes machine time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeUse {
    /// Machine time of rapids.
    Rapid,
    /// Machine time of straight and circular cuts.
    Feed,
    /// Machine time of threads with their run-outs, and of taps.
    Thread,
    /// Machine time of dwells programmed with G04.
    Dwell,
    /// Machine time of M, S and T functions, tool changes, and other waits of the axes.
    Other,
}

impl TimeUse {
    /// All kinds of activity, in their display order.
    pub const ALL: [Self; 5] = [
        Self::Rapid,
        Self::Feed,
        Self::Thread,
        Self::Dwell,
        Self::Other,
    ];

    /// Returns the kind of activity to which the time of a move counts.
    pub const fn from_move_kind(kind: MoveKind) -> Self {
        match kind {
            MoveKind::Rapid => Self::Rapid,
            MoveKind::Feed | MoveKind::Clockwise | MoveKind::CounterClockwise => Self::Feed,
            MoveKind::Thread | MoveKind::RunOut => Self::Thread,
            MoveKind::Dwell => Self::Dwell,
        }
    }

    /// Returns the key of this kind of activity in the JSON of a report.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rapid => "rapid",
            Self::Feed => "feed",
            Self::Thread => "thread",
            Self::Dwell => "dwell",
            Self::Other => "other",
        }
    }

    /// Returns the name of this kind of activity, for the user.
    pub fn message(self) -> Message {
        match self {
            Self::Rapid => say::report_kind_rapid(),
            Self::Feed => say::report_kind_feed(),
            Self::Thread => say::report_kind_thread(),
            Self::Dwell => say::report_kind_dwell(),
            Self::Other => say::report_kind_other(),
        }
    }
}

/// Sums of machine time by kind of activity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TimesByUse {
    seconds: [f64; TimeUse::ALL.len()],
}

impl TimesByUse {
    /// Returns the machine time of one kind of activity, s.
    pub const fn seconds_of(&self, time_use: TimeUse) -> f64 {
        self.seconds[time_use as usize]
    }

    /// Returns the time with the tool in the material, s: cuts and threads.
    pub const fn cutting_s(&self) -> f64 {
        self.seconds_of(TimeUse::Feed) + self.seconds_of(TimeUse::Thread)
    }

    /// Returns the sum over all kinds of activity, s.
    pub fn total_s(&self) -> f64 {
        self.seconds.iter().sum()
    }

    const fn add(&mut self, what: TimeUse, seconds: f64) {
        self.seconds[what as usize] += seconds;
    }
}

/// Machine time of one tool, by kind of activity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolTime {
    /// Number of the tool; 0 for no tool.
    pub tool: u8,
    /// Number of the offset at the tool's first cut; before a cut, of the offset it last moved
    /// with.
    pub offset: u8,
    /// Machine time of the tool, by kind of activity.
    pub times: TimesByUse,
}

/// Adds up the times of a program move by move. Its memory grows with the number of tools
/// only.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProgramTimes {
    spent: TimesByUse,
    tools: Vec<ToolTime>,
    /// Index of the tool in use in the list of tools; `None` before the first.
    current: Option<usize>,
    /// Machine time up to which the sums are complete, s.
    until_s: f64,
}

impl ProgramTimes {
    /// Adds the time of a move. Moves must come in the order of execution.
    pub fn add_move(&mut self, executed: &ExecutedMove) {
        let (tool, offset) = (executed.conditions.tool, executed.conditions.offset);
        let index = self.select_tool(tool, offset);
        self.add_wait_until(executed.start_s);
        let what = TimeUse::from_move_kind(executed.kind);
        if let Some(row) = self.tools.get_mut(index) {
            if row.times.cutting_s() == 0.0 {
                row.offset = offset;
            }
            row.times.add(what, executed.duration_s);
        }
        self.spent.add(what, executed.duration_s);
        self.until_s += executed.duration_s;
    }

    /// Ends the program at machine time `time_s`. The time after its last move counts as
    /// other.
    pub fn end_at(&mut self, time_s: f64) {
        self.add_wait_until(time_s);
    }

    /// Returns the machine time of the whole program, by kind of activity.
    pub const fn spent(&self) -> &TimesByUse {
        &self.spent
    }

    /// Returns the machine time of each tool, in the order of their first use.
    pub fn tools(&self) -> &[ToolTime] {
        &self.tools
    }

    fn select_tool(&mut self, tool: u8, offset: u8) -> usize {
        if let Some(index) = self.current
            && self.tools.get(index).is_some_and(|row| row.tool == tool)
        {
            return index;
        }
        let known = self.tools.iter().position(|row| row.tool == tool);
        let index = known.unwrap_or_else(|| {
            self.tools.push(ToolTime {
                tool,
                offset,
                times: TimesByUse::default(),
            });
            self.tools.len() - 1
        });
        self.current = Some(index);
        index
    }

    /// Counts the time from the last move until `time_s` as [`TimeUse::Other`].
    fn add_wait_until(&mut self, time_s: f64) {
        let waited = time_s - self.until_s;
        // Blended moves overlap by rounding errors.
        if waited <= 0.0 {
            return;
        }
        self.until_s = time_s;
        self.spent.add(TimeUse::Other, waited);
        if let Some(row) = self.current.and_then(|index| self.tools.get_mut(index)) {
            row.times.add(TimeUse::Other, waited);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::command::{MoveConditions, ProgramId, SourcePosition};
    use gsk_core::units::Point;

    fn move_of_kind(kind: MoveKind, tool: u8, start_s: f64, duration_s: f64) -> ExecutedMove {
        ExecutedMove {
            source: SourcePosition {
                program: ProgramId::External,
                line: 1,
                sequence: None,
            },
            kind,
            from: Point::default(),
            to: Point::default(),
            center: None,
            feed: None,
            start_s,
            duration_s,
            conditions: MoveConditions {
                tool,
                offset: tool,
                ..MoveConditions::default()
            },
        }
    }

    #[test]
    fn every_second_has_a_kind_and_a_tool() {
        let mut times = ProgramTimes::default();
        times.add_move(&move_of_kind(MoveKind::Rapid, 1, 0.5, 1.0));
        times.add_move(&move_of_kind(MoveKind::Feed, 1, 1.5, 4.0));
        times.add_move(&move_of_kind(MoveKind::Clockwise, 1, 5.5, 2.0));
        // The turret takes 3 s.
        times.add_move(&move_of_kind(MoveKind::Thread, 2, 10.5, 8.0));
        times.add_move(&move_of_kind(MoveKind::RunOut, 2, 18.5, 0.5));
        times.add_move(&move_of_kind(MoveKind::Dwell, 2, 19.0, 1.0));
        times.add_move(&move_of_kind(MoveKind::Rapid, 1, 20.0, 1.0));
        times.end_at(22.0);

        let all = times.spent();
        assert_eq!(all.seconds_of(TimeUse::Rapid), 2.0);
        assert_eq!(all.seconds_of(TimeUse::Feed), 6.0);
        assert_eq!(all.seconds_of(TimeUse::Thread), 8.5);
        assert_eq!(all.seconds_of(TimeUse::Dwell), 1.0);
        assert_eq!(all.seconds_of(TimeUse::Other), 4.5);
        assert_eq!(all.total_s(), 22.0);
        let tools: Vec<_> = times.tools().iter().map(|row| row.tool).collect();
        assert_eq!(tools, [1, 2]);
        let [first, second] = times.tools() else {
            panic!("two tools");
        };
        assert_eq!(
            (first.times.cutting_s(), second.times.cutting_s()),
            (6.0, 8.5)
        );
        assert_eq!(second.times.seconds_of(TimeUse::Other), 3.0);
        assert_eq!(first.times.total_s() + second.times.total_s(), 22.0);
    }

    #[test]
    fn a_tool_is_called_by_the_offset_it_cuts_with() {
        let mut times = ProgramTimes::default();
        let mut cancelled = move_of_kind(MoveKind::Rapid, 3, 0.0, 1.0);
        cancelled.conditions.offset = 0;
        times.add_move(&cancelled);
        times.add_move(&move_of_kind(MoveKind::Feed, 3, 1.0, 1.0));
        cancelled.start_s = 2.0;
        times.add_move(&cancelled);
        assert_eq!(times.tools()[0].offset, 3);
    }
}
