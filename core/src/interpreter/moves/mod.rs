//! Moves of codes and cycles, in machine coordinates.

pub(super) mod explanation;
pub(super) mod planned_action;

use serde::{Deserialize, Serialize};

use crate::command::Action;
use crate::interpreter::exact::ExactPoint;
use crate::interpreter::moves::explanation::PassNote;
use crate::interpreter::moves::planned_action::PlannedAction;
use crate::interpreter::state::State;
use crate::units::{Feed, Point};

/// The shift from programmed to machine coordinates. A cycle stores this shift, which does not
/// change during the cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct FrameShift(ExactPoint);

impl FrameShift {
    /// The shift in force: the program zero plus the tool offset.
    pub(crate) fn from_state(state: &State) -> Self {
        Self(state.zero + state.offset)
    }

    /// This shift plus `distance`: all converted points move by it.
    pub(crate) fn moved(self, distance: ExactPoint) -> Self {
        Self(self.0 + distance)
    }

    /// Converts a programmed point to machine coordinates, mm, X as a radius.
    pub(crate) fn to_machine(self, program: ExactPoint) -> Point {
        (program + self.0).to_point()
    }

    /// Converts a programmed centre to machine coordinates; both in mm, X as a radius.
    pub(crate) fn center_to_machine(self, program: Point) -> Point {
        program + self.0.to_point()
    }

    /// Converts machine coordinates (mm, X as a radius) to the programmed point.
    pub(crate) fn to_program(self, machine: Point) -> ExactPoint {
        ExactPoint::from_point(machine) - self.0
    }

    /// Converts a centre from machine to programmed coordinates; both in mm, X as a radius.
    pub(crate) fn center_to_program(self, machine: Point) -> Point {
        machine - self.0.to_point()
    }
}

/// A move of a cycle, with the data of its explanation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Move {
    pub(crate) action: Action,
    /// Whether single block stops the run after the move.
    pub(crate) stops: bool,
    pub(crate) note: PassNote,
}

impl Move {
    pub(crate) const fn rapid(to: Point, note: PassNote) -> Self {
        Self::from_action(Action::Rapid { to }, note)
    }

    pub(crate) const fn line(to: Point, feed: Feed, note: PassNote) -> Self {
        Self::from_action(Action::Line { to, feed }, note)
    }

    /// A move by `action`, after which single block stops.
    pub(crate) const fn from_action(action: Action, note: PassNote) -> Self {
        Self {
            action,
            stops: true,
            note,
        }
    }
}

/// One or two moves of a block: a cut, and the chamfer, corner arc or run-out at its end.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct MovePair {
    pub(crate) first: Option<Action>,
    pub(crate) second: Option<Action>,
}

impl MovePair {
    /// Takes the next move out of the pair; `None` if no move is left.
    pub(crate) fn next_action(&mut self) -> Option<PlannedAction> {
        let action = self.first.take().or_else(|| self.second.take());
        action.map(PlannedAction::without_stop)
    }
}
