//! Interference check: a move whose nose path runs opposite to the programmed one would cut
//! into the part (manual II, C compensation).
//!
//! ```text
//!        p .        q
//!   ---. .  `.    .'  .---       p = start + its last vector
//!      |.     `. .'   |          q = end + its first vector
//!      |  q <-- p     |          bottom: programmed to the left, nose path to
//!      '--------------'          the right: alarm 057
//! ```
//!
//! The nose must not cut into neighbouring moves either: the moves just run, and the next
//! one, which has been read.
//!
//! Before it raises the alarm, the check drops vectors of corners with several vectors one
//! by one. An arc is then run as a straight line.

use core::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use super::clearance::{self, Curve, ROUNDING_MM};
use super::corner::CornerVectors;
use super::fault::CompensationFault;
use super::plane::sweep;
use super::segment::{Circle, ContourSegment, is_too_short};
use crate::units::Point;

/// Greatest motion opposite to the programmed direction that counts as rounding, mm.
const BACKWARDS_MM: f64 = 1e-6;
/// Greatest depth to which the nose may cut into an arc whose end is off its circle, mm: the nose
/// path is parallel to such an arc only while the radius changes slowly.
const TILTED_ARC_MM: f64 = 0.0005;

/// The vectors at both ends of a move that the interference check has not dropped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EndVectors {
    pub(super) start: CornerVectors,
    pub(super) end: CornerVectors,
    /// Whether the move, an arc, is run as a straight line.
    pub(super) straight: bool,
}

impl EndVectors {
    /// All vectors of both corners, before the interference check drops any; an arc remains an arc.
    pub(super) const fn with_all_vectors(start: CornerVectors, end: CornerVectors) -> Self {
        Self {
            start,
            end,
            straight: false,
        }
    }
}

/// The programmed surface and the path of the nose centre of an executed move.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct ExecutedPath {
    surface: Curve,
    path: Curve,
    /// Whether the nose path is parallel to the surface; a straight line instead of an arc is
    /// not.
    parallel: bool,
    /// Distance of the nose centre to the left of the move, mm; negative to the right.
    pub(super) rho: f64,
}

impl ExecutedPath {
    /// The content of an entry before its first use.
    const EMPTY: Self = {
        let none = Curve::line(Point::new(0.0, 0.0), Point::new(0.0, 0.0));
        Self {
            surface: none,
            path: none,
            parallel: false,
            rho: 0.0,
        }
    };

