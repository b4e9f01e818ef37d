//! Moves within the compensation, and their conversion to commands.

use serde::{Deserialize, Serialize};

use super::corner::Vectors;
use super::fault::Fault;
use super::interference::Way;
use super::nose::Nose;
use super::piece::{Piece, too_short};
use super::rounded;
use crate::command::{Action, Command, Modal, ProgrammedX, Source};
use crate::units::{Feed, Point};

/// The position of the tip once all released commands have run, and the vectors of that
/// corner that are still ahead.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Stand {
    /// Machine point that the vectors are relative to, mm: the programmed point plus the
    /// displacement from the nose centre to the tip.
    pub(super) base: Point,
    /// The tip has reached the first vector.
    pub(super) vectors: Vectors,
    /// Nose radius for which the vectors were computed, mm.
    pub(super) radius: f64,
    /// The vector is cancelled: the tip is on the programmed point.
    pub(super) cancelled: bool,
}

impl Stand {
    pub(super) fn on_point(machine: Point) -> Self {
        Self {
            base: machine,
            vectors: Vectors::of(&[Point::default()]),
            radius: 0.0,
            cancelled: true,
        }
    }

    /// Machine position of the tip, mm.
    pub(super) fn tip(&self) -> Point {
        let tip = self.base + self.vectors.first();
        if self.cancelled { tip } else { rounded(tip) }
    }
}

/// A compensated move whose end is not known yet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Moving {
    pub(super) command: Command,
    pub(super) piece: Piece,
    /// +1 left (G41), -1 right (G42).
    pub(super) side: f64,
    pub(super) nose: Nose,
    /// Tool offset at the end of the move, mm.
    pub(super) offset: Point,
    /// The move starts the compensation.
    pub(super) starts: bool,
    /// The move begins on a cancelled vector.
    pub(super) from_point: bool,
    /// The move begins on the vector that ended the move before, perpendicular to that move.
    pub(super) square_start: bool,
}

impl Moving {
    pub(super) fn rho(&self) -> f64 {
        self.side * self.nose.radius
    }

    /// The machine point that the vectors at the end of the move are relative to.
    pub(super) fn base(&self) -> Point {
        self.piece.end + self.offset + self.nose.tip()
    }

    /// The command of the move with another action: a straight line, or an arc about the
    /// centre of the programmed one.
    pub(super) fn give_out(&self, action: Action) -> Command {
        let programmed_x = || Box::new(self.programmed_x(&action));
        Command {
            programmed_x: self.command.modal.surface_speed.then(programmed_x),
            action,
            source: self.command.source,
            modal: self.command.modal,
            block_end: self.command.block_end,
            stop_point: self.command.stop_point,
            whole: self.command.whole,
        }
    }

    /// The programmed X while the tip executes `action`.
    fn programmed_x(&self, action: &Action) -> ProgrammedX {
        let to = self.piece.end.x + self.offset.x;
        let from = self.piece.start.x + self.offset.x;
        match (action, &self.piece.circle) {
            (
                Action::Arc {
                    to: tip, center, ..
                },
                Some(circle),
            ) => ProgrammedX::Round {
                tip_center: center.x,
                center: circle.center.x + self.offset.x,
                ratio: circle.radius / (*tip - *center).length(),
                to,
            },
            _ => ProgrammedX::Even { from, to },
        }
    }

    /// A corner move at the start of this block. The programmed point does not move.
    pub(super) fn corner_command(&self, to: Point) -> Command {
        let stands = self.piece.start.x + self.offset.x;
        corner_move(&self.command, to, stands)
    }
}

/// The box of a released move, reused for the next one, so that no block allocates. Its
/// content has no meaning.
#[derive(Clone, Debug, Default)]
pub(super) struct Spare(Option<Box<Moving>>);

impl PartialEq for Spare {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Spare {
    pub(super) const fn of(done: Box<Moving>) -> Self {
        Self(Some(done))
    }

    /// Returns a box that holds `moving`.
    pub(super) fn filled(&mut self, moving: Moving) -> Box<Moving> {
        match self.0.take() {
            Some(mut spare) => {
                *spare = moving;
                spare
            }
            None => Box::new(moving),
        }
    }
}

/// The move that determines the end of the open one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Next<'a> {
    pub(super) source: Source,
    /// A compensated move, and the distance of the nose centre to its left, mm.
    pub(super) surface: Option<(&'a Piece, f64)>,
}

/// The way in which an open move ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End<'a> {
    Vectors(&'a Vectors),
    /// On the programmed point.
    Cancelled,
}

/// A command that waits after the open move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum Held {
    Plain(Command),
    /// The tool moves by the change of its offset, mm; the programmed point does not move.
    Travel(Command, Point),
}

/// +1 for G41, -1 for G42, 0 for G40.
pub(super) fn side(modal: &Modal) -> f64 {
    match modal.nose_compensation {
        41 => 1.0,
        42 => -1.0,
        _ => 0.0,
    }
}

/// Whether the action is a move of G00 to G03.
pub(super) const fn cuts(action: &Action) -> bool {
    matches!(
        action,
        Action::Rapid { .. } | Action::Line { .. } | Action::Arc { .. }
    )
}

/// The end point of an action that starts at `from`; `None` without motion.
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

/// The geometry of a move without the tool offset.
pub(super) fn piece(
    action: &Action,
    start: Point,
    end: Point,
    offset: Point,
) -> Result<Piece, Fault> {
    match action {
        Action::Arc {
            center, clockwise, ..
        } => Piece::arc(start, end, *center - offset, *clockwise),
        _ => Piece::line(start, end),
    }
}

/// A straight move to the target of the tip: a rapid, or at the feed of the block.
pub(super) fn straight_action(action: &Action, to: Point) -> Action {
    match feed(action) {
        Some(feed) => Action::Line { to, feed },
        None => Action::Rapid { to },
    }
}

pub(super) const fn feed(action: &Action) -> Option<Feed> {
    match action {
        Action::Line { feed, .. } | Action::Arc { feed, .. } => Some(*feed),
        _ => None,
    }
}

/// A corner move at the start of the block after the corner. The programmed X remains at
/// `stands`, mm.
pub(super) fn corner_move(command: &Command, to: Point, stands: f64) -> Command {
    with_programmed_x(
        Command {
            action: straight_action(&command.action, to),
            block_end: false,
            stop_point: false,
            ..command.clone()
        },
        || ProgrammedX::Even {
            from: stands,
            to: stands,
        },
    )
}

/// Under G96 a command carries the programmed X, which determines the spindle speed.
pub(super) fn with_programmed_x(mut command: Command, x: impl FnOnce() -> ProgrammedX) -> Command {
    command.programmed_x = command.modal.surface_speed.then(|| Box::new(x()));
    command
}

/// The arc of the tip: that of the nose centre, displaced. `None` for a line, and for an arc
/// that is too short to run.
pub(super) fn shifted_arc(moving: &Moving, way: &Way, to: Point) -> Option<Action> {
    let piece = &moving.piece;
    let circle = piece.circle.as_ref()?;
    let p = piece.start + way.start.last();
    let q = piece.end + way.end.first();
    if too_short(piece, circle, p, q) {
        return None;
    }
    Some(Action::Arc {
        to,
        center: circle.center + moving.offset + moving.nose.tip(),
        clockwise: circle.turn < 0.0,
        feed: feed(&moving.command.action)?,
    })
}
