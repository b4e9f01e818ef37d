//! The shift of a cycle's path by manual motion (manual III-5.1.5, I-3.2.6).

use crate::command::ControlCommand;
use crate::units::Point;
use serde::{Deserialize, Serialize};

/// The displacement, mm, by which manual motion has shifted the path of a cycle G70 to G75.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct CycleShift {
    #[serde(rename = "by")]
    pub shift: Point,
    /// End point of the cycle's last move; `None` when the next move has begun.
    pub ended_at: Option<Point>,
}

impl CycleShift {
    /// Records the end point of a finished command, if the command is a move of a cycle.
    pub(crate) const fn note_end(&mut self, command: &ControlCommand, at: Point) {
        if command.defers_feed_hold {
            self.ended_at = Some(at);
        }
    }

    /// Returns the command that begins, with its move shifted if it belongs to the cycle.
    pub(crate) fn shift_command(&mut self, command: ControlCommand) -> ControlCommand {
        self.ended_at = None;
        if !command.defers_feed_hold {
            self.shift = Point::default();
        }
        if self.shift == Point::default() {
            return command;
        }
        ControlCommand {
            action: command.action.shifted(self.shift),
            ..command
        }
    }
}
