//! Moves of codes and cycles, in machine coordinates.

use serde::{Deserialize, Serialize};

use crate::command::Action;
use crate::interpreter::context::emission::Emission;
use crate::interpreter::context::exact::Exact;
use crate::interpreter::context::explanation::Note;
use crate::interpreter::context::state::State;
use crate::units::{Feed, Point};

/// Converts programmed to machine coordinates. It stays the same during a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Shift(Exact);

impl Shift {
    /// The conversion of the frame in force.
    pub(crate) fn of(state: &State) -> Self {
        Self(state.zero + state.offset)
    }

    /// The conversion with all points moved by a programmed distance.
    pub(crate) fn moved(self, by: Exact) -> Self {
        Self(self.0 + by)
    }

    /// Machine coordinates of a programmed point, mm.
    pub(crate) fn machine(self, program: Exact) -> Point {
        (program + self.0).point()
    }

    /// Machine coordinates of a programmed centre, mm.
    pub(crate) fn center(self, program: Point) -> Point {
        program + self.0.point()
    }

    /// The programmed point of machine coordinates.
    pub(crate) fn program(self, machine: Point) -> Exact {
        Exact::from_point(machine) - self.0
    }

    /// The programmed centre of machine coordinates, mm.
    pub(crate) fn program_center(self, machine: Point) -> Point {
        machine - self.0.point()
    }
}

/// A move of a cycle, with the data of its explanation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Move {
    pub(crate) action: Action,
    /// Whether single block stops after it.
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

    /// An action with a stop of single block after it.
    pub(crate) const fn of(action: Action, note: Note) -> Self {
        Self {
            action,
            stops: true,
            note,
        }
    }
}

/// One or two moves of a block: a cut, and the chamfer, corner arc or run-out at its end.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Two {
    pub(crate) first: Option<Action>,
    pub(crate) second: Option<Action>,
}

impl Two {
    /// Takes the next move.
    pub(crate) fn next(&mut self) -> Option<Emission> {
        let action = self.first.take().or_else(|| self.second.take());
        action.map(Emission::passing)
    }
}
