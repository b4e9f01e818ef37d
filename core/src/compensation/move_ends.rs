//! Ends open moves: computes the vectors of the corner, checks them, and releases the commands.

use super::corner::{self, CornerRole, CornerVectors};
use super::fault::CompensationFault;
use super::interference::{self, EndVectors};
use super::open_move::{
    HeldCommand, MoveEnd, NextMove, OpenMove, SpareBox, TipState, corner_move, destination,
    shifted_arc, straight_action, with_programmed_x,
};
use super::segment::{ContourSegment, are_same};
use super::stream::NoseCompensation;
use crate::alarm::Alarm;
use crate::command::{ControlCommand, ProgrammedX, SourcePosition};
use crate::units::Point;

impl NoseCompensation {
    /// Releases the open move, whose end follows from `next`, and stores `next` as the open
    /// move.
    pub(super) fn open_next_move(&mut self, mut next: Box<OpenMove>) {
        let source = next.command.source;
        if let Some(moving) = self.open_move.take() {
            // The side cannot change immediately after the start-up.
            if moving.starts {
                next.side = moving.side;
            }
            let role = if moving.starts {
                CornerRole::StartUp
            } else {
                CornerRole::Both
            };
            let (rho, next_rho) = (moving.rho(), next.side * moving.nose.radius);
            match self.corner(&moving.piece, rho, &next.piece, next_rho, role) {
                Ok(vectors) => {
                    let surface = Some((&next.piece, next_rho));
                    let next = Some(NextMove { source, surface });
                    self.end_move(moving, MoveEnd::Vectors(&vectors), next);
                }
                Err(fault) => {
                    self.refuse_move(&moving, fault.corner_alarm(moving.command.source, source));
                }
            }
        } else {
            self.begin_from_tip(&mut next);
        }
        if self.fault.is_none() {
            self.idle = 0;
            self.open_move = Some(next);
        }
    }

    /// Prepares the move `next`, which follows no open move: it begins at the current position of
    /// the tip. Before an arc the nose first moves onto the path parallel to the arc.
    fn begin_from_tip(&mut self, next: &mut OpenMove) {
        let mut radius = self.tip_state.radius;
        if self.tip_state.cancelled {
            radius = next.nose.radius;
            let tip = next.nose.tip_vector();
            self.tip_state = TipState {
                base: self.tip_state.base + tip,
                vectors: CornerVectors::from_points(&[-tip]),
                radius,
                cancelled: true,
            };
            next.from_point = true;
        }
        next.square_start = !next.from_point;
        let Some(circle) = &next.piece.circle else {
            return;
        };
        let rho = next.side * radius;
        if let Err(fault) = circle.check_radius(rho) {
            return self.fail_before(fault, next.command.source);
        }
        let vector = self.tip_state.vectors.first();
        let square = corner::perpendicular_at_start(&next.piece, rho);
        if !are_same(vector, square) {
            self.tip_state.vectors = CornerVectors::from_points(&[vector, square]);
        }
    }

    /// Releases the open move, then `command`, which cancels the compensation; its motion starts at
    /// the programmed X `from_x`, mm. `piece` is its geometry; `None` if it has no motion.
    pub(super) fn cancel(
        &mut self,
        command: ControlCommand,
        from_x: f64,
        piece: Option<&ContourSegment>,
    ) {
        let moving = self.open_move.take();
        match (moving, piece) {
            (Some(moving), Some(piece)) => {
                let role = if moving.starts {
                    CornerRole::StartUp
                } else {
                    CornerRole::Cancel
                };
                let rho = moving.rho();
                match self.corner(&moving.piece, rho, piece, rho, role) {
                    Ok(vectors) => {
                        let next = NextMove {
                            source: command.source,
                            surface: None,
                        };
                        self.end_move(moving, MoveEnd::Vectors(&vectors), Some(next));
                    }
                    Err(fault) => {
                        let alarm = fault.corner_alarm(moving.command.source, command.source);
                        self.refuse_move(&moving, alarm);
                    }
                }
            }
            (Some(moving), None) => self.end_perpendicular(moving),
            (None, _) => {}
        }
        if self.fault.is_some() {
            return;
        }
        for vector in self.tip_state.vectors.as_slice().iter().skip(1) {
            let to = self.settings.round(self.tip_state.base + *vector);
            self.ready.push_back(corner_move(&command, to, from_x));
        }
        self.on = false;
        self.recent_paths.clear();
        let to = self.machine.x;
        let programmed = || ProgrammedX::Linear { from: from_x, to };
        self.ready.push_back(with_programmed_x(command, programmed));
    }

