//! The shift that motion by hand leaves in a cycle (manual III-5.1.5, I-3.2.6).

use crate::command::Command;
use crate::units::Point;
use serde::{Deserialize, Serialize};

/// How far the path of a cycle G70 to G75 was moved by hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct CycleShift {
    pub by: Point,
    /// Where the last move of the cycle ended, until the next one begins.
    pub ended_at: Option<Point>,
}

impl CycleShift {
    /// A move has ended.
    pub(crate) const fn ended(&mut self, command: &Command, at: Point) {
        if command.whole {
            self.ended_at = Some(at);
        }
    }

    /// The command that begins, where the shift puts it.
    pub(crate) fn begin(&mut self, command: Command) -> Command {
        self.ended_at = None;
        if !command.whole {
            self.by = Point::default();
        }
        if self.by == Point::default() {
            return command;
        }
        Command {
            action: command.action.translated(self.by),
            ..command
        }
    }
}