    /// Overwrites this entry with the surface and the nose path of the move `piece`. `rho` is the
    /// distance of the nose centre to the left of the move, mm.
    #[inline(always)]
    fn set_from(&mut self, piece: &ContourSegment, way: &EndVectors, rho: f64) {
        let (p, q) = (piece.start + way.start.last(), piece.end + way.end.first());
        match &piece.circle {
            Some(circle) if !way.straight && !is_too_short(piece, circle, p, q) => {
                self.path = Curve::parallel_arc(p, q, circle, piece);
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

    /// The programmed end point of the move, mm.
    pub(super) const fn end(&self) -> Point {
        self.surface.to
    }
}

/// Number of earlier moves with which a move is checked for interference.
const MOVES_BEFORE: usize = 3;

/// The paths of the last moves since the contour was interrupted, and of the move that is being
/// checked.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct RecentPaths {
    kept: Vec<ExecutedPath>,
    /// Index in `kept` of the entry to be written next; once the list is full, the oldest one.
    next: usize,
}

impl RecentPaths {
    /// Removes the paths of all moves.
    pub(super) fn clear(&mut self) {
        self.kept.clear();
        self.next = 0;
    }

    /// The path of the last committed move; `None` without one.
    pub(super) fn last(&self) -> Option<&ExecutedPath> {
        let last = (self.next + MOVES_BEFORE) % (MOVES_BEFORE + 1);
        self.kept.get(last)
    }

    /// Removes all moves but the last committed one.
    pub(super) fn keep_last(&mut self) {
        if let Some(last) = self.last().copied() {
            self.clear();
            self.kept.push(last);
            self.commit();
        }
    }

    /// Writes the surface and the path of the move `piece`, which is still to be checked, into the
    /// next entry. `rho` is the distance of the nose centre to its left, mm.
    #[inline(always)]
    pub(super) fn stage(&mut self, piece: &ContourSegment, way: &EndVectors, rho: f64) {
        if self.kept.len() == self.next {
            self.kept.push(ExecutedPath::EMPTY);
        }
        if let Some(oldest) = self.kept.get_mut(self.next) {
            oldest.set_from(piece, way, rho);
        }
    }

    /// The path of the staged move, and those of earlier moves with the nose at the same
    /// distance on the same side; `None` if no move is staged.
    #[inline(always)]
    pub(super) fn staged(&self) -> Option<(&ExecutedPath, EarlierPaths<'_>)> {
        let (before, from) = self.kept.split_at_checked(self.next)?;
        let (laid, after) = from.split_first()?;
        let mut all = EarlierPaths {
            list: [laid; MOVES_BEFORE],
            count: 0,
        };
        for trails in [before, after] {
            for trail in trails {
                if trail.rho == laid.rho
                    && let Some(slot) = all.list.get_mut(all.count)
                {
                    *slot = trail;
                    all.count += 1;
                }
            }
        }
        Some((laid, all))
    }

    /// Keeps the staged move as executed, for the checks of later moves.
    pub(super) const fn commit(&mut self) {
        self.next = (self.next + 1) % (MOVES_BEFORE + 1);
    }
}

/// References to the paths of earlier moves, in no particular order.
#[derive(Clone, Copy)]
pub(super) struct EarlierPaths<'a> {
    list: [&'a ExecutedPath; MOVES_BEFORE],
    count: usize,
}

impl<'a> EarlierPaths<'a> {
    pub(super) fn as_slice(&self) -> &[&'a ExecutedPath] {
        self.list.get(..self.count).unwrap_or(&[])
    }
}

/// Whether the nose would cut into the part: around the corner at the start of the move
/// `trail` or along it, into the moves `before`, the move itself or the `next` one, or on the
/// earlier moves into the next one. `last` is the latest of `before`.
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
/// A line whose two ends are meeting points cannot cut into the lines that it meets there:
/// those are not checked.
pub(super) fn does_cut_neighbours(
    before: &[&ExecutedPath],
    last: Option<&ExecutedPath>,
    start: Point,
    way: &EndVectors,
    trail: &ExecutedPath,
    next: Option<&ContourSegment>,
) -> bool {
    let radius = trail.rho.abs();
    let next = next.map(Curve::surface);
    let cuts = |path: &Curve, surface: &Curve| {
        clearance::is_closer_than(path, surface, radius - ROUNDING_MM)
    };
    let own = if trail.parallel {
        let (path, surface) = (&trail.path, &trail.surface);
        surface.radius_deviation() > TILTED_ARC_MM / 2.0
            && clearance::is_closer_than(path, surface, radius - TILTED_ARC_MM)
    } else {
        cuts(&trail.path, &trail.surface)
    };
    let around = |path: &Curve, into: f64, met: Option<&ExecutedPath>, next: Option<&Curve>| {
        let cuts = |surface: &Curve| clearance::is_closer_than(path, surface, radius - into);
        let is_met = |before: &ExecutedPath| met.is_some_and(|met| core::ptr::eq(before, met));
        (before.iter()).any(|before| !is_met(before) && cuts(&before.surface))
            || next.is_some_and(cuts)
    };
    // Where the radius of an arc shrinks, the nose comes closer to the moves beside it by
    // that amount, and starts the next move at that distance.
    let loosest = before
        .iter()
        .map(|before| before.surface.radius_deviation())
        .fold(trail.surface.radius_deviation(), f64::max);
    let shrinks = (2.0 * loosest + ROUNDING_MM).min(TILTED_ARC_MM);
    let between = trail.surface.is_line() && way.start.meets && way.end.meets;
    let met = last.filter(|last| between && last.surface.is_line());
    let unmet = next.as_ref().filter(|next| !(between && next.is_line()));
    if own || around(&trail.path, shrinks.max(ROUNDING_MM), met, unmet) {
        return true;
    }
    if before.is_empty() {
        return false;
    }
    let mut corner = way.start.as_slice().windows(2);
    corner.any(|pair| match pair {
        [one, other] => {
            let path = Curve::line(start + *one, start + *other);
            cuts(&path, &trail.surface) || around(&path, ROUNDING_MM, None, next.as_ref())
        }
        _ => false,
    }) || next.is_some_and(|next| before.iter().any(|before| cuts(&before.path, &next)))
}

/// Drops vectors from both ends of a move until its nose path no longer runs opposite to the
/// programmed direction.
///
/// # Errors
/// Alarm 057: it still does with one vector at each end.
#[inline]
pub(super) fn drop_interfering_vectors(
    piece: &ContourSegment,
    way: &mut EndVectors,
) -> Result<(), CompensationFault> {
    while interferes(piece, way) {
        match (way.start.is_single(), way.end.is_single()) {
            (true, true) => return Err(CompensationFault::Interference),
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

fn interferes(piece: &ContourSegment, way: &EndVectors) -> bool {
    let (p, q) = (piece.start + way.start.last(), piece.end + way.end.first());
    match &piece.circle {
        Some(circle) if !way.straight => is_reversed(piece, circle, p, q),
        _ => {
            let along = match piece.circle {
                None => piece.exit,
                Some(_) => (piece.end - piece.start).unit().unwrap_or(piece.exit),
            };
            (q - p).dot(along) < -BACKWARDS_MM
        }
    }
}

/// Whether the nose path from `p` to `q` beside an arc runs opposite to the arc: its sweep differs
/// from the programmed one by more than half a turn.
fn is_reversed(piece: &ContourSegment, circle: &Circle, p: Point, q: Point) -> bool {
    let (first, last) = (p - circle.center, q - circle.center);
    let (start, end) = (piece.start - circle.center, piece.end - circle.center);
    let within_half = |one: Point, other: Point| one.cross(other) * circle.turn > 0.0;
    if within_half(start, end) && within_half(first, last) {
        return false;
    }
    let programmed = piece.sweep();
    // An arc shrunk to its centre has no sweep to compare.
    if first.length() <= BACKWARDS_MM || last.length() <= BACKWARDS_MM {
        return false;
    }
    let left = if (q - p).length() <= BACKWARDS_MM && programmed < TAU {
        0.0
    } else {
        let left = sweep(first, last, circle.turn);
        if left <= 0.0 { TAU } else { left }
    };
    (left - programmed).abs() > PI
}
