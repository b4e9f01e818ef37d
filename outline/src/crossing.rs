//! Finds where two pieces meet, and where an outline crosses itself.

use gsk_units::Point;

use crate::drawing::TracedPiece;
use crate::piece::ProfilePiece;

/// The entities of two pieces that cross, and where; `None` for an outline without crossing.
pub(crate) fn find_crossing(outline: &[TracedPiece], gap: f64) -> Option<(usize, usize, Point)> {
    // Pieces in the order of their least Z: only those that overlap along Z are compared.
    let bounds: Vec<_> = outline.iter().map(|it| it.piece.bounds()).collect();
    let mut order: Vec<usize> = (0..outline.len()).collect();
    order.sort_by(|a, b| bounds[*a].0.z.total_cmp(&bounds[*b].0.z));
    for (place, one) in order.iter().copied().enumerate() {
        let right = bounds[one].1.z;
        let near = order[place + 1..].iter().copied();
        for other in near.take_while(|other| bounds[*other].0.z <= right) {
            let is_apart =
                bounds[one].1.x < bounds[other].0.x || bounds[other].1.x < bounds[one].0.x;
            if is_apart {
                continue;
            }
            let (first, second) = (one.min(other), one.max(other));
            let crossing = cross_pieces(&outline[first].piece, &outline[second].piece, gap);
            if let Some(at) = crossing {
                return Some((outline[first].entity, outline[second].entity, at));
            }
        }
    }
    None
}

/// A point that two pieces share, apart from common ends.
fn cross_pieces(one: &ProfilePiece, other: &ProfilePiece, gap: f64) -> Option<Point> {
    let is_inside = |piece: &ProfilePiece, point: Point| {
        let at = piece.fraction_of(point);
        (0.0..=1.0).contains(&at)
    };
    let is_common_end = |point: Point| {
        let is_end = |piece: &ProfilePiece| {
            (piece.start - point).length() <= gap || (piece.end - point).length() <= gap
        };
        is_end(one) && is_end(other)
    };
    let points = meeting_points(one, other);
    (points.into_iter())
        .find(|point| is_inside(one, *point) && is_inside(other, *point) && !is_common_end(*point))
}

/// The points that the whole lines or circles of two pieces share; of two parallel lines the
/// middle of the common part.
pub fn meeting_points(one: &ProfilePiece, other: &ProfilePiece) -> Vec<Point> {
    match (one.center(), other.center()) {
        (None, None) => {
            let (along, across) = (one.chord(), other.chord());
            let determinant = along.cross(across);
            if determinant.abs() <= 1e-12 * along.length() * across.length() {
                return overlap_middle(one, other).into_iter().collect();
            }
            let fraction = (other.start - one.start).cross(across) / determinant;
            vec![one.start + along * fraction]
        }
        (Some(center), None) => line_and_circle(other, center, one.radius()),
        (None, Some(center)) => line_and_circle(one, center, other.radius()),
        (Some(first), Some(second)) => two_circles((first, one), (second, other)),
    }
}

/// The middle of the common part of two parallel lines.
fn overlap_middle(one: &ProfilePiece, other: &ProfilePiece) -> Option<Point> {
    let along = one.chord().unit()?;
    if along.cross(other.start - one.start).abs() > 1e-9 {
        return None;
    }
    let position = |point: Point| along.dot(point - one.start);
    let (from, to) = (position(other.start), position(other.end));
    let low = from.min(to).max(0.0);
    let high = from.max(to).min(one.chord().length());
    (high - low > 0.0).then(|| one.start + along * f64::midpoint(low, high))
}

fn line_and_circle(line: &ProfilePiece, center: Point, radius: f64) -> Vec<Point> {
    let Some(along) = line.chord().unit() else {
        return Vec::new();
    };
    let foot = line.start + along * along.dot(center - line.start);
    let distance = (center - foot).length();
    if distance > radius {
        return Vec::new();
    }
    let half = (radius * radius - distance * distance).max(0.0).sqrt();
    vec![foot + along * half, foot - along * half]
}

fn two_circles(
    (first, one): (Point, &ProfilePiece),
    (second, other): (Point, &ProfilePiece),
) -> Vec<Point> {
    let between = second - first;
    let distance = between.length();
    let (r, s) = (one.radius(), other.radius());
    if distance <= 1e-9 {
        // One circle: the pieces overlap where the middle of one is within the other.
        let is_same = (r - s).abs() <= 1e-9;
        return if is_same {
            vec![one.point_at(0.5), other.point_at(0.5)]
        } else {
            Vec::new()
        };
    }
    if distance > r + s || distance < (r - s).abs() {
        return Vec::new();
    }
    let along = (distance * distance + r * r - s * s) / (2.0 * distance);
    let across = (r * r - along * along).max(0.0).sqrt();
    let direction = between * (1.0 / distance);
    let foot = first + direction * along;
    vec![
        foot + direction.left() * across,
        foot - direction.left() * across,
    ]
}
