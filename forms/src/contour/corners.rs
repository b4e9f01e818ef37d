//! Rounds and chamfers the corners between the pieces of an outline.

use gsk_messages::{Message, say};
use gsk_outline::{ProfilePiece, meeting_points};

use super::path::SolvedPiece;
use super::points::CornerShape;
use crate::thousandths::Thousandths;

/// Angle below which two pieces are tangent, as its sine.
const TANGENT_SINE: f64 = 1e-6;
/// Tolerance of a fraction of a piece.
const TOLERANCE: f64 = 1e-7;

/// The pieces with their corners as arcs and chamfers. `side` is −1 if X is mirrored, for
/// messages.
pub(crate) fn round_corners(
    pieces: &[SolvedPiece],
    side: f64,
) -> Result<Vec<ProfilePiece>, Message> {
    let mut rounded: Vec<ProfilePiece> = Vec::new();
    let mut corner = CornerShape::Sharp;
    for solved in pieces {
        let mut next = solved.piece;
        let at = next.start;
        if let Some(mut last) = rounded.pop() {
            let between = match corner {
                CornerShape::Sharp => Some(None),
                CornerShape::Radius(radius) => fillet(&mut last, &mut next, radius.value()),
                CornerShape::Chamfer(length) => chamfer(&mut last, &mut next, length.value()),
            };
            let between = between.ok_or_else(|| {
                let (x, z) = (at.x * side * 2.0, at.z);
                say::form_corner_too_large(Thousandths::round(x), Thousandths::round(z))
            })?;
            rounded.push(last);
            rounded.extend(between);
        }
        rounded.push(next);
        corner = solved.corner;
    }
    rounded.retain(|piece| piece.length() > TOLERANCE);
    Ok(rounded)
}

/// Shortens two pieces to an arc that touches both, which is returned; it is missing between
/// pieces that touch each other. `None` if the arc does not fit.
fn fillet(
    one: &mut ProfilePiece,
    two: &mut ProfilePiece,
    radius: f64,
) -> Option<Option<ProfilePiece>> {
    let (arriving, leaving) = (one.direction_at(1.0), two.direction_at(0.0));
    let sine = arriving.cross(leaving);
    if sine.abs() < TANGENT_SINE {
        return Some(None);
    }
    let right = if sine > 0.0 { -radius } else { radius };
    let (moved_one, moved_two) = (one.moved_right(right)?, two.moved_right(right)?);
    let corner = one.end;
    let range = -TOLERANCE..=1.0 + TOLERANCE;
    let fitting = meeting_points(&moved_one, &moved_two).into_iter();
    let fitting = fitting.filter_map(|center| {
        let fractions = (one.fraction_of(center), two.fraction_of(center));
        let fits = range.contains(&fractions.0) && range.contains(&fractions.1);
        fits.then(|| {
            (
                center,
                (fractions.0.clamp(0.0, 1.0), fractions.1.clamp(0.0, 1.0)),
            )
        })
    });
    let (_, (end, begin)) = fitting.min_by(|a, b| {
        let distance = |it: &gsk_units::Point| (*it - corner).length();
        distance(&a.0).total_cmp(&distance(&b.0))
    })?;
    let (from, to) = (one.direction_at(end), two.direction_at(begin));
    let sweep = libm::atan2(from.cross(to), from.dot(to));
    let arc = ProfilePiece {
        start: one.point_at(end),
        end: two.point_at(begin),
        bulge: libm::tan(sweep / 4.0),
    };
    *one = one.split_at(end).0;
    *two = two.split_at(begin).1;
    Some(Some(arc))
}

/// Shortens two pieces by a length along each, and returns the line between; `None` if they
/// are too short.
fn chamfer(
    one: &mut ProfilePiece,
    two: &mut ProfilePiece,
    length: f64,
) -> Option<Option<ProfilePiece>> {
    let (end, begin) = (1.0 - length / one.length(), length / two.length());
    if end < -TOLERANCE || begin > 1.0 + TOLERANCE {
        return None;
    }
    *one = one.split_at(end.max(0.0)).0;
    *two = two.split_at(begin.min(1.0)).1;
    Some(Some(ProfilePiece::line(one.end, two.start)))
}