    /// Computes the vectors of the corner between the moves `a` and `b` with the settings of the
    /// control, mm.
    fn corner(
        &self,
        a: &ContourSegment,
        rho_a: f64,
        b: &ContourSegment,
        rho_b: f64,
        role: CornerRole,
    ) -> Result<CornerVectors, CompensationFault> {
        corner::corner_vectors((a, rho_a), (b, rho_b), role, &self.settings)
    }

    /// Executes a T word without axis words after the open move: the tool moves by `by`, the
    /// change of the tool offset, mm.
    pub(super) fn shift_tool(&mut self, command: ControlCommand, by: Point) {
        if self.open_move.is_some() {
            self.held.push_back(HeldCommand::Travel(command, by));
        } else {
            self.shift_tool_now(command, by);
        }
    }

    /// Releases the command as a straight move of the tip by `by`, mm.
    fn shift_tool_now(&mut self, mut command: ControlCommand, by: Point) {
        self.tip_state.base = self.tip_state.base + by;
        command.action = straight_action(&command.action, self.tip_state.tip());
        self.ready.push_back(command);
    }

    /// Releases a move with a single vector at its end, which is perpendicular to the move.
    pub(super) fn end_perpendicular(&mut self, moving: Box<OpenMove>) {
        let square = corner::perpendicular_at_end(&moving.piece, moving.rho());
        self.end_move(
            moving,
            MoveEnd::Vectors(&CornerVectors::from_points(&[square])),
            None,
        );
    }

    /// Releases the open move so that the tip ends on the programmed point.
    pub(super) fn end_at_programmed_point(&mut self) {
        if let Some(moving) = self.open_move.take() {
            self.end_move(moving, MoveEnd::Cancelled, None);
        }
    }

    /// Checks the move `moving` with the end `end` for interference and releases it, then the
    /// commands held after it. `next` is the move that follows; `None` if it is unknown.
    fn end_move(&mut self, moving: Box<OpenMove>, end: MoveEnd<'_>, next: Option<NextMove<'_>>) {
        let cancelled = matches!(end, MoveEnd::Cancelled);
        let end = match end {
            MoveEnd::Vectors(end) => *end,
            MoveEnd::Cancelled => CornerVectors::from_points(&[corner::perpendicular_at_end(
                &moving.piece,
                moving.rho(),
            )]),
        };
        let mut way = EndVectors::with_all_vectors(self.tip_state.vectors, end);
        if cancelled || moving.starts || moving.from_point {
            self.recent_paths.clear();
        } else if let Err(fault) = self.check(&moving, &mut way, next) {
            let source = moving.command.source;
            let alarm = fault.corner_alarm(source, next.map_or(source, |next| next.source));
            return self.refuse_move(&moving, alarm);
        }
        if !way.start.is_single() {
            self.push_corner_moves(&moving, &way.start);
        }
        if cancelled {
            self.tip_state = TipState::at_programmed_point(moving.piece.end + moving.offset);
        } else {
            self.tip_state.base = moving.base();
            self.tip_state.vectors = way.end;
            self.tip_state.radius = moving.nose.radius;
            self.tip_state.cancelled = false;
        }
        self.push_main_move(&moving, &way, cancelled);
        self.spare = SpareBox::new(moving);
        self.release_held();
    }

