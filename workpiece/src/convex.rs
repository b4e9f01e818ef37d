//! Convex polygons: hull, and what one sweeps over on its way.
//!
//! ```text
//!      ____                 ________________
//!     /    \    moved by   /                \
//!    | P    |   --------> |   hull of P and  |
//!     \____/               \   P moved      /
//!                           ----------------
//! ```
//!
//! A convex polygon sweeps along a straight line exactly over the hull of its first
//! and last position. Along a path of several lines the outline is the convolution of
//! the polygon with the path walked there and back:
//!
//! ```text
//!        ____              ________
//!       / P  \            /        \___
//!      0------1      ->   |             \      each piece of the path once on each
//!              \          \___    2     |     side, the edges of P between them
//!               2              \_______/
//! ```

use crate::grid::{Contour, GridPoint, moved, turn};
use crate::region::Bounds;

/// The convex hull, counter-clockwise, without points on its edges. Fewer than three
/// points that are not on a line give an empty one.
pub fn hull(points: impl IntoIterator<Item = GridPoint>) -> Contour {
    let mut points: Vec<GridPoint> = points.into_iter().collect();
    points.sort_unstable_by_key(|point| (point.x, point.y));
    points.dedup();
    if points.len() < 3 {
        return Contour::new();
    }
    // Andrew's monotone chain: the lower side, then the upper one.
    let mut hull: Contour = Vec::with_capacity(points.len() + 1);
    chain(&mut hull, 0, points.iter().copied());
    let lower = hull.len() - 1;
    chain(&mut hull, lower, points.iter().rev().skip(1).copied());
    hull.pop();
    if hull.len() < 3 { Contour::new() } else { hull }
}

/// Adds points that turn left; those from `kept` on may be taken back.
fn chain(hull: &mut Contour, kept: usize, points: impl Iterator<Item = GridPoint>) {
    for point in points {
        while let [.., a, b] = hull[kept..]
            && turn(a, b, point) <= 0
        {
            hull.pop();
        }
        hull.push(point);
    }
}

/// What a convex polygon sweeps over on a straight way from one position to another.
pub fn sweep(polygon: &[GridPoint], from: GridPoint, to: GridPoint) -> Contour {
    let at = |by: GridPoint| polygon.iter().map(move |point| moved(*point, by));
    if from == to {
        return at(from).collect();
    }
    hull(at(from).chain(at(to)))
}

/// What a convex polygon sweeps over on a path, as one closed polygon. Where the path
/// bends more than the polygon can follow, and where it crosses itself, the outline
/// crosses itself, too: a point lies in the sweep where it goes round it at least once.
pub fn sweep_along(polygon: &[GridPoint], path: &[GridPoint]) -> Contour {
    let mut path = path.to_vec();
    path.dedup();
    match path[..] {
        [] => return Contour::new(),
        [from] => return sweep(polygon, from, from),
        [from, to] => return sweep(polygon, from, to),
        _ => {}
    }
    if polygon.len() < 3 {
        return Contour::new();
    }
    let back = path.iter().rev().skip(1);
    let walk: Vec<GridPoint> = path.iter().chain(back).copied().collect();
    // The walk ends where it begins, turned about: the first piece follows the last.
    let pieces = walk.len() - 1;
    let mut outline = Contour::with_capacity(2 * pieces + 2 * polygon.len());
    let mut corner = extreme(polygon, 0, walk[pieces - 1], walk[pieces]);
    for (index, pair) in walk.windows(2).enumerate() {
        let (from, to) = (pair[0], pair[1]);
        let before = walk[(index + pieces - 1) % pieces];
        let leading = extreme(polygon, corner, from, to);
        let bend = turn(before, from, to);
        outline.push(moved(polygon[corner], from));
        while corner != leading {
            let count = polygon.len();
            // A turn to the right goes back over edges of the polygon.
            corner = (corner + if bend < 0 { count - 1 } else { 1 }) % count;
            outline.push(moved(polygon[corner], from));
        }
        outline.push(moved(polygon[corner], to));
    }
    outline.dedup();
    outline
}

/// The corner of a convex polygon that lies farthest to the right of a direction; the
/// last of two. The search begins at a corner that may be near it.
fn extreme(polygon: &[GridPoint], begin: usize, from: GridPoint, to: GridPoint) -> usize {
    let (dx, dy) = (
        i64::from(to.x) - i64::from(from.x),
        i64::from(to.y) - i64::from(from.y),
    );
    // How far a step along the polygon goes to the right.
    let gain = |a: usize, b: usize| {
        let (a, b) = (polygon[a], polygon[b]);
        (i64::from(b.x) - i64::from(a.x)) * dy - (i64::from(b.y) - i64::from(a.y)) * dx
    };
    let count = polygon.len();
    let mut at = begin;
    // Once round finds it from everywhere: the gain changes its sign twice.
    for _ in 0..count {
        let previous = (at + count - 1) % count;
        if gain(previous, at) >= 0 {
            break;
        }
        at = previous;
    }
    for _ in 0..count {
        let next = (at + 1) % count;
        if gain(at, next) < 0 {
            break;
        }
        at = next;
    }
    at
}

/// A convex polygon made smaller about its middle, so that each side comes in by at
/// least `by` at its nearest point, grid units. One that is too small vanishes.
pub fn shrunk(polygon: &[GridPoint], by: i32) -> Contour {
    let Some(bounds) = Bounds::of(polygon) else {
        return Contour::new();
    };
    let middle = |low: i32, high: i32| (f64::from(low) + f64::from(high)) / 2.0;
    let (z, x) = (
        middle(bounds.low.x, bounds.high.x),
        middle(bounds.low.y, bounds.high.y),
    );
    let size = (bounds.high.x - bounds.low.x).min(bounds.high.y - bounds.low.y);
    let factor = 1.0 - 2.0 * f64::from(by) / f64::from(size).max(1.0);
    if factor <= 0.0 {
        return Contour::new();
    }
    let toward =
        |value: i32, middle: f64| libm::round(middle + (f64::from(value) - middle) * factor) as i32;
    hull(
        polygon
            .iter()
            .map(|point| GridPoint::new(toward(point.x, z), toward(point.y, x))),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: i32, y: i32) -> GridPoint {
        GridPoint::new(x, y)
    }

    #[test]
    fn a_hull_goes_round_counter_clockwise_without_points_on_its_edges() {
        let points = [
            point(0, 0),
            point(10, 0),
            point(5, 0),
            point(10, 10),
            point(5, 5),
            point(0, 10),
        ];
        assert_eq!(
            hull(points),
            [point(0, 0), point(10, 0), point(10, 10), point(0, 10)]
        );
        assert!(hull([point(0, 0), point(1, 1), point(2, 2)]).is_empty());
        assert!(hull([]).is_empty());
    }

    #[test]
    fn a_square_sweeps_over_a_hexagon() {
        let square = [point(0, 0), point(2, 0), point(2, 2), point(0, 2)];
        assert_eq!(
            sweep(&square, point(0, 0), point(10, 10)),
            [
                point(0, 0),
                point(2, 0),
                point(12, 10),
                point(12, 12),
                point(10, 12),
                point(0, 2)
            ]
        );
    }
}
