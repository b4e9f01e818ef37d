//! The shift of a cycle's path by manual motion (manual III-5.1.5, I-3.2.6).

use crate::command::Command;
use crate::units::Point;
use serde::{Deserialize, Serialize};

/// How far manual motion has shifted the path of a cycle G70 to G75.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct CycleShift {
    #[serde(rename = "by")]
    pub by: Point,
    /// End of the cycle's last move, until the next one begins.
    pub ended_at: Option<Point>,
}

impl CycleShift {
    /// Notes the end of a command.
    pub(crate) const fn ended(&mut self, command: &Command, at: Point) {
        if command.whole {
            self.ended_at = Some(at);
        }
    }

    /// Returns the command that begins, shifted by the present shift.
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
