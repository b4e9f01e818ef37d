//! The stream of commands through the compensation.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use super::corner::{self, Role, Vectors};
use super::fault::Fault;
use super::interference::{self, Trail, Way};
use super::nose::Nose;
use super::piece::{Piece, SAME};
use super::plane::sweep;
use super::rounded;
use crate::alarm::Alarm;
use crate::command::{Action, Command, Frame, Source};
use crate::interpreter::Modal;
use crate::units::{Feed, Point};

/// So many blocks without motion after a move end it square to itself.
const IDLE_BLOCKS: u8 = 2;
/// Moves that the interference check looks back on.
const MOVES_BEFORE: usize = 3;
/// Arcs shorter than this are run straight: rounding could turn them over.
const SHORT_ARC: f64 = 0.002;

/// What the interpreter knows of a command beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Origin {
    /// Whether its block moves along a contour (G00 to G03); other motion, that
    /// of cycles, threads and G28, runs without compensation.
    pub(crate) contour: bool,
    /// The nose in force.
    pub(crate) nose: Nose,
    /// 003.4: a T word shifts the coordinates instead of moving the tool.
    pub(crate) offset_by_shift: bool,
}

/// Where the tip stands, or will when what was given out is done, and which
/// vectors of that corner are still ahead.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Stand {
    /// Machine point from which the vectors count: the programmed one plus the
    /// way from the centre to the tip.
    base: Point,
    /// The first one is reached.
    vectors: Vectors,
    /// Radius that made the vectors.
    radius: f64,
    /// The vector is cancelled: the tip is on the programmed point.
    cancelled: bool,
}

impl Stand {
    fn on_point(machine: Point) -> Self {
        Self {
            base: machine,
            vectors: Vectors::of(&[Point::default()]),
            radius: 0.0,
            cancelled: true,
        }
    }

    /// The tip.
    fn tip(&self) -> Point {
        let tip = self.base + self.vectors.first();
        if self.cancelled { tip } else { rounded(tip) }
    }
}

/// A compensated move whose end is still open.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Moving {
    command: Command,
    piece: Piece,
    /// +1 left (G41), -1 right (G42).
    side: f64,
    nose: Nose,
    /// Tool offset at its end.
    offset: Point,
    /// It is the first one.
    starts: bool,
    /// It begins on a cancelled vector.
    from_point: bool,
    /// It begins on the vector that ended the move before, square to that.
    square_start: bool,
}

impl Moving {
    fn rho(&self) -> f64 {
        self.side * self.nose.radius
    }

    /// The machine point that vectors at its end count from.
    fn base(&self) -> Point {
        self.piece.end + self.offset + self.nose.tip()
    }

    fn command(&self, action: Action) -> Command {
        Command {
            action,
            ..self.command.clone()
        }
    }
}

/// The move that gives an open one its end.
#[derive(Clone, Copy, Debug)]
struct Next {
    source: Source,
    /// A compensated move, and how far on its left the nose runs.
    surface: Option<(Piece, f64)>,
}

/// How an open move ends.
#[derive(Clone, Copy, Debug, PartialEq)]
enum End {
    Vectors(Vectors),
    /// On the programmed point.
    Cancelled,
}

/// A command after the open move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Held {
    Plain(Command),
    /// The tool travels a change of its offset, this far; the programmed point
    /// stays.
    Travel(Command, Point),
}

/// The compensation between the interpreter and what carries commands out.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Compensation {
    on: bool,
    /// Programmed end of what was pushed, machine coordinates and without the
    /// tool offset.
    machine: Point,
    at: Point,
    offset: Point,
    stand: Stand,
    moving: Option<Moving>,
    /// The compensated moves before it, the last one at the end, while the
    /// corners between them were regular.
    before: VecDeque<Trail>,
    held: VecDeque<Held>,
    ready: VecDeque<Command>,
    fault: Option<Alarm>,
    /// Blocks without motion since the open move.
    idle: u8,
    /// The block under way has moved.
    moved: bool,
}

impl Compensation {
    /// Offset mode: from the start-up move to the move that cancels.
    pub(crate) const fn is_on(&self) -> bool {
        self.on
    }

    /// Whether commands came in that have not been given out.
    pub(crate) fn holds(&self) -> bool {
        self.moving.is_some() || !self.ready.is_empty()
    }

