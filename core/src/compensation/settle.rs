//! Moves get their ends: the vectors of the corner, the check, the commands.

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
    /// The open move gets its end from the next one, which becomes the open one.
    pub(super) fn next_move(&mut self, mut next: Box<Moving>) {
        let source = next.command.source;
        if let Some(moving) = self.moving.take() {
            // The side cannot change right after the start-up.
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

    /// A move after the end of the one before was settled: from the vector that
    /// stands; an arc begins on its own path.
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

    /// The move that cancels: from one X to its programmed end; with `None` it has
    /// no direction.
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

    /// A T without axis words: the tool travels the change of the offset.
    pub(super) fn travel(&mut self, command: Command, by: Point) {
        if self.moving.is_some() {
            self.held.push_back(Held::Travel(command, by));
        } else {
            self.travel_now(command, by);
        }
    }

    /// The tip goes along, vector and all.
    fn travel_now(&mut self, mut command: Command, by: Point) {
        self.stand.base = self.stand.base + by;
        command.action = straight_action(&command.action, self.stand.tip());
        self.ready.push_back(command);
    }

    /// Gives a move out, ended square to itself.
    pub(super) fn end_square(&mut self, moving: Box<Moving>) {
        let square = corner::square_to_end(&moving.piece, moving.rho());
        self.end_move(moving, End::Vectors(&Vectors::of(&[square])), None);
    }

    /// Gives the open move out, ended on its programmed point.
    pub(super) fn end_on_point(&mut self) {
        if let Some(moving) = self.moving.take() {
            self.end_move(moving, End::Cancelled, None);
        }
    }

    /// Gives the move that was the open one out, with this end, and what was held after
    /// it.
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

    /// The interference check of a move within offset mode, which leaves of its vectors
    /// what may be run. Its trail is kept for those that follow.
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
        // Neither a vector of another nose nor one of another corner keeps clear.
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
        // After an end square to it the next one may cut in.
        if next.is_none() || !same_nose {
            self.before.clear();
            return Ok(());
        }
        self.before.keep();
        Ok(())
    }

    /// Round the corner at the start of a move, at its head.
    pub(super) fn corner_moves(&mut self, moving: &Moving, vectors: &Vectors) {
        for vector in vectors.all().iter().skip(1) {
            let to = rounded(self.stand.base + *vector);
            self.ready.push_back(moving.corner_command(to));
        }
    }

    /// The move itself, to the first vector of its end or to the point.
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

    /// What was held after a move follows it.
    fn release(&mut self) {
        while let Some(held) = self.held.pop_front() {
            match held {
                Held::Plain(command) => self.ready.push_back(command),
                Held::Travel(command, by) => self.travel_now(command, by),
            }
        }
    }

    /// Alarm at the start of a block: everything before it is carried out.
    pub(super) fn stop_before(&mut self, fault: Fault, source: Source) {
        self.flush();
        self.fault.get_or_insert_with(|| fault.alarm().at(source));
    }

    /// Alarm between the open move and the next: the open one is not begun.
    pub(super) fn stop_at_corner(&mut self, fault: Fault, next: Source) {
        match self.moving.take() {
            Some(moving) => {
                self.refuse_move(&moving, fault.at_corner(moving.command.source, next));
            }
            None => self.refuse(fault.at_corner(next, next)),
        }
    }

    /// The move that was the open one is not begun, but for what leads round the corner
    /// before it.
    pub(super) fn refuse_move(&mut self, moving: &Moving, alarm: Alarm) {
        let vectors = self.stand.vectors;
        self.corner_moves(moving, &vectors);
        self.refuse(alarm);
    }
}
