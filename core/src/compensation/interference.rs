//! The interference check: a move whose nose path runs against the programmed
//! one would cut into the part (manual II, C compensation).
//!
//! ```text
//!        p .        q
//!   ---. .  `.    .'  .---       p = start + its last vector
//!      |.     `. .'   |          q = end + its first vector
//!      |  q <-- p     |          bottom: programmed to the left, nose path to
//!      '--------------'          the right: alarm 057
//! ```
//!
//! The nose must not cut into the moves about it either: into those just run, and
//! into the next one, which has been read.
//!
//! Before the alarm, vectors of corners with several are dropped one by one; an
//! arc is then run as a straight line.

use core::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use super::clearance::{self, Curve, ROUNDING};
use super::corner::Vectors;
use super::fault::Fault;
use super::piece::{Circle, Piece, too_short};
use super::plane::sweep;
use crate::units::Point;

/// So far backwards is rounding, mm.
const BACKWARDS: f64 = 1e-6;
/// So much the nose may cut into an arc whose end lies beside its circle, mm: its
/// path is parallel only as long as the radius changes slowly.
const TILTED: f64 = 0.0005;

/// A move that may be run: the vectors left at its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Way {
    pub(super) start: Vectors,
    pub(super) end: Vectors,
    /// An arc run as a straight line.
    pub(super) straight: bool,
}

impl Way {
    /// With all vectors, and as an arc if it is one.
    pub(super) const fn whole(start: Vectors, end: Vectors) -> Self {
        Self {
            start,
            end,
            straight: false,
        }
    }
}

/// A move that was run: its surface and the path of the nose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Trail {
    surface: Curve,
    path: Curve,
    /// The path keeps the nose clear of its own surface.
    parallel: bool,
    /// The nose ran so far on the left of it.
    pub(super) rho: f64,
}

impl Trail {
    /// A place for one.
    const EMPTY: Self = {
        let none = Curve::line(Point::new(0.0, 0.0), Point::new(0.0, 0.0));
        Self {
            surface: none,
            path: none,
            parallel: false,
            rho: 0.0,
        }
    };

    /// Becomes that of a move.
    #[inline(always)]
    fn become_that_of(&mut self, piece: &Piece, way: &Way, rho: f64) {
        let (p, q) = (piece.start + way.start.last(), piece.end + way.end.first());
        match &piece.circle {
            Some(circle) if !way.straight && !too_short(piece, circle, p, q) => {
                self.path = Curve::arc(p, q, circle, piece);
            }
            _ => self.path = Curve::line(p, q),
        }
        match &piece.circle {
            None => self.surface = Curve::line(piece.start, piece.end),
            Some(_) => self.surface = Curve::surface(piece),
        }
        self.parallel = !way.straight;
        self.rho = rho;
    }

    /// Programmed end.
    pub(super) const fn end(&self) -> Point {
        self.surface.to
    }
}

/// Moves that the check looks back on.
const MOVES_BEFORE: usize = 3;

/// The last moves that were run, as long as the corners between them were regular, and the
/// one that is being checked. It is put together in its place: a copy of it would cost more
/// than the check.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Trails {
    kept: Vec<Trail>,
    /// Where the next one goes: once there are enough, over the oldest.
    next: usize,
}

impl Trails {
    /// Forgets them.
    pub(super) fn clear(&mut self) {
        self.kept.clear();
        self.next = 0;
    }

    /// The last one.
    pub(super) fn last(&self) -> Option<&Trail> {
        let last = (self.next + MOVES_BEFORE) % (MOVES_BEFORE + 1);
        self.kept.get(last)
    }

    /// Forgets all but the last one.
    pub(super) fn keep_last(&mut self) {
        if let Some(last) = self.last().copied() {
            self.clear();
            self.kept.push(last);
            self.keep();
        }
    }

    /// Takes the trail of a move that is still to be checked.
    #[inline(always)]
    pub(super) fn lay(&mut self, piece: &Piece, way: &Way, rho: f64) {
        if self.kept.len() == self.next {
            self.kept.push(Trail::EMPTY);
        }
        if let Some(oldest) = self.kept.get_mut(self.next) {
            oldest.become_that_of(piece, way, rho);
        }
    }

    /// What was laid, and those before it along which the nose ran as far on the left.
    #[inline(always)]
    pub(super) fn laid(&self) -> Option<(&Trail, Before<'_>)> {
        let (before, from) = self.kept.split_at_checked(self.next)?;
        let (laid, after) = from.split_first()?;
        let mut all = Before {
            list: [laid; MOVES_BEFORE],
            count: 0,
        };
        for trails in [before, after] {
            for trail in trails {
                if trail.rho == laid.rho
                    && let Some(place) = all.list.get_mut(all.count)
                {
                    *place = trail;
                    all.count += 1;
                }
            }
        }
        Some((laid, all))
    }

    /// What was laid has been run.
    pub(super) const fn keep(&mut self) {
        self.next = (self.next + 1) % (MOVES_BEFORE + 1);
    }
}