    /// Checks a compensated move for interference and drops vectors that would interfere. Stores
    /// its path for the checks of later moves.
    ///
    /// # Errors
    /// The nose would cut into the part.
    fn check(
        &mut self,
        moving: &OpenMove,
        way: &mut EndVectors,
        next: Option<NextMove<'_>>,
    ) -> Result<(), CompensationFault> {
        interference::drop_interfering_vectors(&moving.piece, way)?;
        let rho = moving.rho();
        let is_continuous = self
            .recent_paths
            .last()
            .is_none_or(|before| are_same(before.end(), moving.piece.start));
        if !is_continuous {
            self.recent_paths.clear();
        }
        self.recent_paths.stage(&moving.piece, way, rho);
        let same_nose = self.tip_state.radius == moving.nose.radius;
        // A vector of another nose or of another corner does not keep clear.
        if same_nose
            && !moving.square_start
            && let Some((trail, before)) = self.recent_paths.staged()
        {
            let (last, start) = (self.recent_paths.last(), moving.piece.start);
            let surface = next.as_ref().and_then(|next| next.surface.as_ref());
            let surface =
                surface.filter(|(piece, by)| *by == rho && are_same(moving.piece.end, piece.start));
            let next = surface.map(|(piece, _)| *piece);
            if interference::does_cut_neighbours(before.as_slice(), last, start, way, trail, next) {
                return Err(CompensationFault::Interference);
            }
        }
        // The move after a perpendicular end may cut in.
        if next.is_none() || !same_nose {
            self.recent_paths.clear();
            return Ok(());
        }
        self.recent_paths.commit();
        Ok(())
    }

    /// Releases the moves around the corner at the start of a move, as part of the block of
    /// that move.
    pub(super) fn push_corner_moves(&mut self, moving: &OpenMove, vectors: &CornerVectors) {
        for vector in vectors.as_slice().iter().skip(1) {
            let to = self.settings.round(self.tip_state.base + *vector);
            self.ready.push_back(moving.corner_command(to));
        }
    }

    /// Releases the move itself. It ends at the first vector of its end; with `cancelled` a
    /// straight move to the programmed point follows.
    fn push_main_move(&mut self, moving: &OpenMove, way: &EndVectors, cancelled: bool) {
        let to = self.settings.round(moving.base() + way.end.first());
        let arc = if way.straight {
            None
        } else {
            shifted_arc(moving, way, to)
        };
        if !cancelled {
            let action = arc.unwrap_or_else(|| straight_action(&moving.command.action, to));
            return self.ready.push_back(moving.command_with(action));
        }
        if let Some(arc) = arc {
            self.ready.push_back(ControlCommand {
                block_end: false,
                stop_point: false,
                ..moving.command_with(arc)
            });
        }
        let point = destination(&moving.command.action, to).unwrap_or(to);
        let straight = straight_action(&moving.command.action, point);
        self.ready.push_back(moving.command_with(straight));
    }

    /// Releases the commands that waited for the end of the open move.
    fn release_held(&mut self) {
        while let Some(held) = self.held.pop_front() {
            match held {
                HeldCommand::Plain(command) => self.ready.push_back(command),
                HeldCommand::Travel(command, by) => self.shift_tool_now(command, by),
            }
        }
    }

    /// Releases the open move, then stores the alarm of `fault` at the block `source`, which is not
    /// started.
    pub(super) fn fail_before(&mut self, fault: CompensationFault, source: SourcePosition) {
        self.flush();
        self.fault
            .get_or_insert_with(|| fault.alarm().with_source(source));
    }

    /// Stores the alarm of `fault` at the corner between the open move and the block `next`. The
    /// open move is not run.
    pub(super) fn fail_at_corner(&mut self, fault: CompensationFault, next: SourcePosition) {
        match self.open_move.take() {
            Some(moving) => {
                self.refuse_move(&moving, fault.corner_alarm(moving.command.source, next));
            }
            None => self.refuse(fault.corner_alarm(next, next)),
        }
    }

    /// Stores `alarm` instead of running the move `moving`. The moves around the corner before it
    /// are still run.
    pub(super) fn refuse_move(&mut self, moving: &OpenMove, alarm: Alarm) {
        let vectors = self.tip_state.vectors;
        self.push_corner_moves(moving, &vectors);
        self.refuse(alarm);
    }
}
