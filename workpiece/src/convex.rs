//! Convex polygons: hull, shrinking, and the area swept along a path.
//!
//! ```text
//!      ____                 ________________
//!     /    \    moved by   /                \
//!    | P    |   --------> |   hull of P and  |
//!     \____/               \   P moved      /
//!                           ----------------
//! ```
//!
//! The area that a convex polygon sweeps along a straight line is the hull of its first
//! and last position. Along a path of several lines the outline is the convolution of
//! the polygon with the path, traversed forward and back:
//!
//! ```text
//!        ____              ________
//!       / P  \            /        \___
//!      0------1      ->   |             \      each line of the path once on each
//!              \          \___    2     |     side, edges of P between them
//!               2              \_______/
//! ```

use crate::grid::{GridContour, GridPoint, orientation, translated};
use crate::region::GridBounds;

/// Computes the convex hull of points, counter-clockwise, without points on its edges.
/// The hull is empty if all points lie on one line.
pub fn convex_hull(points: impl IntoIterator<Item = GridPoint>) -> GridContour {
    let mut points: Vec<GridPoint> = points.into_iter().collect();
    points.sort_unstable_by_key(|point| (point.x, point.y));
    points.dedup();
    if points.len() < 3 {
        return GridContour::new();
    }
    // Andrew's monotone chain: the lower side, then the upper one.
    let mut hull: GridContour = Vec::with_capacity(points.len() + 1);
    extend_chain(&mut hull, 0, points.iter().copied());
    let lower = hull.len() - 1;
    extend_chain(&mut hull, lower, points.iter().rev().skip(1).copied());
    hull.pop();
    if hull.len() < 3 {
        GridContour::new()
    } else {
        hull
    }
}

/// Appends points and keeps the chain turning left. Points from index `kept` on may be removed
/// again.
fn extend_chain(hull: &mut GridContour, kept: usize, points: impl Iterator<Item = GridPoint>) {
    for point in points {
        while let [.., a, b] = hull[kept..]
            && orientation(a, b, point) <= 0
        {
            hull.pop();
        }
        hull.push(point);
    }
}

/// Computes the area that a convex polygon sweeps on a straight line: the hull of both positions.
/// Its zero moves from `from` to `to`. The polygon is one of [`convex_hull`].
///
/// ```text
///      __ v        v moved      edges that face the motion are moved, the others remain;
///     /  \----------->\         at a corner between both, the line from one position
///    | P  |           |        of the corner to the other joins them
///     \__/------------>/
/// ```
pub fn sweep(polygon: &[GridPoint], from: GridPoint, to: GridPoint) -> GridContour {
    let at = |by: GridPoint| polygon.iter().map(move |point| translated(*point, by));
    let Some(last) = polygon.last().filter(|_| from != to) else {
        return at(from).collect();
    };
    let mut outline = GridContour::with_capacity(polygon.len() + 2);
    let ends = |a, b| edge_ends_moved(a, b, from, to);
    let (_, mut arrives_moved) = ends(*last, polygon[0]);
    let next = polygon.iter().cycle().skip(1);
    for (corner, next) in polygon.iter().zip(next) {
        let (leaves_moved, next_arrives_moved) = ends(*corner, *next);
        let position = |is_moved| translated(*corner, if is_moved { to } else { from });
        outline.push(position(arrives_moved));
        if leaves_moved != arrives_moved {
            outline.push(position(leaves_moved));
        }
        arrives_moved = next_arrives_moved;
    }
    let first = (0..outline.len()).min_by_key(|at| (outline[*at].x, outline[*at].y));
    outline.rotate_left(first.unwrap_or_default());
    outline
}

/// Whether the beginning and the end of an edge of a swept polygon are on the moved polygon: both
/// if the edge faces the motion, neither if it faces away. An edge along the motion is a part of
/// the line that joins both positions.
fn edge_ends_moved(a: GridPoint, b: GridPoint, from: GridPoint, to: GridPoint) -> (bool, bool) {
    let wide = |a: GridPoint, b: GridPoint| {
        let difference = |a: i32, b: i32| i64::from(b) - i64::from(a);
        (difference(a.x, b.x), difference(a.y, b.y))
    };
    let (edge, motion) = (wide(a, b), wide(from, to));
    let across = edge.0 * motion.1 - edge.1 * motion.0;
    if across != 0 {
        return (across < 0, across < 0);
    }
    let is_forward = edge.0 * motion.0 + edge.1 * motion.1 > 0;
    (!is_forward, is_forward)
}

