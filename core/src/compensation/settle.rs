//! Ends moves: computes the vectors of the corner, checks them, and releases the commands.

use super::corner::{self, Role, Vectors};
use super::fault::Fault;
use super::interference::{self, Way};
use super::moves::{
    End, Held, Moving, Next, Spare, Stand, corner_move, destination, shifted_arc, straight_action,
    with_programmed_x,
};
use super::piece::{Piece, are_same};
use super::rounded;
use super::stream::Compensation;
use crate::alarm::Alarm;
use crate::command::{Command, ProgrammedX, Source};
use crate::units::Point;

impl Compensation {
    /// Ends the open move at the next one, which becomes the open move.
    pub(super) fn next_move(&mut self, mut next: Box<Moving>) {
        let source = next.command.source;
        if let Some(moving) = self.moving.take() {
            // The side cannot change immediately after the start-up.
            if moving.starts {
                next.side = moving.side;
            }
            let role = if moving.starts {
                Role::StartUp
            } else {
                Role::Both
            };
            let (rho, next_rho) = (moving.rho(), next.side * moving.nose.radius);
            match corner::vectors(&moving.piece, rho, &next.piece, next_rho, role) {
                Ok(vectors) => {
                    let surface = Some((&next.piece, next_rho));
                    let next = Some(Next { source, surface });
                    self.end_move(moving, End::Vectors(&vectors), next);
                }
                Err(fault) => {
                    self.refuse_move(&moving, fault.at_corner(moving.command.source, source));
                }
            }
        } else {
            self.begin_from_stand(&mut next);
        }
        if self.fault.is_none() {
            self.idle = 0;
            self.moving = Some(next);
        }
    }

