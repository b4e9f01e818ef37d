//! Pieces whose end has no coordinates: the next point of the outline closes them.
//!
//! ```text
//!   line  + line with angle, X Z           the lines meet
//!   line  + tangent arc with R, X Z        the line ends where the arc begins
//!   arc   + line with angle and X or Z     the arc ends where it has the angle
//!   arc   + tangent line to X Z            the line touches the arc
//!   arc   + tangent arc with R, X Z        both arcs touch
//! ```

use gsk_messages::{Message, say};
use gsk_outline::ProfilePiece;
use gsk_units::Point;
use libm::{acos, cos, fabs, sin, sqrt};

use super::path::{OutlinePath, PointWords, TOLERANCE_MM, arc_about, arc_center};
use super::points::{CornerShape, TurnedArc};
use crate::thousandths::Thousandths;

/// A line with a direction and without an end.
pub(super) struct OpenLine {
    pub(super) number: usize,
    pub(super) direction: Point,
    pub(super) corner: CornerShape,
}

/// A tangent arc with a radius and without an end.
pub(super) struct OpenArc {
    pub(super) number: usize,
    /// The direction of travel at its start.
    pub(super) direction: Point,
    pub(super) radius: f64,
    pub(super) is_clockwise: bool,
    pub(super) corner: CornerShape,
}

pub(super) enum OpenEnd {
    Line(OpenLine),
    Arc(OpenArc),
}

/// An arc that closes an open end: its end, its radius, and its sense.
struct ClosingArc {
    end: Point,
    radius: f64,
    is_clockwise: bool,
}

impl OpenEnd {
    /// The number of its point.
    pub(super) const fn number(&self) -> usize {
        match self {
            Self::Line(line) => line.number,
            Self::Arc(arc) => arc.number,
        }
    }

    /// Closes an open end with the next point.
    pub(super) fn close(
        &self,
        path: &mut OutlinePath,
        words: &PointWords,
        arc: Option<TurnedArc>,
    ) -> Result<(), Message> {
        let missing = || say::form_point_not_closed(self.number(), words.number);
        let end = words.x.zip(words.z).map(|(x, z)| Point::new(x, z));
        let Some(arc) = arc else {
            return match (self, words.angle, end) {
                (Self::Line(line), Some(angle), Some(end)) if !words.is_tangent => {
                    path.meet_lines(line, path.direction(angle), end, words)
                }
                (Self::Arc(arc), Some(angle), _) => path.end_arc(arc, angle, words),
                (Self::Arc(arc), None, Some(end)) if words.is_tangent => {
                    path.touch_arc(arc, end, words)
                }
                _ => Err(missing()),
            };
        };
        let radius = arc.radius.map(Thousandths::value);
        let (Some(end), Some(radius), true, None) = (end, radius, words.is_tangent, words.angle)
        else {
            return Err(missing());
        };
        let closing = ClosingArc {
            end,
            radius,
            is_clockwise: arc.is_clockwise,
        };
        let found = match self {
            Self::Line(line) => path.line_into_arc(line, &closing),
            Self::Arc(arc) => path.arc_into_arc(arc, &closing),
        };
        let (first, second) = found.ok_or_else(|| say::form_point_unsolvable(words.number))?;
        let corner = match self {
            Self::Line(line) => line.corner,
            Self::Arc(arc) => arc.corner,
        };
        if first.length() > TOLERANCE_MM {
            path.push(first, self.number(), corner);
        }
        path.push(second, words.number, words.corner);
        Ok(())
    }
}

impl OutlinePath {
    /// Two lines with angles: the second one has an end.
    fn meet_lines(
        &mut self,
        line: &OpenLine,
        direction: Point,
        end: Point,
        words: &PointWords,
    ) -> Result<(), Message> {
        let between = end - self.at;
        let sine = line.direction.cross(direction);
        let (first, second) = (
            between.cross(direction) / sine,
            line.direction.cross(between) / sine,
        );
        // Comparisons that are false for NaN, too.
        let is_ahead = |length: f64| length > TOLERANCE_MM && length < 1e6;
        if !(is_ahead(first) && is_ahead(second)) {
            return Err(say::form_point_unsolvable(words.number));
        }
        let corner = self.at + line.direction * first;
        self.push(
            ProfilePiece::line(self.at, corner),
            line.number,
            line.corner,
        );
        self.push_line_to(end, words)
    }

