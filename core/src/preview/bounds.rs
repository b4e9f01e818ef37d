//! Bounding box of a path.

use crate::command::{ExecutedMove, MoveKind};
use crate::units::{Point, max_not_nan, min_not_nan};

/// The smallest axis-parallel box around a path, mm; X as a radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathBounds {
    /// Least X and least Z of the path, mm.
    pub least: Point,
    /// Greatest X and greatest Z of the path, mm.
    pub greatest: Point,
}

impl PathBounds {
    const fn from_point(point: Point) -> Self {
        Self {
            least: point,
            greatest: point,
        }
    }

    /// Extends `bounds` by a move, including the bulge of an arc; if it is `None`, sets it to
    /// the box of the move.
    pub fn extend_by_move(bounds: &mut Option<Self>, executed: &ExecutedMove) {
        extend_bounds(bounds, executed);
    }

    fn contains(&self, point: Point) -> bool {
        (self.least.x..=self.greatest.x).contains(&point.x)
            && (self.least.z..=self.greatest.z).contains(&point.z)
    }

    fn extend_to(&mut self, point: Point) {
        let (least, greatest) = (&mut self.least, &mut self.greatest);
        least.x = min_not_nan(least.x, point.x);
        least.z = min_not_nan(least.z, point.z);
        greatest.x = max_not_nan(greatest.x, point.x);
        greatest.z = max_not_nan(greatest.z, point.z);
    }
}

/// Extends `bounds` by a move; see [`PathBounds::extend_by_move`].
pub(super) fn extend_bounds(bounds: &mut Option<PathBounds>, executed: &ExecutedMove) {
    let bounds = bounds.get_or_insert(PathBounds::from_point(executed.from));
    bounds.extend_to(executed.from);
    bounds.extend_to(executed.to);
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
        let (from_turn, to_turn) = (quarter_turns(first - center), quarter_turns(side));
        if normalize_angle(to_turn - from_turn) <= sweep_quarters(first - center, last - center) {
            bounds.extend_to(center + side);
        }
    }
}

const FULL_TURN: f64 = 4.0;

/// The counter-clockwise angle from one direction to another, in quarter turns; 4 (a full
/// turn) if they are equal.
fn sweep_quarters(from: Point, to: Point) -> f64 {
    let angle = normalize_angle(quarter_turns(to) - quarter_turns(from));
    if angle == 0.0 { FULL_TURN } else { angle }
}

/// Brings a difference of two directions, in quarter turns, into the range from 0 to 4.
fn normalize_angle(angle: f64) -> f64 {
    match angle {
        _ if angle < 0.0 => angle + FULL_TURN,
        _ if angle >= FULL_TURN => angle - FULL_TURN,
        _ => angle,
    }
}

/// Converts a direction to a number that grows with the angle from +Z, by one per quarter
/// turn. This is cheaper than computing the angle.
fn quarter_turns(direction: Point) -> f64 {
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
