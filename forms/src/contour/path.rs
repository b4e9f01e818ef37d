//! The pieces of an outline that are computed, and the point that they have reached.

use gsk_messages::{Message, say};
use gsk_outline::ProfilePiece;
use gsk_units::Point;
use libm::{atan2, cos, sin, tan};

use super::points::CornerShape;

/// Lengths below this are rounding, mm.
pub(super) const TOLERANCE_MM: f64 = 1e-9;
/// A line or an arc of an outline, before its corners are rounded. X is a radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolvedPiece {
    /// The line or arc.
    pub piece: ProfilePiece,
    /// The corner at its end.
    pub corner: CornerShape,
    /// The number of its point in the outline, from 1.
    pub number: usize,
}

/// The words of a point, as numbers; X is a radius.
#[derive(Clone, Copy)]
pub(super) struct PointWords {
    pub(super) number: usize,
    pub(super) x: Option<f64>,
    pub(super) z: Option<f64>,
    pub(super) length: Option<f64>,
    /// Degrees.
    pub(super) angle: Option<f64>,
    pub(super) is_tangent: bool,
    pub(super) corner: CornerShape,
}

/// The lines and arcs so far.
pub(super) struct OutlinePath {
    /// 1 outside, −1 inside.
    pub(super) side: f64,
    /// The end of the last piece.
    pub(super) at: Point,
    pub(super) pieces: Vec<SolvedPiece>,
}

impl OutlinePath {
    /// The words with Z from the length.
    pub(super) fn placed(&self, words: PointWords) -> PointWords {
        let z = words.z.or(words.length.map(|length| self.at.z - length));
        PointWords { z, ..words }
    }

    /// The direction with an angle to the axis, towards the chuck.
    pub(super) fn direction(&self, angle: f64) -> Point {
        let radians = angle.to_radians();
        Point::new(self.side * sin(radians), -cos(radians))
    }

    /// The direction at the end of the last piece.
    pub(super) fn last_direction(&self, number: usize) -> Result<Point, Message> {
        let last = self.pieces.last().map(|it| it.piece.direction_at(1.0));
        last.ok_or_else(|| say::form_point_no_tangent(number))
    }

    pub(super) fn push(&mut self, piece: ProfilePiece, number: usize, corner: CornerShape) {
        self.at = piece.end;
        self.pieces.push(SolvedPiece {
            piece,
            corner,
            number,
        });
    }

    pub(super) fn push_line_to(&mut self, end: Point, words: &PointWords) -> Result<(), Message> {
        if (end - self.at).length() <= TOLERANCE_MM {
            return Err(say::form_point_unsolvable(words.number));
        }
        let line = ProfilePiece::line(self.at, end);
        self.push(line, words.number, words.corner);
        Ok(())
    }

    /// The point in a direction with one of the coordinates.
    pub(super) fn along(
        &self,
        direction: Point,
        x: Option<f64>,
        z: Option<f64>,
        number: usize,
    ) -> Result<Point, Message> {
        let (distance, rate) = match (x, z) {
            (Some(x), None) => (x - self.at.x, direction.x),
            (None, Some(z)) => (z - self.at.z, direction.z),
            _ => return Err(say::form_point_over(number)),
        };
        let length = distance / rate;
        // A comparison that is false for NaN, too.
        let is_ahead = length > TOLERANCE_MM && length < 1e6;
        if !is_ahead {
            return Err(say::form_point_unsolvable(number));
        }
        let end = self.at + direction * length;
        Ok(Point::new(x.unwrap_or(end.x), z.unwrap_or(end.z)))
    }
}

/// The centre of an arc that leaves a point along a direction.
pub(super) fn arc_center(start: Point, direction: Point, radius: f64, is_clockwise: bool) -> Point {
    let side = if is_clockwise { -radius } else { radius };
    start + direction.left() * side
}

/// The arc of at most half a turn about a centre; `None` if it would be longer or has no
/// length.
pub(super) fn arc_about(
    start: Point,
    end: Point,
    center: Point,
    is_clockwise: bool,
) -> Option<ProfilePiece> {
    let (from, to) = (start - center, end - center);
    let side = if is_clockwise { -1.0 } else { 1.0 };
    let sweep = atan2(from.cross(to), from.dot(to)) * side;
    // Half a turn may come out with either sign.
    let sweep = match sweep < -core::f64::consts::PI + 1e-9 {
        true => core::f64::consts::PI,
        false => sweep,
    };
    (sweep > 1e-9).then(|| ProfilePiece {
        start,
        end,
        bulge: tan(sweep / 4.0) * side,
    })
}