    /// Begins a move after the end of the move before has been settled: from the current
    /// vector. An arc begins on its own path.
    fn begin_from_stand(&mut self, next: &mut Moving) {
        let mut radius = self.stand.radius;
        if self.stand.cancelled {
            radius = next.nose.radius;
            let tip = next.nose.tip();
            self.stand = Stand {
                base: self.stand.base + tip,
                vectors: Vectors::of(&[-tip]),
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
        if let Err(fault) = circle.check_room(rho) {
            return self.stop_before(fault, next.command.source);
        }
        let vector = self.stand.vectors.first();
        let square = corner::square_to_start(&next.piece, rho);
        if !are_same(vector, square) {
            self.stand.vectors = Vectors::of(&[vector, square]);
        }
    }

    /// Runs the move that cancels the compensation, from `from_x` to its programmed end.
    /// `piece` is `None` for a move without a direction.
    pub(super) fn cancel(&mut self, command: Command, from_x: f64, piece: Option<&Piece>) {
        let moving = self.moving.take();
        match (moving, piece) {
            (Some(moving), Some(piece)) => {
                let role = if moving.starts {
                    Role::StartUp
                } else {
                    Role::Cancel
                };
                let rho = moving.rho();
                match corner::vectors(&moving.piece, rho, piece, rho, role) {
                    Ok(vectors) => {
                        let next = Next {
                            source: command.source,
                            surface: None,
                        };
                        self.end_move(moving, End::Vectors(&vectors), Some(next));
                    }
                    Err(fault) => {
                        let alarm = fault.at_corner(moving.command.source, command.source);
                        self.refuse_move(&moving, alarm);
                    }
                }
            }
            (Some(moving), None) => self.end_square(moving),
            (None, _) => {}
        }
        if self.fault.is_some() {
            return;
        }
        for vector in self.stand.vectors.all().iter().skip(1) {
            let to = rounded(self.stand.base + *vector);
            self.ready.push_back(corner_move(&command, to, from_x));
        }
        self.on = false;
        self.before.clear();
        let to = self.machine.x;
        let way = || ProgrammedX::Even { from: from_x, to };
        self.ready.push_back(with_programmed_x(command, way));
    }

    /// A T word without axis words: the tool moves by the change of the offset.
    pub(super) fn travel(&mut self, command: Command, by: Point) {
        if self.moving.is_some() {
            self.held.push_back(Held::Travel(command, by));
        } else {
            self.travel_now(command, by);
        }
    }

    /// The tip moves with its vector.
    fn travel_now(&mut self, mut command: Command, by: Point) {
        self.stand.base = self.stand.base + by;
        command.action = straight_action(&command.action, self.stand.tip());
        self.ready.push_back(command);
    }

    /// Releases a move that ends perpendicular to itself.
    pub(super) fn end_square(&mut self, moving: Box<Moving>) {
        let square = corner::square_to_end(&moving.piece, moving.rho());
        self.end_move(moving, End::Vectors(&Vectors::of(&[square])), None);
    }

    /// Releases the open move with its end on the programmed point.
    pub(super) fn end_on_point(&mut self) {
        if let Some(moving) = self.moving.take() {
            self.end_move(moving, End::Cancelled, None);
        }
    }

    /// Releases the open move with this end, then the commands held after it.
    fn end_move(&mut self, moving: Box<Moving>, end: End<'_>, next: Option<Next<'_>>) {
        let cancelled = matches!(end, End::Cancelled);
        let end = match end {
            End::Vectors(end) => *end,
            End::Cancelled => Vectors::of(&[corner::square_to_end(&moving.piece, moving.rho())]),
        };
        let mut way = Way::whole(self.stand.vectors, end);
        if cancelled || moving.starts || moving.from_point {
            self.before.clear();
        } else if let Err(fault) = self.check(&moving, &mut way, next) {
            let source = moving.command.source;
            let alarm = fault.at_corner(source, next.map_or(source, |next| next.source));
            return self.refuse_move(&moving, alarm);
        }
        if !way.start.single() {
            self.corner_moves(&moving, &way.start);
        }
        if cancelled {
            self.stand = Stand::on_point(moving.piece.end + moving.offset);
        } else {
            self.stand.base = moving.base();
            self.stand.vectors = way.end;
            self.stand.radius = moving.nose.radius;
            self.stand.cancelled = false;
        }
        self.main_move(&moving, &way, cancelled);
        self.spare = Spare::of(moving);
        self.release();
    }

    /// Checks a move in offset mode for interference and reduces its vectors to those that
    /// may be run. Records its path for the checks of later moves.
    fn check(
        &mut self,
        moving: &Moving,
        way: &mut Way,
        next: Option<Next<'_>>,
    ) -> Result<(), Fault> {
        interference::check(&moving.piece, way)?;
        let rho = moving.rho();
        let goes_on = self
            .before
            .last()
            .is_none_or(|before| are_same(before.end(), moving.piece.start));
        if !goes_on {
            self.before.clear();
        }
        self.before.lay(&moving.piece, way, rho);
        let same_nose = self.stand.radius == moving.nose.radius;
        // A vector of another nose or of another corner does not keep clear.
        if same_nose
            && !moving.square_start
            && let Some((trail, before)) = self.before.laid()
        {
            let (last, start) = (self.before.last(), moving.piece.start);
            let surface = next.as_ref().and_then(|next| next.surface.as_ref());
            let surface =
                surface.filter(|(piece, by)| *by == rho && are_same(moving.piece.end, piece.start));
            let next = surface.map(|(piece, _)| *piece);
            if interference::cuts_into(before.all(), last, start, way, trail, next) {
                return Err(Fault::Interference);
            }
        }
        // The move after a perpendicular end may cut in.
        if next.is_none() || !same_nose {
            self.before.clear();
            return Ok(());
        }
        self.before.keep();
        Ok(())
    }

    /// Moves around the corner at the start of a move, as part of that move's block.
    pub(super) fn corner_moves(&mut self, moving: &Moving, vectors: &Vectors) {
        for vector in vectors.all().iter().skip(1) {
            let to = rounded(self.stand.base + *vector);
            self.ready.push_back(moving.corner_command(to));
        }
    }

    /// Releases the move itself, to the first vector of its end or to the programmed point.
    fn main_move(&mut self, moving: &Moving, way: &Way, cancelled: bool) {
        let to = rounded(moving.base() + way.end.first());
        let arc = if way.straight {
            None
        } else {
            shifted_arc(moving, way, to)
        };
        if !cancelled {
            let action = arc.unwrap_or_else(|| straight_action(&moving.command.action, to));
            return self.ready.push_back(moving.give_out(action));
        }
        if let Some(arc) = arc {
            self.ready.push_back(Command {
                block_end: false,
                stop_point: false,
                ..moving.give_out(arc)
            });
        }
        let point = destination(&moving.command.action, to).unwrap_or(to);
        let straight = straight_action(&moving.command.action, point);
        self.ready.push_back(moving.give_out(straight));
    }

    /// Releases the commands held after a move.
    fn release(&mut self) {
        while let Some(held) = self.held.pop_front() {
            match held {
                Held::Plain(command) => self.ready.push_back(command),
                Held::Travel(command, by) => self.travel_now(command, by),
            }
        }
    }

    /// Raises an alarm at the start of a block, after everything before it has been
    /// executed.
    pub(super) fn stop_before(&mut self, fault: Fault, source: Source) {
        self.flush();
        self.fault.get_or_insert_with(|| fault.alarm().at(source));
    }

    /// Raises an alarm between the open move and the next one: the open move is not started.
    pub(super) fn stop_at_corner(&mut self, fault: Fault, next: Source) {
        match self.moving.take() {
            Some(moving) => {
                self.refuse_move(&moving, fault.at_corner(moving.command.source, next));
            }
            None => self.refuse(fault.at_corner(next, next)),
        }
    }

    /// Refuses the move that was open. The moves around the corner before it are still
    /// executed.
    pub(super) fn refuse_move(&mut self, moving: &Moving, alarm: Alarm) {
        let vectors = self.stand.vectors;
        self.corner_moves(moving, &vectors);
        self.refuse(alarm);
    }
}
