//! Replaces a curve by arcs.

use gsk_units::Point;

use crate::piece::ProfilePiece;

/// Greatest distance of the arcs from their curve, mm.
pub(crate) const FIT_TOLERANCE_MM: f64 = 0.002;
/// Number of points at which an arc is compared with its curve.
const SAMPLES: u32 = 16;
/// How often a curve is halved at most.
const MAX_DEPTH: u32 = 12;

/// The arcs and lines that follow a curve from `from` to `to` within `tolerance`. `point_at`
/// gives its points.
pub(crate) fn fit_arcs(
    point_at: &dyn Fn(f64) -> Point,
    (from, to): (f64, f64),
    tolerance: f64,
) -> Vec<ProfilePiece> {
    let mut pieces = Vec::new();
    fit_span(point_at, (from, to), tolerance, MAX_DEPTH, &mut pieces);
    pieces
}

fn fit_span(
    point_at: &dyn Fn(f64) -> Point,
    (from, to): (f64, f64),
    tolerance: f64,
    depth: u32,
    pieces: &mut Vec<ProfilePiece>,
) {
    let middle = f64::midpoint(from, to);
    let piece = arc_through(point_at(from), point_at(middle), point_at(to));
    let deviates = || {
        (1..SAMPLES).any(|index| {
            let at = from + (to - from) * f64::from(index) / f64::from(SAMPLES);
            distance(&piece, point_at(at)) > tolerance
        })
    };
    if depth > 0 && (piece.chord().length() <= tolerance || piece.bulge.abs() > 1.0 || deviates()) {
        fit_span(point_at, (from, middle), tolerance, depth - 1, pieces);
        fit_span(point_at, (middle, to), tolerance, depth - 1, pieces);
    } else if piece.chord().length() > 0.0 {
        pieces.push(piece);
    }
}

/// The arc from one point through another to a third one; a line if they are in one line.
fn arc_through(start: Point, middle: Point, end: Point) -> ProfilePiece {
    let (first, second) = (middle - start, end - middle);
    // The directions of the two chords differ by half the angle of the arc.
    let half_sweep = libm::atan2(first.cross(second), first.dot(second));
    ProfilePiece {
        start,
        end,
        bulge: libm::tan(half_sweep / 2.0),
    }
}

/// The distance of a point from the line or circle of a piece.
fn distance(piece: &ProfilePiece, point: Point) -> f64 {
    match piece.center() {
        Some(center) => ((point - center).length() - piece.radius()).abs(),
        None => {
            let along = piece.chord().unit().unwrap_or_default();
            along.cross(point - piece.start).abs()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ellipse_becomes_arcs_within_the_tolerance() {
        let ellipse = |t: f64| Point::new(10.0 * libm::sin(t), 20.0 * libm::cos(t));
        let arcs = fit_arcs(&ellipse, (0.0, 6.0), FIT_TOLERANCE_MM);
        assert!((8..200).contains(&arcs.len()), "{}", arcs.len());
        for pair in arcs.windows(2) {
            assert_eq!(pair[0].end, pair[1].start);
        }
        for arc in &arcs {
            let Point { x, z } = arc.point_at(0.3);
            let level = libm::sqrt((x / 10.0) * (x / 10.0) + (z / 20.0) * (z / 20.0));
            assert!((level - 1.0).abs() < 0.000_5, "{level}");
        }
    }

    #[test]
    fn a_straight_curve_is_one_line() {
        let line = |t: f64| Point::new(t * t, 2.0 * t * t);
        let pieces = fit_arcs(&line, (0.0, 3.0), FIT_TOLERANCE_MM);
        assert_eq!(pieces.len(), 1);
        assert!(!pieces[0].is_arc());
    }
}
