//! Accepts commands for compensation C and decides when each is released.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use super::fault::CompensationFault;
use super::interference::RecentPaths;
use super::nose::Nose;
use super::open_move::{
    HeldCommand, OpenMove, SpareBox, TipState, action_segment, destination, is_contour_move,
    side_sign,
};
use super::segment::are_same;
use super::settings::CompensationSettings;
use crate::alarm::Alarm;
use crate::command::{Action, ControlCommand, Frame};
use crate::units::Point;

/// Number of blocks without motion after which the open move ends perpendicular to itself.
const IDLE_BLOCKS: u8 = 2;

/// Data about a command that the interpreter passes to the compensation with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CommandContext {
    /// Whether the block moves along a contour (G00 to G03). Other motion (cycles, threads,
    /// G28) runs without compensation.
    pub(crate) contour: bool,
    /// The nose that is active for the command.
    pub(crate) nose: Nose,
    /// Parameter 003.4: whether a T word shifts the coordinates instead of moving the tool.
    pub(crate) offset_by_shift: bool,
}

/// Compensation C: converts the commands of the interpreter into commands for the tip.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct NoseCompensation {
    #[serde(skip)]
    pub(super) settings: CompensationSettings,
    pub(super) on: bool,
    /// Programmed end of the last command, machine coordinates without the tool offset, mm.
    pub(super) machine: Point,
    #[serde(rename = "at")]
    programmed_end: Point,
    offset: Point,
    #[serde(rename = "stand")]
    pub(super) tip_state: TipState,
    /// The move that waits for the next one; `None` without one. It is boxed because it is passed
    /// on more often than read.
    #[serde(rename = "moving")]
    pub(super) open_move: Option<Box<OpenMove>>,
    #[serde(skip)]
    pub(super) spare: SpareBox,
    /// Paths of the moves before the open one, for the interference check; emptied where the
    /// contour is interrupted.
    #[serde(rename = "before")]
    pub(super) recent_paths: RecentPaths,
    pub(super) held: VecDeque<HeldCommand>,
    pub(super) ready: VecDeque<ControlCommand>,
    pub(super) fault: Option<Alarm>,
    /// Number of blocks without motion after the open move.
    pub(super) idle: u8,
    /// Whether the current block has moved the tool.
    moved: bool,
}

impl NoseCompensation {
    /// Creates a compensation that is off, with the settings of the control.
    pub(super) fn with_settings(settings: CompensationSettings) -> Self {
        Self {
            settings,
            ..Self::default()
        }
    }

    /// Whether compensation is active: from the start-up move to the move that cancels it.
    pub(crate) const fn is_on(&self) -> bool {
        self.on
    }

    /// Whether an open move or a released command has not been taken yet.
    pub(crate) fn has_pending(&self) -> bool {
        self.open_move.is_some() || !self.ready.is_empty()
    }

    /// Removes the next released command, or returns the alarm at which the run ends; `None`
    /// until further commands are pushed.
    pub(crate) fn take(&mut self) -> Option<Result<ControlCommand, Alarm>> {
        match self.ready.pop_front() {
            Some(command) => Some(Ok(command)),
            None => self.fault.clone().map(Err),
        }
    }

    /// Whether the compensation has raised an alarm.
    pub(crate) const fn has_failed(&self) -> bool {
        self.fault.is_some()
    }

    /// Resets the compensation without motion: at RESET and at the start of a run.
    pub(crate) fn clear(&mut self) {
        *self = Self {
            settings: self.settings,
            ..Self::default()
        };
    }

    /// Sets the position of the tool before a block, machine coordinates, mm, and the coordinate
    /// frame with the tool offset. Call it only while the compensation is off.
    pub(crate) fn set_position(&mut self, machine: Point, frame: Frame) {
        self.machine = machine;
        self.offset = frame.offset;
        self.programmed_end = machine - frame.offset;
    }

    /// Accepts the next command of the program, which is released at once or after the open move.
    /// `origin` is its context.
    pub(crate) fn push(&mut self, command: ControlCommand, origin: CommandContext) {
        if self.fault.is_some() {
            return;
        }
        let block_end = command.block_end;
        match destination(&command.action, self.machine) {
            Some(to) if origin.contour && is_contour_move(&command.action) => {
                self.push_contour_move(command, to, origin.nose);
            }
            Some(to) => self.push_uncompensated(command, to),
            None => self.push_without_motion(command, origin),
        }
        if block_end {
            self.end_block();
        }
    }

    /// Releases the open move with a vector perpendicular to its end. Called where no block may be
    /// read before all commands have been executed.
    pub(crate) fn flush(&mut self) {
        if let Some(moving) = self.open_move.take() {
            self.end_perpendicular(moving);
        }
    }

