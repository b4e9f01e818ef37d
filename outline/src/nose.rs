//! The path of the centre of a nose that leaves an outline.
//!
//! ```text
//!      centre of the nose: the outline, moved by the nose radius to the right of the travel
//!   . - - - - .                       an arc keeps its centre: its radius grows outside and
//!   ___________\  outline             shrinks inside
//!               \
//!   outer corner: both lines are extended until they meet; beside an arc the nose rolls
//!   around the corner. Inner corner: both pieces end where they meet.
//! ```

use core::f64::consts::PI;

use gsk_units::Point;

use crate::crossing::meeting_points;
use crate::piece::ProfilePiece;

/// Pieces shorter than this are left out, mm.
const SHORTEST_MM: f64 = 1e-7;
/// Ends nearer than this are one point, mm.
const SAME_POINT_MM: f64 = 0.001_5;
/// Greatest angle between two pieces that are joined as if they were tangent, radians. The
/// nose deviates by its radius times an eighth of the square of the angle: less than 0.0001 mm.
const TANGENT_RADIANS: f64 = 0.02;
/// Greatest angle at which two lines are extended at an outer corner, radians.
const MITER_RADIANS: f64 = 2.0;
/// How much an arc may be smaller than the nose through rounding, mm.
const ROUNDING_MM: f64 = 0.001;
/// Number of points of a piece at which its distance is checked.
const SAMPLES: u32 = 16;

/// The path of the centre of a nose with this radius along the right side of an outline, whose
/// pieces begin where the last one ends.
///
/// # Errors
/// The point at which the outline is narrower than the nose.
pub fn follow_outline(outline: &[ProfilePiece], radius: f64) -> Result<Vec<ProfilePiece>, Point> {
    if radius <= 0.0 {
        return Ok(outline.to_vec());
    }
    let mut path: Vec<ProfilePiece> = Vec::new();
    // The piece of the outline to which the last piece of the path belongs.
    let mut last: Option<&ProfilePiece> = None;
    for piece in outline.iter().filter(|it| it.length() > SHORTEST_MM) {
        let Some(mut next) = move_right(piece, radius)? else {
            continue;
        };
        if let (Some(before), Some(mut moved)) = (last, path.pop()) {
            let around = join(before, piece, &mut moved, &mut next);
            let around = around.ok_or(piece.start)?;
            path.push(moved);
            path.extend(around);
        }
        path.push(next);
        last = Some(piece);
    }
    path.retain(|piece| piece.length() > SHORTEST_MM);
    Ok(path)
}

/// A point of the path at which a nose with this radius cuts into the outline; `None` if it
/// does nowhere.
pub fn find_gouge(path: &[ProfilePiece], outline: &[ProfilePiece], radius: f64) -> Option<Point> {
    let is_near = |point: Point| {
        let mut distances = outline.iter().map(|piece| {
            let at = piece.fraction_of(point).clamp(0.0, 1.0);
            (piece.point_at(at) - point).length()
        });
        distances.any(|distance| distance < radius - SAME_POINT_MM)
    };
    path.iter().find_map(|piece| {
        let mut samples = (0..=SAMPLES).map(|index| f64::from(index) / f64::from(SAMPLES));
        let mut points = samples.by_ref().map(|at| piece.point_at(at));
        points.find(|point| is_near(*point))
    })
}

/// The piece moved to the right of its travel; `None` for an arc of the size of the nose.
fn move_right(piece: &ProfilePiece, radius: f64) -> Result<Option<ProfilePiece>, Point> {
    if piece.bulge < 0.0 && piece.is_arc() && piece.radius() - radius < ROUNDING_MM {
        return match piece.radius() - radius < -ROUNDING_MM {
            true => Err(piece.point_at(0.5)),
            false => Ok(None),
        };
    }
    Ok(piece.moved_right(radius))
}