/// Moves that were run, in no order.
#[derive(Clone, Copy)]
pub(super) struct Before<'a> {
    list: [&'a Trail; MOVES_BEFORE],
    count: usize,
}

impl<'a> Before<'a> {
    pub(super) fn all(&self) -> &[&'a Trail] {
        self.list.get(..self.count).unwrap_or(&[])
    }
}

/// Whether the nose would cut into the moves about it: on its way round the
/// corner at the start and along the move, into the moves before, the move itself
/// and the next one; and whether it has cut into the next one on the moves before,
/// of which `last` is one.
///
/// ```text
///              path .-------   inner: the path leaves the line before it on the side of
///    . . . . . . . .'          the nose
///    -------------.
///   before       `-------- surface
///    . . . . . .
///    ---------. `.             outer: the line before lies on the other side of the
///              `. `. path      path's own line
/// ```
///
/// Along a line between two points where paths meet, the nose keeps clear of the lines
/// that it meets there: those are not looked at.
pub(super) fn cuts_into(
    before: &[&Trail],
    last: Option<&Trail>,
    start: Point,
    way: &Way,
    trail: &Trail,
    next: Option<&Piece>,
) -> bool {
    let radius = trail.rho.abs();
    let next = next.map(Curve::surface);
    let cuts = |path: &Curve, surface: &Curve| clearance::cuts(path, surface, radius - ROUNDING);
    let own = if trail.parallel {
        let (path, surface) = (&trail.path, &trail.surface);
        surface.loose() > TILTED / 2.0 && clearance::cuts(path, surface, radius - TILTED)
    } else {
        cuts(&trail.path, &trail.surface)
    };
    let around = |path: &Curve, into: f64, met: Option<&Trail>, next: Option<&Curve>| {
        let cuts = |surface: &Curve| clearance::cuts(path, surface, radius - into);
        let is_met = |before: &Trail| met.is_some_and(|met| core::ptr::eq(before, met));
        (before.iter()).any(|before| !is_met(before) && cuts(&before.surface))
            || next.is_some_and(cuts)
    };
    // By what the radius of an arc shrinks on its way, the nose comes nearer to the moves
    // beside it, and sets off that near on the next one.
    let loosest = before
        .iter()
        .map(|before| before.surface.loose())
        .fold(trail.surface.loose(), f64::max);
    let shrinks = (2.0 * loosest + ROUNDING).min(TILTED);
    let between = trail.surface.is_line() && way.start.meets && way.end.meets;
    let met = last.filter(|last| between && last.surface.is_line());
    let unmet = next.as_ref().filter(|next| !(between && next.is_line()));
    if own || around(&trail.path, shrinks.max(ROUNDING), met, unmet) {
        return true;
    }
    if before.is_empty() {
        return false;
    }
    let mut corner = way.start.all().windows(2);
    corner.any(|pair| match pair {
        [one, other] => {
            let path = Curve::line(start + *one, start + *other);
            cuts(&path, &trail.surface) || around(&path, ROUNDING, None, next.as_ref())
        }
        _ => false,
    }) || next.is_some_and(|next| before.iter().any(|before| cuts(&before.path, &next)))
}

/// Checks a move between the vectors at its start and at its end; drops some of them if
/// it must.
#[inline]
pub(super) fn check(piece: &Piece, way: &mut Way) -> Result<(), Fault> {
    while interferes(piece, way) {
        match (way.start.single(), way.end.single()) {
            (true, true) => return Err(Fault::Interference),
            (false, true) => way.start.drop_last(),
            (true, false) => way.end.drop_first(),
            (false, false) => {
                way.start.drop_last();
                way.end.drop_first();
            }
        }
        way.straight = piece.circle.is_some();
    }
    Ok(())
}

fn interferes(piece: &Piece, way: &Way) -> bool {
    let (p, q) = (piece.start + way.start.last(), piece.end + way.end.first());
    match &piece.circle {
        Some(circle) if !way.straight => turns_over(piece, circle, p, q),
        _ => {
            let along = match piece.circle {
                None => piece.exit,
                Some(_) => (piece.end - piece.start).unit().unwrap_or(piece.exit),
            };
            (q - p).dot(along) < -BACKWARDS
        }
    }
}

/// Whether the sweep of the nose path differs by more than half a turn.
fn turns_over(piece: &Piece, circle: &Circle, p: Point, q: Point) -> bool {
    let (first, last) = (p - circle.center, q - circle.center);
    let (start, end) = (piece.start - circle.center, piece.end - circle.center);
    let within_half = |one: Point, other: Point| one.cross(other) * circle.turn > 0.0;
    if within_half(start, end) && within_half(first, last) {
        return false;
    }
    let programmed = piece.sweep();
    // An arc shrunk to its centre has no sweep to compare.
    if first.length() <= BACKWARDS || last.length() <= BACKWARDS {
        return false;
    }
    let left = if (q - p).length() <= BACKWARDS && programmed < TAU {
        0.0
    } else {
        let left = sweep(first, last, circle.turn);
        if left <= 0.0 { TAU } else { left }
    };
    (left - programmed).abs() > PI
}
