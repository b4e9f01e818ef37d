//! Computes the lines and arcs of an outline from the conditions of its points.
//!
//! ```text
//!   line   X Z | one of them | angle and one of them | tangent and one of them
//!   arc    X Z R | tangent, X Z | tangent, R and one of X, Z, A
//!   open   an end without coordinates: the next point closes it (`open_end`)
//! ```

use gsk_messages::{Message, say};
use gsk_outline::{ProfilePiece, meeting_points};
use gsk_units::Point;
use libm::{asin, atan2, cos, fabs, sin, tan};

use super::open_end::{OpenArc, OpenEnd, OpenLine};
use super::points::{CornerShape, TurnedArc, TurnedOutline, TurnedPoint};
use crate::thousandths::Thousandths;

/// Lengths below this are rounding, mm.
pub(super) const TOLERANCE_MM: f64 = 1e-9;
/// How much half a chord may exceed the radius of its arc through rounding, mm.
const RADIUS_ROUNDING_MM: f64 = 0.001;

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

/// What follows from the points of an outline.
#[derive(Clone, Debug, PartialEq)]
pub struct OutlineSolution {
    /// Where the outline begins.
    pub start: Point,
    /// The corner there.
    pub first_corner: CornerShape,
    /// The lines and arcs, as far as they can be computed.
    pub pieces: Vec<SolvedPiece>,
    /// Why the rest cannot be computed; `None` if the outline is complete.
    pub fault: Option<Message>,
}

impl TurnedOutline {
    /// Computes the lines and arcs. `side` is 1 outside, where diameters grow along a positive
    /// angle, and −1 inside.
    pub fn solve(&self, side: f64) -> OutlineSolution {
        let first = self.points.first().copied().unwrap_or_default();
        let mut solver = OutlineSolver {
            side,
            at: Point::new(
                first.diameter.unwrap_or_default().value() / 2.0,
                first.z.unwrap_or_default().value(),
            ),
            open: None,
            pieces: Vec::new(),
        };
        let start = solver.at;
        let fault = solver.solve_points(&self.points).err();
        OutlineSolution {
            start,
            first_corner: first.corner,
            pieces: solver.pieces,
            fault,
        }
    }
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

pub(super) struct OutlineSolver {
    side: f64,
    pub(super) at: Point,
    open: Option<OpenEnd>,
    pieces: Vec<SolvedPiece>,
}

impl OutlineSolver {
    fn solve_points(&mut self, points: &[TurnedPoint]) -> Result<(), Message> {
        if points.len() < 2 {
            return Err(say::form_points_too_few());
        }
        let first = &points[0];
        if first.diameter.is_none() || first.arc.is_some() || first.is_tangent {
            return Err(say::form_point_first(1));
        }
        for (index, point) in points.iter().enumerate().skip(1) {
            self.add(index + 1, point)?;
        }
        match self.open.as_ref() {
            Some(open) => Err(say::form_point_missing(open.number())),
            None => Ok(()),
        }
    }

