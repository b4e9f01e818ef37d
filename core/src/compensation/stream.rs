//! The stream of commands through compensation C.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use super::fault::Fault;
use super::interference::Trails;
use super::moves::{Held, Moving, Spare, Stand, cuts, destination, piece, side};
use super::nose::Nose;
use super::piece::are_same;
use crate::alarm::Alarm;
use crate::command::{Action, Command, Frame};
use crate::units::Point;

/// Blocks without motion after which an open move ends perpendicular to itself.
const IDLE_BLOCKS: u8 = 2;

/// Context of a command, supplied by the interpreter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Origin {
    /// Whether the block moves along a contour (G00 to G03). Other motion (cycles, threads,
    /// G28) runs without compensation.
    pub(crate) contour: bool,
    /// The active nose.
    pub(crate) nose: Nose,
    /// 003.4: a T word shifts the coordinates instead of moving the tool.
    pub(crate) offset_by_shift: bool,
}

/// The compensation between the interpreter and the executor of the commands.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Compensation {
    pub(super) on: bool,
    /// Programmed end of the last command, machine coordinates without the tool offset, mm.
    pub(super) machine: Point,
    #[serde(rename = "at")]
    at: Point,
    offset: Point,
    #[serde(rename = "stand")]
    pub(super) stand: Stand,
    /// Boxed: it is passed on more often than it is read.
    #[serde(rename = "moving")]
    pub(super) moving: Option<Box<Moving>>,
    #[serde(skip)]
    pub(super) spare: Spare,
    /// The compensated moves before the open one, while the corners between them were
    /// regular.
    #[serde(rename = "before")]
    pub(super) before: Trails,
    pub(super) held: VecDeque<Held>,
    pub(super) ready: VecDeque<Command>,
    pub(super) fault: Option<Alarm>,
    /// Blocks without motion since the open move.
    pub(super) idle: u8,
    /// The current block has moved.
    moved: bool,
}

impl Compensation {
    /// Whether offset mode is active: from the start-up move to the move that cancels.
    pub(crate) const fn is_on(&self) -> bool {
        self.on
    }

    /// Whether commands were accepted that have not been released.
    pub(crate) fn holds(&self) -> bool {
        self.moving.is_some() || !self.ready.is_empty()
    }

    /// Returns the next command, or the alarm at which the run ends.
    pub(crate) fn take(&mut self) -> Option<Result<Command, Alarm>> {
        match self.ready.pop_front() {
            Some(command) => Some(Ok(command)),
            None => self.fault.clone().map(Err),
        }
    }

    /// Whether the compensation has raised an alarm.
    pub(crate) const fn has_failed(&self) -> bool {
        self.fault.is_some()
    }

    /// Drops the vector without motion: at RESET and at the start of a run.
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Sets the machine position of the tool before a block, while the compensation is off.
    pub(crate) fn stand_at(&mut self, machine: Point, frame: Frame) {
        self.machine = machine;
        self.offset = frame.offset;
        self.at = machine - frame.offset;
    }

    /// Accepts the next command of the program.
    pub(crate) fn push(&mut self, command: Command, origin: Origin) {
        if self.fault.is_some() {
            return;
        }
        let block_end = command.block_end;
        match destination(&command.action, self.machine) {
            Some(to) if origin.contour && cuts(&command.action) => {
                self.contour(command, to, origin.nose);
            }
            Some(to) => self.foreign(command, to),
            None => self.without_motion(command, origin),
        }
        if block_end {
            self.block_end();
        }
    }

    /// Ends the open move perpendicular to itself: no block may be read before all commands
    /// have been executed.
    pub(crate) fn flush(&mut self) {
        if let Some(moving) = self.moving.take() {
            self.end_square(moving);
        }
    }

    /// The block after the open move has wrong data: the open move is not started.
    pub(crate) fn refuse(&mut self, alarm: Alarm) {
        if let Some(moving) = self.moving.take() {
            let vectors = self.stand.vectors;
            self.corner_moves(&moving, &vectors);
        }
        self.held.clear();
        self.fault = Some(alarm);
    }

