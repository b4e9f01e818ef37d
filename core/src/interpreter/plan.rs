//! What the block read last still has to do. Commands are taken one by one:
//! a cycle makes its next move when it is asked for it.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use crate::command::{Action, Command, Source};
use crate::interpreter::Modal;
use crate::interpreter::box_cycle::BoxCycle;
use crate::interpreter::cycle::Cycle;
use crate::interpreter::exact::scaled;
use crate::interpreter::explanation::Note;
use crate::interpreter::reference::Reference;
use crate::interpreter::subprogram::Flow;
use crate::memory::{ParameterError, Parameters};

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

/// Two moves of one block: a cut and the chamfer, corner arc or run-out at its
/// end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Two {
    first: Option<Action>,
    second: Option<Action>,
}

impl Two {
    /// One after the other.
    pub(crate) fn then(first: Action, second: Action) -> Box<Self> {
        Box::new(Self {
            first: Some(first),
            second: Some(second),
        })
    }

    fn next(&mut self) -> Option<Emission> {
        let action = self.first.take().or_else(|| self.second.take());
        action.map(Emission::passing)
    }
}

/// Parameters that a cycle writes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Writes(Vec<(u16, i32)>);

impl Writes {
    /// A whole number.
    pub(crate) fn push(&mut self, number: u16, value: i64) {
        let value = i32::try_from(value).unwrap_or(if value < 0 { i32::MIN } else { i32::MAX });
        self.0.push((number, value));
    }

    /// A length in millionths, as thousandths.
    pub(crate) fn push_length(&mut self, number: u16, length: i64) {
        self.push(number, scaled(length, 1, 1000));
    }

    /// The value of a parameter after these writes.
    pub(crate) fn value(&self, number: u16, parameters: &Parameters) -> i32 {
        let written = self.0.iter().rev().find(|(written, _)| *written == number);
        written.map_or_else(|| parameters.value(number), |(_, value)| *value)
    }

    /// Carries the writes out.
    pub(crate) fn apply(&mut self, parameters: &mut Parameters) -> Result<(), ParameterError> {
        for (number, value) in core::mem::take(&mut self.0) {
            parameters.set(number, value)?;
        }
        Ok(())
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
    Box(Box<BoxCycle>),
    /// G28.
    Reference(Reference),
    /// A cut with a chamfer, corner arc or run-out.
    Two(Box<Two>),
    /// G33 with several starts, G71 to G76, G92.
    Cycle(Box<Cycle>),
}

impl Motion {
    pub(crate) fn next(&mut self) -> Option<Emission> {
        match self {
            Self::None => None,
            Self::One(_) => match core::mem::take(self) {
                Self::One(action) => Some(Emission::passing(action)),
                _ => None,
            },
            Self::Box(cycle) => cycle.next(),
            Self::Reference(reference) => reference.next(),
            Self::Two(two) => two.next(),
            Self::Cycle(cycle) => cycle.next(),
        }
    }

    /// Whether the axes move.
    pub(crate) fn moves(&self) -> bool {
        match self {
            Self::None => false,
            Self::One(action) => action.is_motion(),
            Self::Box(_) | Self::Reference(_) | Self::Two(_) | Self::Cycle(_) => true,
        }
    }

    /// Whether it goes along a contour, where G41 and G42 act: G00 to G03. The
    /// moves of cycles, threads and G28 run without compensation.
    pub(crate) const fn is_contour(&self) -> bool {
        matches!(
            self,
            Self::One(Action::Rapid { .. } | Action::Line { .. } | Action::Arc { .. })
                | Self::Two(_)
        )
    }

    /// Whether where it ends is known only when it is finished.
    pub(crate) const fn ends_unknown(&self) -> bool {
        matches!(self, Self::Reference(reference) if reference.seeks())
    }

    fn is_done(&self) -> bool {
        match self {
            Self::None => true,
            Self::One(_) => false,
            Self::Box(cycle) => cycle.is_done(),
            Self::Reference(reference) => reference.is_done(),
            Self::Two(two) => two.second.is_none(),
            Self::Cycle(cycle) => cycle.is_done(),
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
    /// The motion runs without nose radius compensation, whatever it is.
    pub(crate) apart: bool,
    /// M00, M30, M99 of the main program.
    pub(crate) after: Option<Action>,
    /// Where reading goes on when everything is taken.
    pub(crate) flow: Flow,
    /// Whether single block stops at the end of the block.
    pub(crate) stops: bool,
    /// Whether feed hold waits for the end of each of its moves.
    pub(crate) whole: bool,
    /// Parameters that come into force with it.
    pub(crate) writes: Writes,
}

impl Plan {
    pub(crate) fn new(source: Source, modal: Modal) -> Self {
        Self {
            source,
            modal,
            before: VecDeque::new(),
            motion: Motion::None,
            apart: false,
            after: None,
            flow: Flow::Next,
            stops: true,
            whole: false,
            writes: Writes::default(),
        }
    }

    /// Why the move of a cycle taken last is where it is.
    pub(crate) fn note(&self) -> Option<Note> {
        match &self.motion {
            Motion::Cycle(cycle) => cycle.note(),
            Motion::Box(cycle) => cycle.note(),
            _ => None,
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
            whole: self.whole,
            programmed_x: None,
        })
    }
}
