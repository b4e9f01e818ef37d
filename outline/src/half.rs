//! Takes the half of a drawing above its axis.

use gsk_messages::say;
use gsk_units::Point;

use crate::drawing::{Drawing, DrawingFault, MAX_FAULTS, TracedPiece};
use crate::piece::ProfilePiece;

/// The pieces above the axis; those on it are left out. Pieces below it must be the mirror
/// image of those above, or there are none above: then they are mirrored.
///
/// # Errors
/// The pieces below the axis without a counterpart above.
pub(crate) fn take_upper_half(
    drawing: &Drawing,
    pieces: &[TracedPiece],
    gap: f64,
) -> Result<Vec<TracedPiece>, Vec<DrawingFault>> {
    let parts = pieces.iter().flat_map(|it| {
        let parts = split_at_axis(&it.piece, gap);
        parts.into_iter().map(|part| it.with(part))
    });
    let (mut upper, mut lower) = (Vec::new(), Vec::new());
    for part in parts {
        let height = part.piece.point_at(0.5).x;
        if height > gap {
            upper.push(part);
        } else if height < -gap {
            lower.push(part.with(part.piece.mirrored()));
        } else if is_above_by_an_end(&part.piece, gap) {
            upper.push(part);
        }
    }
    if upper.is_empty() {
        return Ok(lower);
    }
    let unmatched = (lower.iter()).filter(|below| !has_counterpart(below, &upper, gap));
    let faults = unmatched.map(|below| {
        let at = below.piece.point_at(0.5);
        let name = drawing.entity_name(below.entity);
        let message = say::outline_not_symmetric(name, at.x * 2.0, at.z);
        DrawingFault::new(message, Point::new(-at.x, at.z))
    });
    let faults: Vec<DrawingFault> = faults.take(MAX_FAULTS).collect();
    match faults.is_empty() {
        true => Ok(upper),
        false => Err(faults),
    }
}

/// Whether a piece with its middle near the axis still begins or ends above it.
fn is_above_by_an_end(piece: &ProfilePiece, gap: f64) -> bool {
    piece.start.x > gap || piece.end.x > gap
}

/// Whether one of the pieces has the same ends and the same middle.
fn has_counterpart(piece: &TracedPiece, others: &[TracedPiece], gap: f64) -> bool {
    let is_near = |a: Point, b: Point| (a - b).length() <= 2.0 * gap;
    let own = &piece.piece;
    others.iter().map(|other| &other.piece).any(|other| {
        let same = is_near(own.start, other.start) && is_near(own.end, other.end);
        let reversed = is_near(own.start, other.end) && is_near(own.end, other.start);
        (same || reversed) && is_near(own.point_at(0.5), other.point_at(0.5))
    })
}

/// The parts of a piece on each side of the axis.
fn split_at_axis(piece: &ProfilePiece, gap: f64) -> Vec<ProfilePiece> {
    let (low, high) = piece.bounds();
    if low.x >= -gap || high.x <= gap {
        return vec![*piece];
    }
    let mut fractions: Vec<f64> = match piece.center() {
        None => vec![-piece.start.x / piece.chord().x],
        Some(center) => {
            let square = piece.radius() * piece.radius() - center.x * center.x;
            let half = square.max(0.0).sqrt();
            let crossings = [center.z - half, center.z + half];
            crossings
                .map(|z| piece.fraction_of(Point::new(0.0, z)))
                .into()
        }
    };
    fractions.retain(|at| (1e-9..=1.0 - 1e-9).contains(at));
    fractions.sort_by(f64::total_cmp);
    let mut parts = Vec::new();
    let (mut rest, mut done) = (*piece, 0.0);
    for at in fractions {
        let (mut first, mut second) = rest.split_at((at - done) / (1.0 - done));
        first.end.x = 0.0;
        second.start.x = 0.0;
        parts.push(first);
        (rest, done) = (second, at);
    }
    parts.push(rest);
    parts
}
