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
use libm::{asin, atan2, fabs, tan};

use super::open_end::{OpenArc, OpenEnd, OpenLine};
use super::path::{OutlinePath, PointWords, SolvedPiece, TOLERANCE_MM, arc_about, arc_center};
use super::points::{CornerShape, TurnedArc, TurnedOutline, TurnedPoint};
use crate::thousandths::Thousandths;

/// How much half a chord may exceed the radius of its arc through rounding, mm.
const RADIUS_ROUNDING_MM: f64 = 0.001;

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
        let start = Point::new(
            first.diameter.unwrap_or_default().value() / 2.0,
            first.z.unwrap_or_default().value(),
        );
        let mut solver = OutlineSolver {
            path: OutlinePath {
                side,
                at: start,
                pieces: Vec::new(),
            },
            open: None,
        };
        let fault = solver.solve_points(&self.points).err();
        OutlineSolution {
            start,
            first_corner: first.corner,
            pieces: solver.path.pieces,
            fault,
        }
    }
}

struct OutlineSolver {
    path: OutlinePath,
    open: Option<OpenEnd>,
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
            (None, None) => self.add_line(self.path.placed(words)),
            (None, Some(arc)) => self.add_arc(self.path.placed(words), arc),
            (Some(open), arc) => open.close(&mut self.path, &words, arc),
        }
    }

    fn add_line(&mut self, words: PointWords) -> Result<(), Message> {
        let number = words.number;
        let direction = match (words.angle, words.is_tangent) {
            (Some(_), true) => return Err(say::form_point_over(number)),
            (Some(angle), false) => Some(self.path.direction(angle)),
            (None, true) => Some(self.path.last_direction(number)?),
            (None, false) => None,
        };
        let at = self.path.at;
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
            (x, z, Some(direction)) => self.path.along(direction, x, z, number)?,
        };
        self.path.push_line_to(end, &words)
    }

    fn add_arc(&mut self, words: PointWords, arc: TurnedArc) -> Result<(), Message> {
        let number = words.number;
        let unsolvable = || say::form_point_unsolvable(number);
        let radius = arc.radius.map(Thousandths::value);
        let end = words.x.zip(words.z).map(|(x, z)| Point::new(x, z));
        if !words.is_tangent {
            return match (end, radius, words.angle) {
                (Some(end), Some(radius), None) => {
                    let piece = arc_by_radius(self.path.at, end, radius, arc.is_clockwise);
                    self.path
                        .push(piece.ok_or_else(unsolvable)?, number, words.corner);
                    Ok(())
                }
                (Some(_), _, Some(_)) => Err(say::form_point_over(number)),
                _ => Err(say::form_point_arc_missing(number)),
            };
        }
        let direction = self.path.last_direction(number)?;
        let piece = match (end, radius, words.angle) {
            (Some(end), None, None) => {
                let chord = end - self.path.at;
                let half = atan2(direction.cross(chord), direction.dot(chord));
                let turns_right = (half < 0.0) == arc.is_clockwise;
                let bulge = tan(half / 2.0);
                (turns_right && fabs(bulge) <= 1.0 && chord.length() > TOLERANCE_MM).then_some(
                    ProfilePiece {
                        start: self.path.at,
                        end,
                        bulge,
                    },
                )
            }
            (None, Some(radius), Some(angle)) if words.x.is_none() && words.z.is_none() => {
                let directions = (direction, self.path.direction(angle));
                ProfilePiece::turning(self.path.at, directions, radius, !arc.is_clockwise)
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
        self.path
            .push(piece.ok_or_else(unsolvable)?, number, words.corner);
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
        let center = arc_center(self.path.at, direction, radius, is_clockwise);
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
        let arcs = ends.filter_map(|end| arc_about(self.path.at, end, center, is_clockwise));
        arcs.min_by(|a, b| fabs(a.bulge).total_cmp(&fabs(b.bulge)))
    }
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
