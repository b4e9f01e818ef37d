//! Moving by hand in the middle of a run, and going on after it (manual III-5.1.5,
//! I-3.2.6).
//!
//! ```text
//!   block held at H, moved by hand to H':      cycle stopped at the end of a move:
//!
//!   A ------- H ~ ~ ~ > B                      the rest of its path is shifted by
//!             |                                the way moved by hand
//!             H'------> B'  then the next
//!                           block to its point
//! ```

use serde::{Deserialize, Serialize};

use super::automatic::RunState;
use crate::cnc::Cnc;
use crate::command::{Action, Command};
use crate::units::Point;

/// How far the path of a cycle G70 to G75 was moved by hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct CycleShift {
    by: Point,
    /// Where the last move of the cycle ended, until the next one begins.
    ended_at: Option<Point>,
}

impl CycleShift {
    /// A move has ended.
    pub(super) const fn ended(&mut self, command: &Command, at: Point) {
        if command.whole {
            self.ended_at = Some(at);
        }
    }

    /// The command that begins, where the shift puts it.
    pub(super) fn begin(&mut self, command: Command) -> Command {
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

impl Cnc {
    /// Lays the rest of a held motion aside, once the axes stand, so that they can
    /// be moved by hand.
    pub(super) fn set_aside_held_motion(&mut self) {
        let seeking = matches!(self.automatic.action(), Some(Action::ZeroReturn { .. }));
        if seeking && self.automatic.state == RunState::Hold && !self.interpolator.is_moving() {
            // What is left of a search for the reference point cannot be kept.
            return self.stop_run(RunState::Stop);
        }
        let at_rest = self.automatic.state == RunState::Hold
            && self.held.is_none()
            && !self.interpolator.finished()
            && !self.automatic.protected()
            && !self.interpolator.is_moving();
        if !at_rest {
            return;
        }
        self.held = Some(self.interpolator.clone());
        self.interpolator.cancel();
    }

    /// Cycle start after manual motion: the interrupted block goes its remaining
    /// distance from where the axes stand now; the next block goes to the
    /// programmed coordinates.
    pub(crate) fn absorb_manual_motion(&mut self) {
        let Some(mut held) = self.held.take() else {
            return;
        };
        held.translate(self.interpolator.position() - held.position());
        self.interpolator = held;
    }

    /// Cycle start at the end of a move of a cycle: the rest goes on from where the
    /// axes stand now.
    pub(super) fn shift_cycle(&mut self) {
        let now = self.position();
        let shift = &mut self.automatic.cycle_shift;
        if let Some(before) = shift.ended_at.take() {
            shift.by = shift.by + now - before;
        }
    }
}
