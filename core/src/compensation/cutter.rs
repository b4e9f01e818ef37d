//! The same compensation for the cutter of a mill: its centre is what a program names, so
//! that there is no imaginary tip. Moves come in as they lie in the plane of G17 to G19;
//! what else they are, their blocks among it, is kept by whoever pushes them, under a
//! number.

use super::{Compensation, Nose, Origin};
use crate::alarm::Alarm;
use crate::command::{Action, Command, Frame, Modal, ProgramId, Source};
use crate::units::{Feed, Point};

/// A move in the plane. Of its points `z` lies along the first axis of the plane and `x`
/// along the second, mm: seen so, clockwise is clockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatMove {
    /// The number under which the rest of it is kept.
    pub number: u32,
    /// The line that alarms name.
    pub line: u32,
    /// End point.
    pub to: Point,
    /// Its path.
    pub shape: FlatShape,
}

/// The path of a move in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FlatShape {
    /// To a point, not at a feed.
    Rapid,
    /// A straight cut.
    Line,
    /// A round cut.
    Arc {
        /// Centre.
        center: Point,
        /// Its sense.
        clockwise: bool,
    },
}

/// On which side of the contour the cutter runs, seen along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// G40.
    On,
    /// G41.
    Left,
    /// G42.
    Right,
}

/// What comes out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Compensated {
    /// A move of the centre. A corner may make several of the move that follows it; only
    /// the last of them is the move itself.
    Move {
        /// The move.
        flat: FlatMove,
        /// Whether it is the last one.
        last: bool,
    },
    /// What was pushed without motion in the plane.
    Other(u32),
}

/// Moves of a program in, moves of the centre of the cutter out.
#[derive(Clone, Debug, Default)]
pub struct CutterCompensation {
    stream: Compensation,
}

impl CutterCompensation {
    /// From the move that starts it to the one that cancels it.
    pub const fn is_on(&self) -> bool {
        self.stream.is_on()
    }

    /// Where the centre stands before the first move.
    pub fn stand_at(&mut self, point: Point) {
        self.stream.stand_at(point, Frame::default());
    }

    /// Takes a move of a block with the side that is in force and the radius of the cutter,
    /// mm.
    pub fn push(&mut self, flat: FlatMove, side: Side, radius: f64) {
        let feed = Feed::PerMinute(1.0);
        let action = match flat.shape {
            FlatShape::Rapid => Action::Rapid { to: flat.to },
            FlatShape::Line => Action::Line { to: flat.to, feed },
            FlatShape::Arc { center, clockwise } => Action::Arc {
                to: flat.to,
                center,
                clockwise,
                feed,
            },
        };
        let nose = Nose {
            radius,
            direction: 0,
        };
        self.give((flat.number, flat.line), action, side, nose, true);
    }

    /// Takes a block without motion in the plane.
    pub fn push_other(&mut self, number: u32, side: Side) {
        let nose = Nose::default();
        self.give((number, 0), Action::Nothing, side, nose, true);
    }

    /// Takes motion that is not compensated, and ends here.
    pub fn push_uncompensated(&mut self, number: u32, to: Point, side: Side) {
        let nose = Nose::default();
        self.give((number, 0), Action::Rapid { to }, side, nose, false);
    }

    fn give(
        &mut self,
        (number, line): (u32, u32),
        action: Action,
        side: Side,
        nose: Nose,
        contour: bool,
    ) {
        let command = Command {
            source: Source {
                program: ProgramId::External,
                line,
                // Here it is the number of the move.
                sequence: Some(number.into()),
            },
            action,
            modal: Modal {
                nose_compensation: match side {
                    Side::On => 40,
                    Side::Left => 41,
                    Side::Right => 42,
                },
                // Some number: that it is 0 is known to whoever pushes.
                offset: 1,
                ..Modal::default()
            },
            block_end: true,
            stop_point: true,
            whole: false,
            programmed_x: None,
        };
        let origin = Origin {
            contour,
            nose,
            offset_by_shift: false,
        };
        self.stream.push(command, origin);
        // Contours of a mill are closed: their end may run through their begin.
        self.stream.before.keep_last();
    }

    /// Nothing more comes: the open move ends square to itself.
    pub fn flush(&mut self) {
        self.stream.flush();
    }

    /// What is ready.
    ///
    /// # Errors
    /// Alarms of compensation; the sequence number of their source is the number of the
    /// move.
    pub fn take(&mut self) -> Option<Result<Compensated, Alarm>> {
        let command = match self.stream.take()? {
            Ok(command) => command,
            Err(alarm) => return Some(Err(alarm)),
        };
        let number = command.source.sequence.map_or(0, u32::from);
        let line = command.source.line;
        let (to, shape) = match command.action {
            Action::Rapid { to } => (to, FlatShape::Rapid),
            Action::Line { to, .. } => (to, FlatShape::Line),
            Action::Arc {
                to,
                center,
                clockwise,
                ..
            } => (to, FlatShape::Arc { center, clockwise }),
            _ => return Some(Ok(Compensated::Other(number))),
        };
        let flat = FlatMove {
            number,
            line,
            to,
            shape,
        };
        let last = command.block_end;
        Some(Ok(Compensated::Move { flat, last }))
    }
}
