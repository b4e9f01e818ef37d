//! Moves on their way through the compensation, and the commands they become.

use serde::{Deserialize, Serialize};

use super::corner::Vectors;
use super::fault::Fault;
use super::interference::Way;
use super::nose::Nose;
use super::piece::{Piece, too_short};
use super::rounded;
use crate::command::{Action, Command, Modal, ProgrammedX, Source};
use crate::units::{Feed, Point};

/// Where the tip stands, or will when what was given out is done, and which
/// vectors of that corner are still ahead.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Stand {
    /// Machine point from which the vectors count: the programmed one plus the
    /// way from the centre to the tip.
    pub(super) base: Point,
    /// The first one is reached.
    pub(super) vectors: Vectors,
    /// Radius that made the vectors.
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

    /// The tip.
    pub(super) fn tip(&self) -> Point {
        let tip = self.base + self.vectors.first();
        if self.cancelled { tip } else { rounded(tip) }
    }
}

/// A compensated move whose end is still open.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Moving {
    pub(super) command: Command,
    pub(super) piece: Piece,
    /// +1 left (G41), -1 right (G42).
    pub(super) side: f64,
    pub(super) nose: Nose,
    /// Tool offset at its end.
    pub(super) offset: Point,
    /// It is the first one.
    pub(super) starts: bool,
    /// It begins on a cancelled vector.
    pub(super) from_point: bool,
    /// It begins on the vector that ended the move before, square to that.
    pub(super) square_start: bool,
}

impl Moving {
    pub(super) fn rho(&self) -> f64 {
        self.side * self.nose.radius
    }

    /// The machine point that vectors at its end count from.
    pub(super) fn base(&self) -> Point {
        self.piece.end + self.offset + self.nose.tip()
    }

    /// Its command with another action: straight, or an arc about the centre of
    /// its own.
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

    /// The programmed X while the tip makes this of it.
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

    /// A corner move at its head, on which the programmed point stands.
    pub(super) fn corner_command(&self, to: Point) -> Command {
        let stands = self.piece.start.x + self.offset.x;
        corner_move(&self.command, to, stands)
    }
}

/// The box of a move that was given out, for the next one: nothing is allocated a block.
/// It holds nothing that counts, whatever is left in it.
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

    /// A box with a move in it.
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

/// The move that gives an open one its end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Next<'a> {
    pub(super) source: Source,
    /// A compensated move, and how far on its left the nose runs.
    pub(super) surface: Option<(&'a Piece, f64)>,
}

/// How an open move ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End<'a> {
    Vectors(&'a Vectors),
    /// On the programmed point.
    Cancelled,
}

/// A command after the open move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum Held {
    Plain(Command),
    /// The tool travels a change of its offset, this far; the programmed point
    /// stays.
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

/// Whether it is a move of G00 to G03.
pub(super) const fn cuts(action: &Action) -> bool {
    matches!(
        action,
        Action::Rapid { .. } | Action::Line { .. } | Action::Arc { .. }
    )
}

/// Where an action takes the axes that stand at `from`.
pub(super) fn destination(action: &Action, from: Point) -> Option<Point> {
    match action {
        Action::Rapid { to }
        | Action::Line { to, .. }
        | Action::Arc { to, .. }
        | Action::Thread { to, .. } => Some(*to),
        // It comes back.
        Action::Tap { .. } => Some(from),
        _ => None,
    }
}

/// A move as geometry, without the tool offset.
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

/// A straight move to the tip's target, as rapid or at the feed of its block.
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

/// A corner move: at the head of the block that follows the corner, while the
/// programmed X stands.
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

/// Under G96 a command tells the programmed X, which the speed follows.
pub(super) fn with_programmed_x(mut command: Command, x: impl FnOnce() -> ProgrammedX) -> Command {
    command.programmed_x = command.modal.surface_speed.then(|| Box::new(x()));
    command
}

/// The arc of the tip: that of the nose centre, moved. `None` for a line, and
/// for an arc of which too little is left.
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