    /// Moves the vectors along after the tool was moved while the run was stopped. Returns
    /// the displacement, mm.
    pub(crate) fn displace(&mut self, machine: Point) -> Point {
        let tip = self.stand.tip();
        if are_same(tip, machine) {
            return Point::default();
        }
        let by = machine - tip;
        self.stand.base = self.stand.base + by;
        let Some(moving) = &mut self.moving else {
            self.machine = self.machine + by;
            self.at = self.at + by;
            return by;
        };
        let start = moving.piece.start + by;
        match piece(
            &moving.command.action,
            start,
            moving.piece.end,
            moving.offset,
        ) {
            Ok(piece) => moving.piece = piece,
            Err(fault) => {
                let alarm = fault.alarm().at(moving.command.source);
                self.moving = None;
                self.refuse(alarm);
            }
        }
        by
    }

    fn block_end(&mut self) {
        let moved = core::mem::take(&mut self.moved);
        if moved || self.moving.is_none() {
            return;
        }
        self.idle += 1;
        if self.idle >= IDLE_BLOCKS {
            self.flush();
        }
    }

    fn queue(&mut self, command: Command) {
        if self.moving.is_some() {
            self.held.push_back(Held::Plain(command));
        } else {
            self.ready.push_back(command);
        }
    }

    /// Passes on motion that is not compensated. The vector is cancelled before it and
    /// returns with the next move along the contour.
    fn foreign(&mut self, command: Command, to: Point) {
        self.end_on_point();
        self.moved = true;
        self.machine = to;
        self.at = to - self.offset;
        self.stand = Stand::on_point(to);
        self.ready.push_back(command);
    }

    fn without_motion(&mut self, command: Command, origin: Origin) {
        let Action::Frame {
            frame,
            program_zero,
            ..
        } = &command.action
        else {
            return self.queue(command);
        };
        let travels = origin.contour && !origin.offset_by_shift;
        self.offset = frame.offset;
        if !travels {
            self.at = self.machine - frame.offset;
        }
        if program_zero.is_some() {
            self.end_on_point();
        }
        self.queue(command);
    }

    /// Accepts a move along the contour.
    fn contour(&mut self, command: Command, to: Point, nose: Nose) {
        let (start, end) = (self.at, to - self.offset);
        let from = core::mem::replace(&mut self.machine, to);
        self.at = end;
        let side = side(&command.modal);
        let arc = matches!(command.action, Action::Arc { .. });
        let rests = !arc && are_same(start, end);
        if !self.on && (rests || side == 0.0 || command.modal.offset == 0) {
            self.moved = true;
            return self.ready.push_back(command);
        }
        if self.on && rests && side != 0.0 && !are_same(from, to) {
            return self.travel(command, to - from);
        }
        self.moved = true;
        if !self.on && arc {
            return self.stop_before(Fault::StartOnArc, command.source);
        }
        if self.on && side == 0.0 && (arc || rests) {
            return match arc {
                true => self.stop_before(Fault::CancelOnArc, command.source),
                false => self.cancel(command, from.x, None),
            };
        }
        let piece = match piece(&command.action, start, end, self.offset) {
            Ok(piece) => piece,
            Err(fault) if fault.of_two_moves() => {
                return self.stop_at_corner(fault, command.source);
            }
            Err(fault) => return self.stop_before(fault, command.source),
        };
        if self.on && side == 0.0 {
            return self.cancel(command, from.x, Some(&piece));
        }
        let starts = !self.on;
        if starts {
            self.stand = Stand::on_point(from);
        }
        self.on = true;
        let next = Moving {
            command,
            piece,
            side,
            nose,
            offset: self.offset,
            starts,
            from_point: false,
            square_start: false,
        };
        let next = self.spare.filled(next);
        self.next_move(next);
    }
}
