//! What the block read last still has to do. Commands are taken one by one:
//! a cycle makes its next move when it is asked for it.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use crate::command::{Action, Command, Source};
use crate::interpreter::Modal;
use crate::interpreter::box_cycle::BoxCycle;
use crate::interpreter::reference::Reference;
use crate::interpreter::subprogram::Flow;

/// One action of a block.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Emission {
    pub(crate) action: Action,
    /// Single block stops after it, even inside the block.
    pub(crate) stops: bool,
}

impl Emission {
    /// An action after which single block stops.
    pub(crate) const fn stopping(action: Action) -> Self {
        Self {
            action,
            stops: true,
        }
    }

    /// An action inside its block.
    pub(crate) const fn passing(action: Action) -> Self {
        Self {
            action,
            stops: false,
        }
    }
}

/// The motion of a block: one variant for each way to make moves.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) enum Motion {
    /// None, or none left.
    #[default]
    None,
    /// A single move, dwell or change of coordinates.
    One(Action),
    /// G90, G94.
    Box(BoxCycle),
    /// G28.
    Reference(Reference),
}

impl Motion {
    fn next(&mut self) -> Option<Emission> {
        match self {
            Self::None => None,
            Self::One(_) => match core::mem::take(self) {
                Self::One(action) => Some(Emission::passing(action)),
                _ => None,
            },
            Self::Box(cycle) => cycle.next(),
            Self::Reference(reference) => reference.next(),
        }
    }

    /// Whether the axes move.
    pub(crate) fn moves(&self) -> bool {
        match self {
            Self::None => false,
            Self::One(action) => matches!(
                action,
                Action::Rapid { .. } | Action::Line { .. } | Action::Arc { .. }
            ),
            Self::Box(_) | Self::Reference(_) => true,
        }
    }

    fn is_done(&self) -> bool {
        match self {
            Self::None => true,
            Self::One(_) => false,
            Self::Box(cycle) => cycle.is_done(),
            Self::Reference(reference) => reference.is_done(),
        }
    }
}

/// The rest of a block, in the order in which it happens.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Plan {
    pub(crate) source: Source,
    pub(crate) modal: Modal,
    /// T, S, M.
    pub(crate) before: VecDeque<Action>,
    pub(crate) motion: Motion,
    /// M00, M30, M99 of the main program.
    pub(crate) after: Option<Action>,
    /// Where reading goes on when everything is taken.
    pub(crate) flow: Flow,
    /// Whether single block stops at the end of the block.
    pub(crate) stops: bool,
}

impl Plan {
    pub(crate) fn new(source: Source, modal: Modal) -> Self {
        Self {
            source,
            modal,
            before: VecDeque::new(),
            motion: Motion::None,
            after: None,
            flow: Flow::Next,
            stops: true,
        }
    }

    /// Whether every command is taken.
    pub(crate) fn is_done(&self) -> bool {
        self.before.is_empty() && self.motion.is_done() && self.after.is_none()
    }

    /// The next command.
    pub(crate) fn take(&mut self) -> Option<Command> {
        let emission = match self.before.pop_front() {
            Some(action) => Emission::passing(action),
            None => match self.motion.next() {
                Some(emission) => emission,
                None => Emission::passing(self.after.take()?),
            },
        };
        let block_end = self.is_done();
        Some(Command {
            source: self.source,
            action: emission.action,
            modal: self.modal,
            block_end,
            stop_point: emission.stops || (block_end && self.stops),
        })
    }
}
