//! Bounding box of a path.

use crate::command::{ExecutedMove, MoveKind};
use crate::units::Point;

/// The smallest axis-parallel box around a path, mm; X as a radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Least X and least Z.
    pub least: Point,
    /// Greatest X and greatest Z.
    pub greatest: Point,
}

impl Bounds {
    const fn at(point: Point) -> Self {
        Self {
            least: point,
            greatest: point,
        }
    }

    /// Extends a box by a move, including the bulge of an arc. `None` becomes the box of the
    /// move.
    pub fn widen(bounds: &mut Option<Self>, executed: &ExecutedMove) {
        include(bounds, executed);
    }

    fn contains(&self, point: Point) -> bool {
        (self.least.x..=self.greatest.x).contains(&point.x)
            && (self.least.z..=self.greatest.z).contains(&point.z)
    }

    fn take(&mut self, point: Point) {
        self.least = Point::new(self.least.x.min(point.x), self.least.z.min(point.z));
        self.greatest = Point::new(self.greatest.x.max(point.x), self.greatest.z.max(point.z));
    }
}

/// Extends a box by a move.
pub(super) fn include(bounds: &mut Option<Bounds>, executed: &ExecutedMove) {
    let bounds = bounds.get_or_insert(Bounds::at(executed.from));
    bounds.take(executed.from);
    bounds.take(executed.to);
    let Some(center) = executed.center else {
        return;
    };
    let (first, last) = match executed.kind {
        MoveKind::Clockwise => (executed.to, executed.from),
        _ => (executed.from, executed.to),
    };
    let radius = (executed.from - center).length();
    for side in [
        Point::new(radius, 0.0),
        Point::new(0.0, radius),
        Point::new(-radius, 0.0),
        Point::new(0.0, -radius),
    ] {
        if bounds.contains(center + side) {
            continue;
        }
        let (from, to) = (turn(first - center), turn(side));
        if wrapped(to - from) <= sweep(first - center, last - center) {
            bounds.take(center + side);
        }
    }
}

const FULL_TURN: f64 = 4.0;

/// The counter-clockwise angle from one direction to another, in quarter turns; a full turn
/// if they are equal.
fn sweep(from: Point, to: Point) -> f64 {
    let way = wrapped(turn(to) - turn(from));
    if way == 0.0 { FULL_TURN } else { way }
}

/// A difference of directions, normalized to less than a full turn.
fn wrapped(way: f64) -> f64 {
    match way {
        _ if way < 0.0 => way + FULL_TURN,
        _ if way >= FULL_TURN => way - FULL_TURN,
        _ => way,
    }
}

/// The direction as a number that grows with the angle from +Z by one per quarter turn. It
/// is cheaper than the angle.
fn turn(direction: Point) -> f64 {
    let size = direction.x.abs() + direction.z.abs();
    if size == 0.0 {
        return 0.0;
    }
    let across = direction.x / size;
    match (direction.z >= 0.0, direction.x >= 0.0) {
        (true, true) => across,
        (false, _) => 2.0 - across,
        (true, false) => FULL_TURN + across,
    }
}