    /// An arc that ends in the direction of the line after it.
    fn end_arc(&mut self, arc: &OpenArc, angle: f64, words: &PointWords) -> Result<(), Message> {
        let direction = self.direction(angle);
        let directions = (arc.direction, direction);
        let piece = ProfilePiece::turning(self.at, directions, arc.radius, !arc.is_clockwise);
        let piece = piece.ok_or_else(|| say::form_point_unsolvable(words.number))?;
        self.push(piece, arc.number, arc.corner);
        let words = self.placed(*words);
        let end = self.along(direction, words.x, words.z, words.number)?;
        self.push_line_to(end, &words)
    }

    /// An arc that ends where the line to a point touches it.
    fn touch_arc(&mut self, arc: &OpenArc, end: Point, words: &PointWords) -> Result<(), Message> {
        let unsolvable = || say::form_point_unsolvable(words.number);
        let center = arc_center(self.at, arc.direction, arc.radius, arc.is_clockwise);
        let between = end - center;
        let distance = between.length();
        if distance <= arc.radius {
            return Err(unsolvable());
        }
        // From the contact to the end the line continues in the sense of the arc.
        let angle = acos(arc.radius / distance) * if arc.is_clockwise { 1.0 } else { -1.0 };
        let spoke = between * (arc.radius / distance);
        let contact = center + spoke * cos(angle) + spoke.left() * sin(angle);
        let piece = arc_about(self.at, contact, center, arc.is_clockwise);
        self.push(piece.ok_or_else(unsolvable)?, arc.number, arc.corner);
        self.push_line_to(end, words)
    }

    /// A line that ends where an arc to a point begins.
    fn line_into_arc(
        &self,
        line: &OpenLine,
        arc: &ClosingArc,
    ) -> Option<(ProfilePiece, ProfilePiece)> {
        let direction = line.direction;
        let offset = arc_center(self.at, direction, arc.radius, arc.is_clockwise) - self.at;
        let between = arc.end - self.at - offset;
        let (along, across) = (between.dot(direction), direction.cross(between));
        let square = arc.radius * arc.radius - across * across;
        if square < -TOLERANCE_MM {
            return None;
        }
        let half = sqrt(square.max(0.0));
        let pairs = [along - half, along + half].into_iter();
        let pairs = pairs
            .filter(|length| *length >= -TOLERANCE_MM)
            .filter_map(|length| {
                let contact = self.at + direction * length.max(0.0);
                let piece = arc_about(contact, arc.end, contact + offset, arc.is_clockwise)?;
                Some((ProfilePiece::line(self.at, contact), piece))
            });
        pairs.min_by(|a, b| fabs(a.1.bulge).total_cmp(&fabs(b.1.bulge)))
    }

    /// An arc that ends where a second one, which ends at a point, touches it.
    fn arc_into_arc(
        &self,
        one: &OpenArc,
        two: &ClosingArc,
    ) -> Option<(ProfilePiece, ProfilePiece)> {
        let first = arc_center(self.at, one.direction, one.radius, one.is_clockwise);
        let is_same_sense = one.is_clockwise == two.is_clockwise;
        let (r, s) = (one.radius, two.radius);
        let apart = if is_same_sense { fabs(r - s) } else { r + s };
        // The second centre is `apart` from the first one and `s` from the end.
        let between = two.end - first;
        let distance = between.length();
        if distance <= TOLERANCE_MM || apart <= TOLERANCE_MM {
            return None;
        }
        let along = (distance * distance + apart * apart - s * s) / (2.0 * distance);
        let square = apart * apart - along * along;
        if square < -TOLERANCE_MM {
            return None;
        }
        let across = sqrt(square.max(0.0));
        let unit = between * (1.0 / distance);
        let towards = if is_same_sense && s > r { -r } else { r };
        let pairs = [across, -across].into_iter().filter_map(|across| {
            let second = first + unit * along + unit.left() * across;
            let contact = first + (second - first) * (towards / apart);
            let arcs = (
                arc_about(self.at, contact, first, one.is_clockwise)?,
                arc_about(contact, two.end, second, two.is_clockwise)?,
            );
            Some(arcs)
        });
        pairs.min_by(|a, b| {
            let length = |pair: &(ProfilePiece, ProfilePiece)| pair.0.length() + pair.1.length();
            length(a).total_cmp(&length(b))
        })
    }
}
