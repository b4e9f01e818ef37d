//! The remaining actions of the block read last. The caller takes commands one by one, and a
//! cycle makes each move on request.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use crate::alarm::Alarm;
use crate::command::{Action, ControlCommand, SourcePosition};
use crate::interpreter::ModalState;
use crate::interpreter::canned_cycle::{Cycle, CycleGenerator};
use crate::interpreter::codes::reference::ReferenceReturn;
use crate::interpreter::cycles::box_cycle::BoxCycle;
use crate::interpreter::flow::{Finishing, Flow};
use crate::interpreter::moves::explanation::PassNote;
use crate::interpreter::moves::planned_action::PlannedAction;
use crate::interpreter::moves::{FrameShift, MovePair};
use crate::interpreter::parameter_writes::ParameterWrites;
use crate::interpreter::state::State;

/// The remaining motion of a block, by the kind of its moves.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) enum PlannedMotion {
    /// The block has no motion, or no move is left.
    #[default]
    None,
    /// A single move, dwell or change of coordinates.
    #[serde(rename = "One")]
    Single(Action),
    /// A turning or facing pass of G90 or G94.
    Box(Box<BoxCycle>),
    /// A return to the reference point (G28 and similar codes).
    Reference(Box<ReferenceReturn>),
    /// A cut and the chamfer, corner arc or run-out at its end.
    #[serde(rename = "Two")]
    Pair(Box<MovePair>),
    /// A cycle that generates its moves: tapping, threads, G71 to G76 and others.
    Cycle(Box<Cycle>),
}

impl From<MovePair> for PlannedMotion {
    fn from(moves: MovePair) -> Self {
        match moves {
            MovePair {
                first: None,
                second: None,
            } => Self::None,
            MovePair {
                first: Some(action),
                second: None,
            }
            | MovePair {
                first: None,
                second: Some(action),
            } => Self::Single(action),
            pair => Self::Pair(Box::new(pair)),
        }
    }
}

impl PlannedMotion {
    /// Starts a cycle at the current position of the tool.
    ///
    /// # Errors
    /// 062 if the cycle makes no move.
    pub(crate) fn start_cycle(state: &State, generator: CycleGenerator) -> Result<Self, Alarm> {
        Ok(Self::Cycle(Box::new(Cycle::begin(state, generator)?)))
    }

    #[inline]
    pub(crate) fn next_action(&mut self) -> Option<PlannedAction> {
        match self {
            Self::None => None,
            Self::Single(action) => {
                let action = *action;
                *self = Self::None;
                Some(PlannedAction::without_stop(action))
            }
            Self::Box(cycle) => cycle.next_action(),
            Self::Reference(reference) => reference.next_action(),
            Self::Pair(two) => two.next_action(),
            Self::Cycle(cycle) => cycle.next_action(),
        }
    }

    /// Whether the block has any motion of the axes.
    pub(crate) fn has_motion(&self) -> bool {
        match self {
            Self::None => false,
            Self::Single(action) => action.is_motion(),
            Self::Box(_) | Self::Reference(_) | Self::Pair(_) | Self::Cycle(_) => true,
        }
    }

    /// Whether the motion is along a contour (G00 to G03), where G41 and G42 act. Cycles,
    /// threads and G28 run without compensation.
    pub(crate) const fn is_contour(&self) -> bool {
        matches!(
            self,
            Self::Single(Action::Rapid { .. } | Action::Line { .. } | Action::Arc { .. })
                | Self::Pair(_)
        )
    }

    /// Whether the end point is known only when the motion is finished, as in a return that
    /// seeks a reference point.
    pub(crate) const fn is_end_unknown(&self) -> bool {
        matches!(self, Self::Reference(reference) if reference.is_seeking())
    }

    fn is_done(&self) -> bool {
        match self {
            Self::None => true,
            Self::Single(_) => false,
            Self::Box(cycle) => cycle.is_done(),
            Self::Reference(reference) => reference.is_done(),
            Self::Pair(two) => two.second.is_none(),
            Self::Cycle(cycle) => cycle.is_done(),
        }
    }
}

