//! Data of the moves that the compensation processes, and the commands that it makes from them.

use serde::{Deserialize, Serialize};

use super::corner::CornerVectors;
use super::fault::CompensationFault;
use super::interference::EndVectors;
use super::nose::Nose;
use super::round_to_increment;
use super::segment::{ContourSegment, is_too_short};
use crate::command::{Action, ControlCommand, ModalState, ProgrammedX, SourcePosition};
use crate::units::{Feed, Point};

/// The position of the tip after all released commands, with the vectors of that corner that
/// the tip has not reached yet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct TipState {
    /// Machine point that the vectors are relative to, mm: the programmed point plus the
    /// displacement from the nose centre to the tip.
    pub(super) base: Point,
    /// Vectors of the corner at which the tool is; the tip has reached the first of them.
    pub(super) vectors: CornerVectors,
    /// Nose radius for which the vectors were computed, mm.
    pub(super) radius: f64,
    /// Whether the vector is cancelled: the tip is on the programmed point.
    pub(super) cancelled: bool,
}

impl TipState {
    pub(super) fn at_programmed_point(machine: Point) -> Self {
        Self {
            base: machine,
            vectors: CornerVectors::from_points(&[Point::default()]),
            radius: 0.0,
            cancelled: true,
        }
    }

    /// Returns the machine position of the tip, mm.
    pub(super) fn tip(&self) -> Point {
        let tip = self.base + self.vectors.first();
        if self.cancelled {
            tip
        } else {
            round_to_increment(tip)
        }
    }
}

/// The open move: a compensated move whose end is unknown until the next move is read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct OpenMove {
    pub(super) command: ControlCommand,
    pub(super) piece: ContourSegment,
    /// Side of the nose: +1 left (G41), -1 right (G42).
    pub(super) side: f64,
    pub(super) nose: Nose,
    /// Tool offset at the end of the move, mm.
    pub(super) offset: Point,
    /// Whether the move starts the compensation.
    pub(super) starts: bool,
    /// Whether the move begins on the programmed point, where the vector was cancelled.
    pub(super) from_point: bool,
    /// Whether the move begins on the end vector of the move before, perpendicular to that
    /// move.
    pub(super) square_start: bool,
}

impl OpenMove {
    pub(super) fn rho(&self) -> f64 {
        self.side * self.nose.radius
    }

    /// The machine point that the vectors at the end of the move are relative to, mm: its end
    /// plus the tool offset and the vector to the tip.
    pub(super) fn base(&self) -> Point {
        self.piece.end + self.offset + self.nose.tip_vector()
    }

    /// A copy of the command of the move whose action is `action`: a straight line, or an arc about
    /// the centre of the programmed one.
    pub(super) fn command_with(&self, action: Action) -> ControlCommand {
        let programmed_x = || Box::new(self.programmed_x(&action));
        ControlCommand {
            programmed_x: self.command.modal.surface_speed.then(programmed_x),
            action,
            source: self.command.source,
            modal: self.command.modal,
            block_end: self.command.block_end,
            stop_point: self.command.stop_point,
            defers_feed_hold: self.command.defers_feed_hold,
        }
    }

    /// Returns the change of the programmed X while the tip executes `action`.
    fn programmed_x(&self, action: &Action) -> ProgrammedX {
        let to = self.piece.end.x + self.offset.x;
        let from = self.piece.start.x + self.offset.x;
        match (action, &self.piece.circle) {
            (
                Action::Arc {
                    to: tip, center, ..
                },
                Some(circle),
            ) => ProgrammedX::Circular {
                tip_center: center.x,
                center: circle.center.x + self.offset.x,
                ratio: circle.radius / (*tip - *center).length(),
                to,
            },
            _ => ProgrammedX::Linear { from, to },
        }
    }

    /// The command for a straight move of the tip to `to`, mm, around the corner at the start of
    /// this block. The programmed point does not move.
    pub(super) fn corner_command(&self, to: Point) -> ControlCommand {
        let programmed_x = self.piece.start.x + self.offset.x;
        corner_move(&self.command, to, programmed_x)
    }
}

/// The box of a released move, reused for the next one so that no block allocates. The content
/// of the box has no meaning.
#[derive(Clone, Debug, Default)]
pub(super) struct SpareBox(Option<Box<OpenMove>>);

impl PartialEq for SpareBox {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl SpareBox {
    pub(super) const fn new(done: Box<OpenMove>) -> Self {
        Self(Some(done))
    }

