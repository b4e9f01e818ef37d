//! The remaining actions of the block read last. The caller takes commands one by one, and a
//! cycle makes each move on request.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use crate::alarm::Alarm;
use crate::command::{Action, Command, Source};
use crate::interpreter::Modal;
use crate::interpreter::canned_cycle::{Cycle, Maker};
use crate::interpreter::codes::reference::Reference;
use crate::interpreter::context::emission::Emission;
use crate::interpreter::context::explanation::Note;
use crate::interpreter::context::flow::{Finishing, Flow};
use crate::interpreter::context::moves::{Shift, Two};
use crate::interpreter::context::state::State;
use crate::interpreter::context::writes::Writes;
use crate::interpreter::cycles::box_cycle::BoxCycle;

/// The motion of a block: a variant for each way to make moves.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) enum Motion {
    /// No motion, or none left.
    #[default]
    None,
    /// A single move, dwell or change of coordinates.
    #[serde(rename = "One")]
    One(Action),
    /// G90, G94.
    Box(Box<BoxCycle>),
    /// G28.
    Reference(Box<Reference>),
    /// A cut and its chamfer, corner arc or run-out.
    #[serde(rename = "Two")]
    Two(Box<Two>),
    /// G33 with several starts, G71 to G76, G92.
    Cycle(Box<Cycle>),
}

impl From<Two> for Motion {
    fn from(moves: Two) -> Self {
        match moves {
            Two {
                first: None,
                second: None,
            } => Self::None,
            Two {
                first: Some(action),
                second: None,
            }
            | Two {
                first: None,
                second: Some(action),
            } => Self::One(action),
            both => Self::Two(Box::new(both)),
        }
    }
}

impl Motion {
    /// Starts a cycle at the current position of the tool.
    ///
    /// # Errors
    /// 062 if the cycle makes no move.
    pub(crate) fn cycle(state: &State, maker: Maker) -> Result<Self, Alarm> {
        Ok(Self::Cycle(Box::new(Cycle::begin(state, maker)?)))
    }

    #[inline]
    pub(crate) fn next(&mut self) -> Option<Emission> {
        match self {
            Self::None => None,
            Self::One(action) => {
                let action = *action;
                *self = Self::None;
                Some(Emission::passing(action))
            }
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

    /// Whether the motion is along a contour (G00 to G03), where G41 and G42 act. Cycles,
    /// threads and G28 run without compensation.
    pub(crate) const fn is_contour(&self) -> bool {
        matches!(
            self,
            Self::One(Action::Rapid { .. } | Action::Line { .. } | Action::Arc { .. })
                | Self::Two(_)
        )
    }

    /// Whether the end of the motion is known only when it is finished.
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

/// The remaining actions of a block, in their order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Plan {
    pub(crate) source: Source,
    pub(crate) modal: Modal,
    /// Actions of S, M and T.
    pub(crate) before: VecDeque<Action>,
    pub(crate) motion: Motion,
    /// Whether the motion runs without nose radius compensation in any case.
    #[serde(rename = "apart")]
    pub(crate) apart: bool,
    /// M00, M30, or M99 of the main program.
    pub(crate) after: Option<Action>,
    /// The flow of the run after the last action.
    pub(crate) flow: Flow,
    /// Whether single block stops at the end of the block.
    #[serde(rename = "stops")]
    pub(crate) stops: bool,
    /// Whether feed hold waits for the end of each move.
    #[serde(rename = "whole")]
    pub(crate) whole: bool,
    /// Parameters to write when the reader accepts the block.
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

    /// Queues an action that begins in the same tick as the tool change of the block: the
    /// strobes of M, S and T rise together, and one FIN answers all of them (manual PLC-II
    /// 8.1).
    pub(crate) fn begin_with_tool(&mut self, action: Action) {
        let is_tool = |action: &Action| matches!(action, Action::Tool { .. });
        let tool = self.before.iter().position(is_tool);
        self.before
            .insert(tool.unwrap_or(self.before.len()), action);
    }

    /// Marks the tool change as the last action, if no motion, dwell or stop of its block
    /// follows.
    pub(crate) fn mark_last_tool(&mut self) {
        let rests = matches!(self.motion, Motion::None) && self.after.is_none();
        for action in &mut self.before {
            if let Action::Tool { is_last, .. } = action {
                *is_last = rests;
            }
        }
    }

    /// The return to the start after the profile of a G70, as the end of its block.
    pub(crate) fn after_profile(finishing: &Finishing, state: &mut State) -> Self {
        state.stand_at(state.machine(finishing.start));
        let mut plan = Self::new(finishing.source, state.modal);
        plan.motion = Motion::One(Action::Rapid {
            to: Shift::of(state).machine(finishing.start),
        });
        plan.apart = true;
        plan.flow = Flow::Jump(finishing.back);
        plan
    }

    /// The explanation data of the cycle move taken last.
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

    /// Takes the next command.
    #[inline]
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