    /// The next command, or the alarm at which everything ends.
    pub(crate) fn take(&mut self) -> Option<Result<Command, Alarm>> {
        match self.ready.pop_front() {
            Some(command) => Some(Ok(command)),
            None => self.fault.clone().map(Err),
        }
    }

    /// RESET, a new run: the vector is dropped without motion.
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Where the tool stands before a block, while the compensation is off.
    pub(crate) fn stand_at(&mut self, machine: Point, frame: Frame) {
        self.machine = machine;
        self.offset = frame.offset;
        self.at = machine - frame.offset;
    }

    /// Takes the next command of the program.
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

    /// Nothing more can be read before everything is carried out: the open move
    /// ends square to itself.
    pub(crate) fn flush(&mut self) {
        if let Some(moving) = &self.moving {
            let square = corner::square_to_end(&moving.piece, moving.rho());
            self.end_move(End::Vectors(Vectors::of(&[square])), None);
        }
    }

    /// The block after the open move has wrong data: that move is not begun.
    pub(crate) fn refuse(&mut self, alarm: Alarm) {
        if let Some(moving) = self.moving.take() {
            self.corner_moves(&moving, self.stand.vectors);
        }
        self.held.clear();
        self.fault = Some(alarm);
    }

    /// The tool was moved aside while the run stood: the vectors are carried
    /// along. Returns how far.
    pub(crate) fn displace(&mut self, machine: Point) -> Point {
        let by = machine - self.stand.tip();
        if by.length() <= SAME {
            return Point::default();
        }
        self.stand.base = self.stand.base + by;
        let Some(moving) = &mut self.moving else {
            self.machine = self.machine + by;
            self.at = self.at + by;
            return by;
        };
        let start = moving.piece.start + by;
        match piece(&moving.command.action, start, moving.piece.end, moving.offset) {
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

    /// Motion that is not compensated: the vector is cancelled before it and
    /// comes back with the next move along the contour.
    fn foreign(&mut self, command: Command, to: Point) {
        self.end_move(End::Cancelled, None);
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
            self.end_move(End::Cancelled, None);
        }
        self.queue(command);
    }

    /// A move along the contour.
    fn contour(&mut self, command: Command, to: Point, nose: Nose) {
        let (start, end) = (self.at, to - self.offset);
        let from = core::mem::replace(&mut self.machine, to);
        self.at = end;
        let side = side(&command.modal);
        let arc = matches!(command.action, Action::Arc { .. });
        let rests = !arc && (end - start).length() <= SAME;
        if !self.on && (rests || side == 0.0 || command.modal.offset == 0) {
            self.moved = true;
            return self.ready.push_back(command);
        }
        if self.on && rests && side != 0.0 && (to - from).length() > SAME {
            return self.travel(command, to - from);
        }
        self.moved = true;
        if !self.on && arc {
            return self.stop_before(Fault::StartOnArc, command.source);
        }
        if self.on && side == 0.0 && (arc || rests) {
            return match arc {
                true => self.stop_before(Fault::CancelOnArc, command.source),
                false => self.cancel(command, None),
            };
        }
        let piece = match piece(&command.action, start, end, self.offset) {
            Ok(piece) => piece,
            Err(fault) if fault.of_two_moves() => return self.stop_at_corner(fault, command.source),
            Err(fault) => return self.stop_before(fault, command.source),
        };
        if self.on && side == 0.0 {
            return self.cancel(command, Some(&piece));
        }
        let starts = !self.on;
        if starts {
            self.stand = Stand::on_point(from);
        }
        self.on = true;
        self.next_move(Moving {
            command,
            piece,
            side,
            nose,
            offset: self.offset,
            starts,
            from_point: false,
            square_start: false,
        });
    }

    /// The open move gets its end from the next one, which becomes the open one.
    fn next_move(&mut self, mut next: Moving) {
        let source = next.command.source;
        if let Some(moving) = &self.moving {
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
                    let surface = Some((next.piece, next_rho));
                    self.end_move(End::Vectors(vectors), Some(Next { source, surface }));
                }
                Err(fault) => self.stop_at_corner(fault, source),
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
        if let Err(fault) = circle.offset_radius(rho) {
            return self.stop_before(fault, next.command.source);
        }
        let vector = self.stand.vectors.first();
        let square = corner::square_to_start(&next.piece, rho);
        if (square - vector).length() > SAME {
            self.stand.vectors = Vectors::of(&[vector, square]);
        }
    }

    /// The move that cancels: to its programmed end; with `None` it has no
    /// direction.
    fn cancel(&mut self, command: Command, piece: Option<&Piece>) {
        let corner = match (&self.moving, piece) {
            (Some(moving), Some(piece)) => {
                let role = if moving.starts {
                    Role::StartUp
                } else {
                    Role::Cancel
                };
                let rho = moving.rho();
                Some(corner::vectors(&moving.piece, rho, piece, rho, role))
            }
            _ => None,
        };
        match corner {
            Some(Ok(vectors)) => {
                let next = Next {
                    source: command.source,
                    surface: None,
                };
                self.end_move(End::Vectors(vectors), Some(next));
            }
            Some(Err(fault)) => self.stop_at_corner(fault, command.source),
            None => self.flush(),
        }
        if self.fault.is_some() {
            return;
        }
        for vector in self.stand.vectors.all().iter().skip(1) {
            let to = rounded(self.stand.base + *vector);
            self.ready.push_back(corner_move(&command, to));
        }
        self.on = false;
        self.ready.push_back(command);
    }

    /// A T without axis words: the tool travels the change of the offset.
    fn travel(&mut self, command: Command, by: Point) {
        if self.moving.is_some() {
            self.held.push_back(Held::Travel(command, by));
        } else {
            self.travel_now(command, by);
        }
    }

    /// The tip goes along, vector and all.
    fn travel_now(&mut self, command: Command, by: Point) {
        self.stand.base = self.stand.base + by;
        self.ready.push_back(Command {
            action: straight_action(&command.action, self.stand.tip()),
            ..command
        });
    }

    /// Gives the open move out, with this end, and what was held after it.
    fn end_move(&mut self, end: End, next: Option<Next>) {
        let Some(moving) = self.moving.take() else {
            return;
        };
        let start = self.stand.vectors;
        let inside = !moving.starts && !moving.from_point;
        let way = match end {
            End::Vectors(end) if inside => self.check(&moving, start, end, next),
            End::Vectors(end) => Ok(Way {
                start,
                end,
                straight: false,
            }),
            End::Cancelled => Ok(Way {
                start,
                end: Vectors::of(&[corner::square_to_end(&moving.piece, moving.rho())]),
                straight: false,
            }),
        };
        let way = match way {
            Ok(way) => way,
            Err(fault) => {
                let source = moving.command.source;
                self.moving = Some(moving);
                let alarm = fault.at_corner(source, next.map_or(source, |next| next.source));
                return self.refuse(alarm);
            }
        };
        self.corner_moves(&moving, way.start);
        self.main_move(&moving, &way, end == End::Cancelled);
        self.remember(end, next.is_some() && inside, &moving, &way);
        self.stand = match end {
            End::Vectors(_) => Stand {
                base: moving.base(),
                vectors: way.end,
                radius: moving.nose.radius,
                cancelled: false,
            },
            End::Cancelled => Stand::on_point(moving.piece.end + moving.offset),
        };
        self.release();
    }

    /// Keeps a move for the interference check of those that follow. After an end
    /// square to it, or on the point, the next one may cut in.
    fn remember(&mut self, end: End, regular: bool, moving: &Moving, way: &Way) {
        if end == End::Cancelled || !regular {
            return self.before.clear();
        }
        if self.before.len() >= MOVES_BEFORE {
            self.before.pop_front();
        }
        let trail = Trail::of(&moving.piece, way, moving.rho());
        self.before.push_back(trail);
    }

    /// The interference check of a move within offset mode.
    fn check(
        &self,
        moving: &Moving,
        start: Vectors,
        end: Vectors,
        next: Option<Next>,
    ) -> Result<Way, Fault> {
        let way = interference::check(&moving.piece, start, end)?;
        let rho = moving.rho();
        let trail = Trail::of(&moving.piece, &way, rho);
        if moving.square_start {
            return Ok(way);
        }
        let before = self.before.iter().filter(|before| before.rho == rho);
        let surface = next
            .and_then(|next| next.surface)
            .filter(|(_, next_rho)| *next_rho == rho);
        let next = surface.as_ref().map(|(piece, _)| piece);
        if interference::cuts_into(before, &way, &trail, next) {
            return Err(Fault::Interference);
        }
        Ok(way)
    }

    /// Round the corner at the start of a move, at its head.
    fn corner_moves(&mut self, moving: &Moving, vectors: Vectors) {
        for vector in vectors.all().iter().skip(1) {
            let to = rounded(self.stand.base + *vector);
            self.ready.push_back(corner_move(&moving.command, to));
        }
    }

    /// The move itself, to the first vector of its end or to the point.
    fn main_move(&mut self, moving: &Moving, way: &Way, cancelled: bool) {
        let to = rounded(moving.base() + way.end.first());
        let point = destination(&moving.command.action, to).unwrap_or(to);
        let arc = if way.straight {
            None
        } else {
            shifted_arc(moving, way, to)
        };
        let straight = |to| straight_action(&moving.command.action, to);
        match (arc, cancelled) {
            (Some(arc), false) => self.ready.push_back(moving.command(arc)),
            (None, false) => self.ready.push_back(moving.command(straight(to))),
            (None, true) => self.ready.push_back(moving.command(straight(point))),
            (Some(arc), true) => {
                self.ready.push_back(Command {
                    block_end: false,
                    stop_point: false,
                    ..moving.command(arc)
                });
                self.ready.push_back(moving.command(straight(point)));
            }
        }
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
    fn stop_before(&mut self, fault: Fault, source: Source) {
        self.flush();
        self.fault.get_or_insert_with(|| fault.alarm().at(source));
    }

    /// Alarm between the open move and the next: the open one is not begun.
    fn stop_at_corner(&mut self, fault: Fault, next: Source) {
        let first = self
            .moving
            .as_ref()
            .map_or(next, |moving| moving.command.source);
        self.refuse(fault.at_corner(first, next));
    }
}

/// +1 for G41, -1 for G42, 0 for G40.
fn side(modal: &Modal) -> f64 {
    match modal.nose_compensation {
        41 => 1.0,
        42 => -1.0,
        _ => 0.0,
    }
}

/// Whether it is a move of G00 to G03.
const fn cuts(action: &Action) -> bool {
    matches!(
        action,
        Action::Rapid { .. } | Action::Line { .. } | Action::Arc { .. }
    )
}

/// Where an action takes the axes that stand at `from`.
fn destination(action: &Action, from: Point) -> Option<Point> {
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
fn piece(action: &Action, start: Point, end: Point, offset: Point) -> Result<Piece, Fault> {
    match action {
        Action::Arc {
            center, clockwise, ..
        } => Piece::arc(start, end, *center - offset, *clockwise),
        _ => Piece::line(start, end),
    }
}

/// A straight move to the tip's target, as rapid or at the feed of its block.
fn straight_action(action: &Action, to: Point) -> Action {
    match feed(action) {
        Some(feed) => Action::Line { to, feed },
        None => Action::Rapid { to },
    }
}

const fn feed(action: &Action) -> Option<Feed> {
    match action {
        Action::Line { feed, .. } | Action::Arc { feed, .. } => Some(*feed),
        _ => None,
    }
}

/// A corner move: at the head of the block that follows the corner.
fn corner_move(command: &Command, to: Point) -> Command {
    Command {
        action: straight_action(&command.action, to),
        block_end: false,
        stop_point: false,
        ..command.clone()
    }
}

/// The arc of the tip: that of the nose centre, moved. `None` for a line, and
/// for an arc of which too little is left.
fn shifted_arc(moving: &Moving, way: &Way, to: Point) -> Option<Action> {
    use core::f64::consts::PI;
    let circle = moving.piece.circle.as_ref()?;
    let p = moving.piece.start + way.start.last() - circle.center;
    let q = moving.piece.end + way.end.first() - circle.center;
    let short = (q - p).length() < SHORT_ARC;
    if short && (p.length() < SHORT_ARC || sweep(p, q, circle.turn) < PI || !whole(moving)) {
        return None;
    }
    Some(Action::Arc {
        to,
        center: circle.center + moving.offset + moving.nose.tip(),
        clockwise: circle.turn < 0.0,
        feed: feed(&moving.command.action)?,
    })
}

/// Whether an arc goes more than half round.
fn whole(moving: &Moving) -> bool {
    moving.piece.circle.as_ref().is_some_and(|circle| {
        let from = moving.piece.start - circle.center;
        let way = sweep(from, moving.piece.end - circle.center, circle.turn);
        way == 0.0 || way > core::f64::consts::PI
    })
}