    /// Stores `moving` in the spare box, or in a new one, and returns it.
    pub(super) fn box_move(&mut self, moving: OpenMove) -> Box<OpenMove> {
        match self.0.take() {
            Some(mut spare) => {
                *spare = moving;
                spare
            }
            None => Box::new(moving),
        }
    }
}

/// The move after the open one, which determines the end of the open one.
#[derive(Clone, Copy, Debug)]
pub(super) struct NextMove<'a> {
    pub(super) source: SourcePosition,
    /// The geometry of a compensated move, and the distance of the nose centre to its left, mm;
    /// `None` for a move that cancels the compensation.
    pub(super) surface: Option<(&'a ContourSegment, f64)>,
}

/// The end of the open move: vectors of its corner, or the programmed point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum MoveEnd<'a> {
    Vectors(&'a CornerVectors),
    /// The move cancels the compensation: the tool nose centre ends on the programmed point,
    /// without an offset vector.
    Cancelled,
}

/// A command that is released after the open move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum HeldCommand {
    Plain(ControlCommand),
    /// The command of a T word, and the vector by which the change of the offset moves the tool,
    /// mm. The programmed point does not move.
    Travel(ControlCommand, Point),
}

/// The sign of the side of the nose: +1 for G41 (left), -1 for G42 (right), 0 for G40.
pub(super) fn side_sign(modal: &ModalState) -> f64 {
    match modal.nose_compensation {
        41 => 1.0,
        42 => -1.0,
        _ => 0.0,
    }
}

/// Whether the action is a move of G00 to G03.
pub(super) const fn is_contour_move(action: &Action) -> bool {
    matches!(
        action,
        Action::Rapid { .. } | Action::Line { .. } | Action::Arc { .. }
    )
}

/// The end point of an action that starts at `from`, mm; `None` without motion.
pub(super) fn destination(action: &Action, from: Point) -> Option<Point> {
    match action {
        Action::Rapid { to }
        | Action::Line { to, .. }
        | Action::Arc { to, .. }
        | Action::Thread { to, .. } => Some(*to),
        // Tapping returns to its start.
        Action::Tap { .. } => Some(from),
        _ => None,
    }
}

/// The geometry of the move `action` from `start` to `end`, mm, from which the tool offset
/// `offset`, mm, is already subtracted.
///
/// # Errors
/// Start and end are the same point, or the centre of an arc does not fit its ends.
pub(super) fn action_segment(
    action: &Action,
    start: Point,
    end: Point,
    offset: Point,
) -> Result<ContourSegment, CompensationFault> {
    match action {
        Action::Arc {
            center, clockwise, ..
        } => ContourSegment::arc(start, end, *center - offset, *clockwise),
        _ => ContourSegment::line(start, end),
    }
}

/// A straight move of the tip to `to`, mm: a cut at the feed of `action`, or a rapid if `action`
/// has no feed.
pub(super) fn straight_action(action: &Action, to: Point) -> Action {
    match action_feed(action) {
        Some(feed) => Action::Line { to, feed },
        None => Action::Rapid { to },
    }
}

pub(super) const fn action_feed(action: &Action) -> Option<Feed> {
    match action {
        Action::Line { feed, .. } | Action::Arc { feed, .. } => Some(*feed),
        _ => None,
    }
}

/// A straight move of the tip to `to`, mm, around a corner, as part of the block `command`, which
/// follows the corner. The programmed X remains at `programmed_x`, mm.
pub(super) fn corner_move(
    command: &ControlCommand,
    to: Point,
    programmed_x: f64,
) -> ControlCommand {
    with_programmed_x(
        ControlCommand {
            action: straight_action(&command.action, to),
            block_end: false,
            stop_point: false,
            ..command.clone()
        },
        || ProgrammedX::Linear {
            from: programmed_x,
            to: programmed_x,
        },
    )
}

/// Adds the programmed X to a command if G96 is active: it determines the spindle speed.
pub(super) fn with_programmed_x(
    mut command: ControlCommand,
    x: impl FnOnce() -> ProgrammedX,
) -> ControlCommand {
    command.programmed_x = command.modal.surface_speed.then(|| Box::new(x()));
    command
}

/// The arc of the tip to `to`, mm, which equals that of the nose centre, displaced; `None` if the
/// move is a line or the arc is too short to run.
pub(super) fn shifted_arc(moving: &OpenMove, way: &EndVectors, to: Point) -> Option<Action> {
    let piece = &moving.piece;
    let circle = piece.circle.as_ref()?;
    let p = piece.start + way.start.last();
    let q = piece.end + way.end.first();
    if is_too_short(piece, circle, p, q) {
        return None;
    }
    Some(Action::Arc {
        to,
        center: circle.center + moving.offset + moving.nose.tip_vector(),
        clockwise: circle.turn < 0.0,
        feed: action_feed(&moving.command.action)?,
    })
}