    /// Drops the open move, which still waits for the next one, and stores `alarm`: the next
    /// block has wrong data.
    pub(crate) fn refuse(&mut self, alarm: Alarm) {
        if let Some(moving) = self.open_move.take() {
            let vectors = self.tip_state.vectors;
            self.push_corner_moves(&moving, &vectors);
        }
        self.held.clear();
        self.fault = Some(alarm);
    }

    /// Moves the start of the open move and its vectors to the position `machine`, mm, to
    /// which the operator moved the tool during a stop. Returns the displacement, mm.
    pub(crate) fn displace(&mut self, machine: Point) -> Point {
        let tip = self.tip_state.tip();
        if are_same(tip, machine) {
            return Point::default();
        }
        let by = machine - tip;
        self.tip_state.base = self.tip_state.base + by;
        let Some(moving) = &mut self.open_move else {
            self.machine = self.machine + by;
            self.programmed_end = self.programmed_end + by;
            return by;
        };
        let start = moving.piece.start + by;
        match action_segment(
            &moving.command.action,
            start,
            moving.piece.end,
            moving.offset,
        ) {
            Ok(piece) => moving.piece = piece,
            Err(fault) => {
                let alarm = fault.alarm().with_source(moving.command.source);
                self.open_move = None;
                self.refuse(alarm);
            }
        }
        by
    }

    fn end_block(&mut self) {
        let moved = core::mem::take(&mut self.moved);
        if moved || self.open_move.is_none() {
            return;
        }
        self.idle += 1;
        if self.idle >= IDLE_BLOCKS {
            self.flush();
        }
    }

    fn enqueue(&mut self, command: ControlCommand) {
        if self.open_move.is_some() {
            self.held.push_back(HeldCommand::Plain(command));
        } else {
            self.ready.push_back(command);
        }
    }

    /// Releases the open move so that it ends on its programmed point, then a motion to `to`,
    /// machine coordinates, mm, that is not compensated. The next move along the contour is
    /// compensated again.
    fn push_uncompensated(&mut self, command: ControlCommand, to: Point) {
        self.end_at_programmed_point();
        self.moved = true;
        self.machine = to;
        self.programmed_end = to - self.offset;
        self.tip_state = TipState::at_programmed_point(to);
        self.ready.push_back(command);
    }

    fn push_without_motion(&mut self, command: ControlCommand, origin: CommandContext) {
        let Action::Frame {
            frame,
            program_zero,
            ..
        } = &command.action
        else {
            return self.enqueue(command);
        };
        let travels = origin.contour && !origin.offset_by_shift;
        self.offset = frame.offset;
        if !travels {
            self.programmed_end = self.machine - frame.offset;
        }
        if program_zero.is_some() {
            self.end_at_programmed_point();
        }
        self.enqueue(command);
    }

    /// Accepts a move of G00 to G03 to the programmed point `to`, machine coordinates, mm.
    fn push_contour_move(&mut self, command: ControlCommand, to: Point, nose: Nose) {
        let (start, end) = (self.programmed_end, to - self.offset);
        let from = core::mem::replace(&mut self.machine, to);
        self.programmed_end = end;
        let side = side_sign(&command.modal);
        let arc = matches!(command.action, Action::Arc { .. });
        let is_at_end = !arc && are_same(start, end);
        if !self.on && (is_at_end || side == 0.0 || command.modal.offset == 0) {
            self.moved = true;
            return self.ready.push_back(command);
        }
        if self.on && is_at_end && side != 0.0 && !are_same(from, to) {
            return self.shift_tool(command, to - from);
        }
        self.moved = true;
        if !self.on && arc {
            return self.fail_before(CompensationFault::StartOnArc, command.source);
        }
        if self.on && side == 0.0 && (arc || is_at_end) {
            return match arc {
                true => self.fail_before(CompensationFault::CancelOnArc, command.source),
                false => self.cancel(command, from.x, None),
            };
        }
        let piece = match action_segment(&command.action, start, end, self.offset) {
            Ok(piece) => piece,
            Err(fault) if fault.is_between_moves() => {
                return self.fail_at_corner(fault, command.source);
            }
            Err(fault) => return self.fail_before(fault, command.source),
        };
        if self.on && side == 0.0 {
            return self.cancel(command, from.x, Some(&piece));
        }
        let starts = !self.on;
        if starts {
            self.tip_state = TipState::at_programmed_point(from);
        }
        self.on = true;
        let next = OpenMove {
            command,
            piece,
            side,
            nose,
            offset: self.offset,
            starts,
            from_point: false,
            square_start: false,
        };
        let next = self.spare.box_move(next);
        self.open_next_move(next);
    }
}