/// Joins two moved pieces at the corner between `before` and `after`. Returns the arc around
/// an outer corner, if there is one; `None` if the pieces do not meet.
fn join(
    before: &ProfilePiece,
    after: &ProfilePiece,
    one: &mut ProfilePiece,
    two: &mut ProfilePiece,
) -> Option<Option<ProfilePiece>> {
    let (arriving, leaving) = (before.direction_at(1.0), after.direction_at(0.0));
    let turn = libm::atan2(arriving.cross(leaving), arriving.dot(leaving));
    if (one.end - two.start).length() <= SAME_POINT_MM || turn.abs() < TANGENT_RADIANS {
        let middle = (one.end + two.start) * 0.5;
        one.end = middle;
        two.start = middle;
        return Some(None);
    }
    let is_outer = turn > 0.0;
    let both_lines = !before.is_arc() && !after.is_arc();
    if is_outer && !(both_lines && turn < MITER_RADIANS) {
        let around = ProfilePiece {
            start: one.end,
            end: two.start,
            bulge: libm::tan(turn.min(PI) / 4.0),
        };
        return Some(Some(around));
    }
    let corner = (one.end + two.start) * 0.5;
    let is_within = |point: &Point| {
        is_outer || (one.fraction_of(*point) >= 0.0 && two.fraction_of(*point) <= 1.0)
    };
    let meeting = (meeting_points(one, two).into_iter())
        .filter(is_within)
        .min_by(|a, b| {
            let distance = |point: &Point| (*point - corner).length();
            distance(a).total_cmp(&distance(b))
        })?;
    *one = with_end(one, meeting);
    *two = with_end(&two.reversed(), meeting).reversed();
    Some(None)
}

/// The piece up to a point of its line or circle.
fn with_end(piece: &ProfilePiece, end: Point) -> ProfilePiece {
    let sweep = piece.sweep() * piece.fraction_of(end);
    ProfilePiece {
        end,
        bulge: libm::tan(sweep / 4.0),
        ..*piece
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(start: (f64, f64), end: (f64, f64)) -> ProfilePiece {
        ProfilePiece::line(Point::new(start.0, start.1), Point::new(end.0, end.1))
    }

    #[test]
    fn corners_are_mitred_rolled_around_and_cut() {
        let outline = [
            line((5.0, 0.0), (5.0, -10.0)),
            line((5.0, -10.0), (10.0, -10.0)),
            line((10.0, -10.0), (10.0, -20.0)),
            ProfilePiece {
                start: Point::new(10.0, -20.0),
                end: Point::new(14.0, -24.0),
                bulge: libm::tan(PI / 8.0),
            },
        ];
        let path = follow_outline(&outline, 1.0).expect("a path");
        // The arc begins square to the line before it: an inner corner.
        assert_eq!(path.len(), 4);
        assert_eq!(path[0].end, Point::new(6.0, -9.0));
        assert_eq!(path[1].end, Point::new(11.0, -9.0));
        assert!((path[3].radius() - 5.0).abs() < 1e-9);
        assert!((path[2].end - path[3].start).length() < 1e-12);
        assert_eq!(find_gouge(&path, &outline, 1.0), None);
        // The same path is too near for a larger nose.
        assert!(find_gouge(&path, &outline, 1.01).is_some());
    }

    #[test]
    fn the_nose_rolls_around_an_edge_beside_an_arc() {
        let arc = ProfilePiece {
            start: Point::new(5.0, 0.0),
            end: Point::new(8.0, -3.0),
            bulge: -libm::tan(PI / 8.0),
        };
        let outline = [arc, line((8.0, -3.0), (8.0, -9.0))];
        let path = follow_outline(&outline, 0.8).expect("a path");
        assert_eq!(path.len(), 3);
        assert!((path[1].radius() - 0.8).abs() < 1e-9);
        assert!((path[1].center().expect("an arc") - Point::new(8.0, -3.0)).length() < 1e-9);
        assert!(follow_outline(&outline, 3.2).is_err(), "wider than the arc");
    }
}