/// Computes the area that a convex polygon sweeps along a path of its zero, as one closed
/// polygon.
///
/// The outline crosses itself where the path does, and where a bend of the path is sharper
/// than the polygon. A point belongs to the area if its winding number is not 0.
pub fn sweep_along(polygon: &[GridPoint], path: &[GridPoint]) -> GridContour {
    let mut path = path.to_vec();
    path.dedup();
    match path[..] {
        [] => return GridContour::new(),
        [from] => return sweep(polygon, from, from),
        [from, to] => return sweep(polygon, from, to),
        _ => {}
    }
    if polygon.len() < 3 {
        return GridContour::new();
    }
    let back = path.iter().rev().skip(1);
    let walk: Vec<GridPoint> = path.iter().chain(back).copied().collect();
    // The walk ends where it begins, in the opposite direction: its first line follows
    // its last.
    let lines = walk.len() - 1;
    let mut outline = GridContour::with_capacity(2 * lines + 2 * polygon.len());
    let mut corner = rightmost_corner(polygon, 0, walk[lines - 1], walk[lines]);
    for (index, pair) in walk.windows(2).enumerate() {
        let (from, to) = (pair[0], pair[1]);
        let before = walk[(index + lines - 1) % lines];
        let leading = rightmost_corner(polygon, corner, from, to);
        let bend = orientation(before, from, to);
        outline.push(translated(polygon[corner], from));
        while corner != leading {
            let count = polygon.len();
            // At a right turn the outline follows the edges of the polygon backwards.
            corner = (corner + if bend < 0 { count - 1 } else { 1 }) % count;
            outline.push(translated(polygon[corner], from));
        }
        outline.push(translated(polygon[corner], to));
    }
    outline.dedup();
    outline
}

/// Finds the index of the corner of a convex polygon that is farthest to the right of the
/// direction from `from` to `to`; of two equal corners the last one. The search starts at
/// corner `begin`: the nearer it is, the shorter the search.
fn rightmost_corner(polygon: &[GridPoint], begin: usize, from: GridPoint, to: GridPoint) -> usize {
    let (dx, dy) = (
        i64::from(to.x) - i64::from(from.x),
        i64::from(to.y) - i64::from(from.y),
    );
    // How far the edge from `a` to `b` leads to the right.
    let gain = |a: usize, b: usize| {
        let (a, b) = (polygon[a], polygon[b]);
        (i64::from(b.x) - i64::from(a.x)) * dy - (i64::from(b.y) - i64::from(a.y)) * dx
    };
    let count = polygon.len();
    let mut at = begin;
    // One round is enough from any start: the gain changes its sign twice.
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

/// Scales a convex polygon down about its centre until each side of its bounding box is at
/// least `by` grid units farther in. A polygon that is too small becomes empty.
pub fn shrink(polygon: &[GridPoint], by: i32) -> GridContour {
    let Some(bounds) = GridBounds::from_points(polygon) else {
        return GridContour::new();
    };
    let middle = |low: i32, high: i32| (f64::from(low) + f64::from(high)) / 2.0;
    let (z, x) = (
        middle(bounds.low.x, bounds.high.x),
        middle(bounds.low.y, bounds.high.y),
    );
    let size = (bounds.high.x - bounds.low.x).min(bounds.high.y - bounds.low.y);
    let factor = 1.0 - 2.0 * f64::from(by) / f64::from(size).max(1.0);
    if factor <= 0.0 {
        return GridContour::new();
    }
    let toward =
        |value: i32, middle: f64| libm::round(middle + (f64::from(value) - middle) * factor) as i32;
    convex_hull(
        polygon
            .iter()
            .map(|point| GridPoint::new(toward(point.x, z), toward(point.y, x))),
    )
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn point(x: i32, y: i32) -> GridPoint {
        GridPoint::new(x, y)
    }

    #[test]
    fn a_hull_is_counter_clockwise_without_points_on_its_edges() {
        let points = [
            point(0, 0),
            point(10, 0),
            point(5, 0),
            point(10, 10),
            point(5, 5),
            point(0, 10),
        ];
        assert_eq!(
            convex_hull(points),
            [point(0, 0), point(10, 0), point(10, 10), point(0, 10)]
        );
        assert!(convex_hull([point(0, 0), point(1, 1), point(2, 2)]).is_empty());
        assert!(convex_hull([]).is_empty());
    }

    proptest! {
        #[test]
        fn a_sweep_is_the_hull_of_both_positions(
            (corners, from, to) in (
                prop::collection::vec((-9..10_i32, -9..10_i32), 3..12),
                (-3..4_i32, -3..4_i32),
                (-3..4_i32, -3..4_i32),
            )
        ) {
            let polygon = convex_hull(corners.iter().map(|(x, y)| point(*x, *y)));
            let (from, to) = (point(from.0, from.1), point(to.0, to.1));
            prop_assume!(from != to);
            let both = [from, to];
            let positions = both.iter().flat_map(|by| polygon.iter().map(|it| translated(*it, *by)));
            prop_assert_eq!(sweep(&polygon, from, to), convex_hull(positions));
        }
    }

    #[test]
    fn a_square_moved_diagonally_sweeps_a_hexagon() {
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
