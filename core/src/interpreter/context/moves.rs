//! Moves that codes and cycles make, in machine coordinates.

use serde::{Deserialize, Serialize};

use crate::command::Action;
use crate::interpreter::context::emission::Emission;
use crate::interpreter::context::exact::Exact;
use crate::interpreter::context::explanation::Note;
use crate::interpreter::context::state::State;
use crate::units::{Feed, Point};

/// From programmed coordinates to machine coordinates. Whatever a cycle does,
/// the frame does not change in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Shift(Exact);

impl Shift {
    /// The frame in force.
    pub(crate) fn of(state: &State) -> Self {
        Self(state.zero + state.offset)
    }

    /// The same with everything moved by a programmed distance.
    pub(crate) fn moved(self, by: Exact) -> Self {
        Self(self.0 + by)
    }

    /// Machine coordinates of a programmed point.
    pub(crate) fn machine(self, program: Exact) -> Point {
        (program + self.0).point()
    }

    /// Machine coordinates of a programmed centre.
    pub(crate) fn center(self, program: Point) -> Point {
        program + self.0.point()
    }

    /// The programmed point of machine coordinates.
    pub(crate) fn program(self, machine: Point) -> Exact {
        Exact::from_point(machine) - self.0
    }

    /// The programmed centre of machine coordinates.
    pub(crate) fn program_center(self, machine: Point) -> Point {
        machine - self.0.point()
    }
}

/// One move of a cycle, with what it belongs to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Move {
    pub(crate) action: Action,
    /// Single block stops after it.
    pub(crate) stops: bool,
    pub(crate) note: Note,
}

impl Move {
    pub(crate) const fn rapid(to: Point, note: Note) -> Self {
        Self::of(Action::Rapid { to }, note)
    }

    pub(crate) const fn line(to: Point, feed: Feed, note: Note) -> Self {
        Self::of(Action::Line { to, feed }, note)
    }

    /// Any action after which single block stops.
    pub(crate) const fn of(action: Action, note: Note) -> Self {
        Self {
            action,
            stops: true,
            note,
        }
    }
}

/// The moves of one block, two at most: a cut, and the chamfer, corner arc or run-out
/// at its end.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Two {
    pub(crate) first: Option<Action>,
    pub(crate) second: Option<Action>,
}

impl Two {
    /// The next one.
    pub(crate) fn next(&mut self) -> Option<Emission> {
        let action = self.first.take().or_else(|| self.second.take());
        action.map(Emission::passing)
    }
}