    fn add(&mut self, number: usize, point: &TurnedPoint) -> Result<(), Message> {
        if point.z.is_some() && point.length.is_some() {
            return Err(say::form_point_z_and_l(number));
        }
        let angle = point.angle.map(Thousandths::value);
        if angle.is_some_and(|angle| fabs(angle) > 90.0) {
            return Err(say::form_point_angle(number));
        }
        let words = PointWords {
            number,
            x: point.diameter.map(|it| it.value() / 2.0),
            z: point.z.map(Thousandths::value),
            length: point.length.map(Thousandths::value),
            angle,
            is_tangent: point.is_tangent,
            corner: point.corner,
        };
        match (self.open.take(), point.arc) {
            (None, None) => self.add_line(self.placed(words)),
            (None, Some(arc)) => self.add_arc(self.placed(words), arc),
            (Some(open), arc) => self.close(&open, &words, arc),
        }
    }

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
    fn last_direction(&self, number: usize) -> Result<Point, Message> {
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

    fn add_line(&mut self, words: PointWords) -> Result<(), Message> {
        let number = words.number;
        let direction = match (words.angle, words.is_tangent) {
            (Some(_), true) => return Err(say::form_point_over(number)),
            (Some(angle), false) => Some(self.direction(angle)),
            (None, true) => Some(self.last_direction(number)?),
            (None, false) => None,
        };
        let at = self.at;
        let end = match (words.x, words.z, direction) {
            (Some(_), Some(_), Some(_)) => return Err(say::form_point_over(number)),
            (None, None, None) => return Err(say::form_point_missing(number)),
            (Some(x), Some(z), None) => Point::new(x, z),
            (Some(x), None, None) => Point::new(x, at.z),
            (None, Some(z), None) => Point::new(at.x, z),
            (None, None, Some(direction)) => {
                self.open = Some(OpenEnd::Line(OpenLine {
                    number,
                    direction,
                    corner: words.corner,
                }));
                return Ok(());
            }
            // With a diameter the sign of an angle follows from it.
            (Some(x), None, Some(direction)) if !words.is_tangent => {
                let rise = fabs(direction.x);
                if rise <= TOLERANCE_MM {
                    return Err(say::form_point_angle(number));
                }
                Point::new(x, at.z + fabs(x - at.x) * direction.z / rise)
            }
            (x, z, Some(direction)) => self.along(direction, x, z, number)?,
        };
        self.push_line_to(end, &words)
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

    fn add_arc(&mut self, words: PointWords, arc: TurnedArc) -> Result<(), Message> {
        let number = words.number;
        let unsolvable = || say::form_point_unsolvable(number);
        let radius = arc.radius.map(Thousandths::value);
        let end = words.x.zip(words.z).map(|(x, z)| Point::new(x, z));
        if !words.is_tangent {
            return match (end, radius, words.angle) {
                (Some(end), Some(radius), None) => {
                    let piece = arc_by_radius(self.at, end, radius, arc.is_clockwise);
                    self.push(piece.ok_or_else(unsolvable)?, number, words.corner);
                    Ok(())
                }
                (Some(_), _, Some(_)) => Err(say::form_point_over(number)),
                _ => Err(say::form_point_arc_missing(number)),
            };
        }
        let direction = self.last_direction(number)?;
        let piece = match (end, radius, words.angle) {
            (Some(end), None, None) => {
                let chord = end - self.at;
                let half = atan2(direction.cross(chord), direction.dot(chord));
                let turns_right = (half < 0.0) == arc.is_clockwise;
                let bulge = tan(half / 2.0);
                (turns_right && fabs(bulge) <= 1.0 && chord.length() > TOLERANCE_MM).then(|| {
                    ProfilePiece {
                        start: self.at,
                        end,
                        bulge,
                    }
                })
            }
            (None, Some(radius), Some(angle)) if words.x.is_none() && words.z.is_none() => {
                let directions = (direction, self.direction(angle));
                ProfilePiece::turning(self.at, directions, radius, !arc.is_clockwise)
            }
            (None, Some(radius), None) if words.x.is_none() && words.z.is_none() => {
                self.open = Some(OpenEnd::Arc(OpenArc {
                    number,
                    direction,
                    radius,
                    is_clockwise: arc.is_clockwise,
                    corner: words.corner,
                }));
                return Ok(());
            }
            (None, Some(radius), None) => {
                self.arc_to_coordinate(direction, (radius, arc.is_clockwise), words)
            }
            (None, None, _) => return Err(say::form_point_arc_missing(number)),
            _ => return Err(say::form_point_over(number)),
        };
        self.push(piece.ok_or_else(unsolvable)?, number, words.corner);
        Ok(())
    }

    /// The shortest arc with this radius that leaves along a direction and ends at one
    /// coordinate.
    fn arc_to_coordinate(
        &self,
        direction: Point,
        (radius, is_clockwise): (f64, bool),
        words: PointWords,
    ) -> Option<ProfilePiece> {
        let center = arc_center(self.at, direction, radius, is_clockwise);
        let through = Point::new(words.x.unwrap_or(center.x), words.z.unwrap_or(center.z));
        let along = match words.x {
            Some(_) => Point::new(0.0, 1.0),
            None => Point::new(1.0, 0.0),
        };
        let level = ProfilePiece::line(through, through + along);
        let circle = ProfilePiece {
            start: center + Point::new(radius, 0.0),
            end: center - Point::new(radius, 0.0),
            bulge: 1.0,
        };
        let ends = meeting_points(&circle, &level).into_iter();
        let ends = ends.map(|end| {
            // The given coordinate is kept exactly.
            Point::new(words.x.unwrap_or(end.x), words.z.unwrap_or(end.z))
        });
        let arcs = ends.filter_map(|end| arc_about(self.at, end, center, is_clockwise));
        arcs.min_by(|a, b| fabs(a.bulge).total_cmp(&fabs(b.bulge)))
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

/// The arc of at most half a turn between two points.
fn arc_by_radius(
    start: Point,
    end: Point,
    radius: f64,
    is_clockwise: bool,
) -> Option<ProfilePiece> {
    let half = (end - start).length() / 2.0;
    if half <= TOLERANCE_MM || half > radius + RADIUS_ROUNDING_MM {
        return None;
    }
    let sweep = 2.0 * asin((half / radius).min(1.0));
    let side = if is_clockwise { -1.0 } else { 1.0 };
    Some(ProfilePiece {
        start,
        end,
        bulge: tan(sweep / 4.0) * side,
    })
}

#[cfg(test)]
mod tests;
