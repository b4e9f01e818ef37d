//! Adds up the machine time of a program by kind of motion and by tool.
//!
//! Time between two moves (M, S and T functions, the turret, spindle acceleration) counts for
//! the tool that works after it.

use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_messages::{Message, say};

/// The use of machine time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spending {
    /// Rapids.
    Rapid,
    /// Straight and circular cuts.
    Feed,
    /// Threads with their run-outs, and taps.
    Thread,
    /// Dwells (G04).
    Dwell,
    /// M, S and T functions, tool changes, and other waits of the slides.
    Other,
}

impl Spending {
    /// All kinds, in their display order.
    pub const ALL: [Self; 5] = [
        Self::Rapid,
        Self::Feed,
        Self::Thread,
        Self::Dwell,
        Self::Other,
    ];

    /// The kind for a kind of move.
    pub const fn of(kind: MoveKind) -> Self {
        match kind {
            MoveKind::Rapid => Self::Rapid,
            MoveKind::Feed | MoveKind::Clockwise | MoveKind::CounterClockwise => Self::Feed,
            MoveKind::Thread | MoveKind::RunOut => Self::Thread,
            MoveKind::Dwell => Self::Dwell,
        }
    }

    /// The key in the JSON of a report.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rapid => "rapid",
            Self::Feed => "feed",
            Self::Thread => "thread",
            Self::Dwell => "dwell",
            Self::Other => "other",
        }
    }

    /// The name for the user.
    pub fn words(self) -> Message {
        match self {
            Self::Rapid => say::report_kind_rapid(),
            Self::Feed => say::report_kind_feed(),
            Self::Thread => say::report_kind_thread(),
            Self::Dwell => say::report_kind_dwell(),
            Self::Other => say::report_kind_other(),
        }
    }
}

/// Machine time by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spent {
    seconds: [f64; Spending::ALL.len()],
}

impl Spent {
    /// Time of one kind, s.
    pub const fn on(&self, what: Spending) -> f64 {
        self.seconds[what as usize]
    }

    /// Time with the tool in the material, s: cuts and threads.
    pub const fn cutting(&self) -> f64 {
        self.on(Spending::Feed) + self.on(Spending::Thread)
    }

    /// Sum of all kinds, s.
    pub fn whole(&self) -> f64 {
        self.seconds.iter().sum()
    }

    const fn add(&mut self, what: Spending, seconds: f64) {
        self.seconds[what as usize] += seconds;
    }
}

/// Machine time of one tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolTime {
    /// Tool number; 0 for no tool.
    pub tool: u8,
    /// The number of the offset it first cut with; before a cut, the last one it moved with.
    pub offset: u8,
    /// Its time by kind.
    pub spent: Spent,
}

/// Adds up the times of a program move by move. Its memory grows with the number of tools
/// only.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Times {
    spent: Spent,
    tools: Vec<ToolTime>,
    /// Index of the tool in use.
    current: Option<usize>,
    /// Machine time up to which the sums reach, s.
    until_s: f64,
}

impl Times {
    /// Adds a move. Moves must come in the order of execution.
    pub fn push(&mut self, executed: &ExecutedMove) {
        let (tool, offset) = (executed.conditions.tool, executed.conditions.offset);
        let index = self.change_to(tool, offset);
        self.wait_until(executed.start_s);
        let what = Spending::of(executed.kind);
        if let Some(row) = self.tools.get_mut(index) {
            if row.spent.cutting() == 0.0 {
                row.offset = offset;
            }
            row.spent.add(what, executed.duration_s);
        }
        self.spent.add(what, executed.duration_s);
        self.until_s += executed.duration_s;
    }

    /// Ends the program at a machine time, s. The time after its last move counts as other.
    pub fn end(&mut self, time_s: f64) {
        self.wait_until(time_s);
    }

    /// The time of the whole program.
    pub const fn spent(&self) -> &Spent {
        &self.spent
    }

    /// The time of each tool, in the order of their use.
    pub fn tools(&self) -> &[ToolTime] {
        &self.tools
    }

    fn change_to(&mut self, tool: u8, offset: u8) -> usize {
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
                spent: Spent::default(),
            });
            self.tools.len() - 1
        });
        self.current = Some(index);
        index
    }

    /// Counts the time until a machine time as waiting.
    fn wait_until(&mut self, time_s: f64) {
        let waited = time_s - self.until_s;
        // Blended moves overlap by rounding errors.
        if waited <= 0.0 {
            return;
        }
        self.until_s = time_s;
        self.spent.add(Spending::Other, waited);
        if let Some(row) = self.current.and_then(|index| self.tools.get_mut(index)) {
            row.spent.add(Spending::Other, waited);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::command::{Conditions, ProgramId, Source};
    use gsk_core::units::Point;

    fn executed(kind: MoveKind, tool: u8, start_s: f64, duration_s: f64) -> ExecutedMove {
        ExecutedMove {
            source: Source {
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
            conditions: Conditions {
                tool,
                offset: tool,
                ..Conditions::default()
            },
        }
    }

    #[test]
    fn every_second_has_a_kind_and_a_tool() {
        let mut times = Times::default();
        times.push(&executed(MoveKind::Rapid, 1, 0.5, 1.0));
        times.push(&executed(MoveKind::Feed, 1, 1.5, 4.0));
        times.push(&executed(MoveKind::Clockwise, 1, 5.5, 2.0));
        // The turret takes 3 s.
        times.push(&executed(MoveKind::Thread, 2, 10.5, 8.0));
        times.push(&executed(MoveKind::RunOut, 2, 18.5, 0.5));
        times.push(&executed(MoveKind::Dwell, 2, 19.0, 1.0));
        times.push(&executed(MoveKind::Rapid, 1, 20.0, 1.0));
        times.end(22.0);

        let all = times.spent();
        assert_eq!(all.on(Spending::Rapid), 2.0);
        assert_eq!(all.on(Spending::Feed), 6.0);
        assert_eq!(all.on(Spending::Thread), 8.5);
        assert_eq!(all.on(Spending::Dwell), 1.0);
        assert_eq!(all.on(Spending::Other), 4.5);
        assert_eq!(all.whole(), 22.0);
        let tools: Vec<_> = times.tools().iter().map(|row| row.tool).collect();
        assert_eq!(tools, [1, 2]);
        let [first, second] = times.tools() else {
            panic!("two tools");
        };
        assert_eq!((first.spent.cutting(), second.spent.cutting()), (6.0, 8.5));
        assert_eq!(second.spent.on(Spending::Other), 3.0);
        assert_eq!(first.spent.whole() + second.spent.whole(), 22.0);
    }

    #[test]
    fn a_tool_is_called_by_the_offset_it_cuts_with() {
        let mut times = Times::default();
        let mut cancelled = executed(MoveKind::Rapid, 3, 0.0, 1.0);
        cancelled.conditions.offset = 0;
        times.push(&cancelled);
        times.push(&executed(MoveKind::Feed, 3, 1.0, 1.0));
        cancelled.start_s = 2.0;
        times.push(&cancelled);
        assert_eq!(times.tools()[0].offset, 3);
    }
}