/// The remaining actions of a block, in their order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Plan {
    pub(crate) source: SourcePosition,
    pub(crate) modal: ModalState,
    /// Actions before the motion: those of S, M and T, and the wait for an input.
    pub(crate) before: VecDeque<Action>,
    pub(crate) motion: PlannedMotion,
    /// Whether the motion runs without nose radius compensation even if G41 or G42 is in
    /// force.
    #[serde(rename = "apart")]
    pub(crate) is_uncompensated: bool,
    /// The action after the motion: M00, M30, M99 of the main program, an exact stop, or the
    /// action of an otherwise empty block.
    pub(crate) after: Option<Action>,
    /// The continuation of the run after the last action.
    pub(crate) flow: Flow,
    /// Whether single block stops at the end of the block.
    #[serde(rename = "stops")]
    pub(crate) is_stop: bool,
    /// Whether feed hold stops only at the end of a move, as in G70 to G75.
    #[serde(rename = "whole")]
    pub(crate) holds_at_move_end: bool,
    /// Parameters to write when the reader accepts the block.
    pub(crate) writes: ParameterWrites,
}

impl Plan {
    pub(crate) fn new(source: SourcePosition, modal: ModalState) -> Self {
        Self {
            source,
            modal,
            before: VecDeque::new(),
            motion: PlannedMotion::None,
            is_uncompensated: false,
            after: None,
            flow: Flow::Next,
            is_stop: true,
            holds_at_move_end: false,
            writes: ParameterWrites::default(),
        }
    }

    /// Queues an action that begins in the same tick as the tool change of the block: the
    /// strobes of M, S and T rise together, and one FIN answers all of them (manual PLC-II
    /// 8.1).
    pub(crate) fn queue_with_tool(&mut self, action: Action) {
        let is_tool = |action: &Action| matches!(action, Action::Tool { .. });
        let tool = self.before.iter().position(is_tool);
        self.before
            .insert(tool.unwrap_or(self.before.len()), action);
    }

    /// Marks the tool change as the last action, if no motion, dwell or stop of its block
    /// follows.
    pub(crate) fn mark_last_tool(&mut self) {
        let is_last_action = matches!(self.motion, PlannedMotion::None) && self.after.is_none();
        for action in &mut self.before {
            if let Action::Tool { is_last, .. } = action {
                *is_last = is_last_action;
            }
        }
    }

    /// Plans the end of a G70 block: the rapid from the profile back to the start of the G70.
    pub(crate) fn return_from_profile(finishing: &Finishing, state: &mut State) -> Self {
        state.set_machine_position(state.to_machine(finishing.start));
        let mut plan = Self::new(finishing.source, state.modal);
        plan.motion = PlannedMotion::Single(Action::Rapid {
            to: FrameShift::from_state(state).to_machine(finishing.start),
        });
        plan.is_uncompensated = true;
        plan.flow = Flow::Jump(finishing.return_position);
        plan
    }

    /// The explanation data of the cycle move taken last; `None` if the block has no cycle.
    pub(crate) fn pass_note(&self) -> Option<PassNote> {
        match &self.motion {
            PlannedMotion::Cycle(cycle) => cycle.pass_note(),
            PlannedMotion::Box(cycle) => cycle.pass_note(),
            _ => None,
        }
    }

    /// Whether every command of the block is taken.
    pub(crate) fn is_done(&self) -> bool {
        self.before.is_empty() && self.motion.is_done() && self.after.is_none()
    }

    /// Takes the next command of the block; `None` if all are taken.
    #[inline]
    pub(crate) fn take_command(&mut self) -> Option<ControlCommand> {
        let planned = match self.before.pop_front() {
            Some(action) => PlannedAction::without_stop(action),
            None => match self.motion.next_action() {
                Some(emission) => emission,
                None => PlannedAction::without_stop(self.after.take()?),
            },
        };
        let block_end = self.is_done();
        Some(ControlCommand {
            source: self.source,
            action: planned.action,
            modal: self.modal,
            block_end,
            stop_point: planned.is_stop || (block_end && self.is_stop),
            defers_feed_hold: self.holds_at_move_end,
            programmed_x: None,
        })
    }
}
