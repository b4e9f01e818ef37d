//! The outline of a contour form as text: points with diameter, position or length, angle,
//! arc and corner.

use core::fmt;

use gsk_messages::{Message, say};

use crate::thousandths::Thousandths;

/// Greatest number of points of an outline.
const MOST_POINTS: usize = 96;

/// The corner at a point of an outline.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CornerShape {
    /// A sharp corner.
    #[default]
    Sharp,
    /// An arc that touches both lines, with this radius in mm.
    Radius(Thousandths),
    /// A chamfer that shortens both lines by this length in mm.
    Chamfer(Thousandths),
}

/// An arc to a point of an outline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TurnedArc {
    /// Clockwise with Z to the right and X up: G02.
    pub is_clockwise: bool,
    /// Its radius, mm; `None`: from its end, if it is tangent to the piece before it.
    pub radius: Option<Thousandths>,
}

/// A point of an outline with the line or arc to it, as it is given: what is missing follows
/// from the other words and from the points before and after it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TurnedPoint {
    /// The diameter, mm; `None`: that of the point before, or from the angle.
    pub diameter: Option<Thousandths>,
    /// Z of the point, mm; `None`: from the length or the angle, or that of the point before.
    pub z: Option<Thousandths>,
    /// Distance from the point before towards the chuck, mm.
    pub length: Option<Thousandths>,
    /// Angle between the spindle axis and the direction at this point, degrees; negative
    /// where the outline descends.
    pub angle: Option<Thousandths>,
    /// The arc to this point; `None`: a line.
    pub arc: Option<TurnedArc>,
    /// Whether the line or arc touches the piece before it.
    pub is_tangent: bool,
    /// The corner at this point.
    pub corner: CornerShape,
}

/// An outline: its points from the face towards the chuck.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TurnedOutline {
    /// The points in the order of the cut.
    pub points: Vec<TurnedPoint>,
}

/// The words of a point; a word of which another one is the beginning comes first.
const WORDS: [&str; 9] = ["CCW", "CW", "X", "Z", "L", "A", "R", "C", "T"];

impl TurnedPoint {
    /// Reads a point such as `X20 Z-5 R2` or `X30 Z-10 CW20`.
    fn parse(text: &str) -> Result<Self, Message> {
        let refuse = || say::form_point_unreadable(text.trim());
        let letters: String = text.chars().filter(|it| !it.is_whitespace()).collect();
        let letters = letters.to_ascii_uppercase();
        let mut point = Self::default();
        let mut rest = letters.as_str();
        while !rest.is_empty() {
            let mut words = WORDS.into_iter();
            let word = words
                .find(|word| rest.starts_with(word))
                .ok_or_else(refuse)?;
            rest = &rest[word.len()..];
            let is_digit = |it: char| it.is_ascii_digit() || matches!(it, '.' | '-' | '+');
            let end = rest.find(|it| !is_digit(it)).unwrap_or(rest.len());
            let (digits, after) = rest.split_at(end);
            rest = after;
            let number = match digits {
                "" => None,
                digits => Some(Thousandths::parse(digits).ok_or_else(refuse)?),
            };
            point.set(word, number).ok_or_else(refuse)?;
        }
        Ok(point)
    }

    /// Sets a word; `None` if the point has it already, or the number is missing or wrong.
    fn set(&mut self, word: &str, number: Option<Thousandths>) -> Option<()> {
        let positive = number.filter(|it| it.0 > 0);
        match word {
            "CW" | "CCW" => {
                let arc = TurnedArc {
                    is_clockwise: word == "CW",
                    radius: positive,
                };
                let is_valid = number.is_none() || positive.is_some();
                return (is_valid && self.arc.replace(arc).is_none()).then_some(());
            }
            "T" => {
                let is_first = !core::mem::replace(&mut self.is_tangent, true);
                return (is_first && number.is_none()).then_some(());
            }
            "R" | "C" => {
                let size = positive.filter(|_| self.corner == CornerShape::Sharp)?;
                self.corner = match word {
                    "R" => CornerShape::Radius(size),
                    _ => CornerShape::Chamfer(size),
                };
                return Some(());
            }
            _ => {}
        }
        let field = match word {
            "X" => &mut self.diameter,
            "Z" => &mut self.z,
            "L" => &mut self.length,
            _ => &mut self.angle,
        };
        field.replace(number?).is_none().then_some(())
    }
}

impl fmt::Display for TurnedPoint {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = [
            ('X', self.diameter),
            ('Z', self.z),
            ('L', self.length),
            ('A', self.angle),
        ];
        for (letter, value) in words {
            if let Some(value) = value {
                write!(formatter, "{letter}{value}")?;
            }
        }
        if let Some(arc) = self.arc {
            let word = if arc.is_clockwise { "CW" } else { "CCW" };
            match arc.radius {
                Some(radius) => write!(formatter, "{word}{radius}")?,
                None => formatter.write_str(word)?,
            }
        }
        if self.is_tangent {
            formatter.write_str("T")?;
        }
        match self.corner {
            CornerShape::Sharp => Ok(()),
            CornerShape::Radius(radius) => write!(formatter, "R{radius}"),
            CornerShape::Chamfer(length) => write!(formatter, "C{length}"),
        }
    }
}

impl fmt::Display for TurnedOutline {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, point) in self.points.iter().enumerate() {
            let separator = if index == 0 { "" } else { "/" };
            write!(formatter, "{separator}{point}")?;
        }
        Ok(())
    }
}

impl TurnedOutline {
    /// Reads points separated by `;`, `/` or line ends.
    ///
    /// # Errors
    /// The point that cannot be read, or that there are too many.
    pub fn parse(text: &str) -> Result<Self, Message> {
        let parts = text.split([';', '/', '\n']);
        let parts = parts.filter(|part| !part.trim().is_empty());
        let points: Result<Vec<TurnedPoint>, Message> = parts.map(TurnedPoint::parse).collect();
        Self::from_points(points?)
    }

    /// An outline through these points.
    pub(crate) fn from_points(points: Vec<TurnedPoint>) -> Result<Self, Message> {
        if points.len() > MOST_POINTS {
            return Err(say::form_points_too_many(MOST_POINTS));
        }
        Ok(Self { points })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_keep_their_text() {
        let text = "x20 z0 c2; L20; X30 A45 R1; Z-40; x50z-50cw20; CCW T X60; T A-5 Z-80 ccw3";
        let outline = TurnedOutline::parse(text).unwrap();
        let written = "X20Z0C2/L20/X30A45R1/Z-40/X50Z-50CW20/X60CCWT/Z-80A-5CCW3T";
        assert_eq!(outline.to_string(), written);
        assert_eq!(TurnedOutline::parse(written).unwrap(), outline);
    }

    #[test]
    fn points_that_cannot_be_read_are_refused() {
        for text in [
            "Y5", "X", "X1X2", "R2C1", "X--5", "R0", "CW0", "CW-2", "CW1CCW1", "TT", "T5",
        ] {
            assert!(TurnedOutline::parse(text).is_err(), "{text}");
        }
    }
}
