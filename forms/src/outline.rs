//! The outline of a contour form: points with diameter, position or length, taper angle and
//! corner.

use core::fmt;

use gsk_messages::{Message, say};
use libm::{fabs, tan};

use crate::thousandths::Thousandths;

/// Greatest number of points of an outline.
const MOST_POINTS: usize = 40;

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

/// A point of an outline as it is given: what is missing follows from the point before it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TurnedPoint {
    /// The diameter, mm; `None`: that of the point before, or from the angle.
    pub diameter: Option<Thousandths>,
    /// Z of the point, mm; `None`: from the length or the angle, or that of the point before.
    pub z: Option<Thousandths>,
    /// Distance from the point before towards the chuck, mm.
    pub length: Option<Thousandths>,
    /// Angle between the line to this point and the spindle axis, degrees.
    pub angle: Option<Thousandths>,
    /// The corner at this point.
    pub corner: CornerShape,
}

/// An outline: its points from the face towards the chuck.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TurnedOutline {
    /// The points in the order of the cut.
    pub points: Vec<TurnedPoint>,
}

/// A point of an outline with both coordinates, mm; X is a radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OutlineVertex {
    pub(crate) x: f64,
    pub(crate) z: f64,
    pub(crate) corner: CornerShape,
}

impl TurnedPoint {
    /// Reads a point such as `X20 Z-5 R2`.
    fn parse(text: &str) -> Result<Self, Message> {
        let refuse = || say::form_point_unreadable(text.trim());
        let mut point = Self::default();
        let letters: Vec<char> = text.chars().filter(|it| !it.is_whitespace()).collect();
        let mut at = 0;
        while let Some(letter) = letters.get(at) {
            let number: String = letters[at + 1..]
                .iter()
                .take_while(|it| it.is_ascii_digit() || matches!(it, '.' | '-' | '+'))
                .collect();
            at += 1 + number.len();
            let number = Thousandths::parse(&number).ok_or_else(refuse)?;
            let field = match letter.to_ascii_uppercase() {
                'X' => &mut point.diameter,
                'Z' => &mut point.z,
                'L' => &mut point.length,
                'A' => &mut point.angle,
                corner @ ('R' | 'C') if point.corner == CornerShape::Sharp && number.0 > 0 => {
                    point.corner = match corner {
                        'R' => CornerShape::Radius(number),
                        _ => CornerShape::Chamfer(number),
                    };
                    continue;
                }
                _ => return Err(refuse()),
            };
            if field.replace(number).is_some() {
                return Err(refuse());
            }
        }
        Ok(point)
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
        let points = points?;
        if points.len() > MOST_POINTS {
            return Err(say::form_points_too_many(MOST_POINTS));
        }
        Ok(Self { points })
    }

    /// Both coordinates of every point. `side` is 1 outside, where diameters grow along a
    /// taper, and −1 inside.
    pub(crate) fn vertices(&self, side: f64) -> Result<Vec<OutlineVertex>, Message> {
        if self.points.len() < 2 {
            return Err(say::form_points_too_few());
        }
        let mut vertices: Vec<OutlineVertex> = Vec::new();
        for (index, point) in self.points.iter().enumerate() {
            let number = index + 1;
            let x = point.diameter.map(|it| it.value() / 2.0);
            let Some(last) = vertices.last() else {
                let x = x.ok_or_else(|| say::form_point_first(number))?;
                vertices.push(OutlineVertex {
                    x,
                    z: point.z.unwrap_or_default().value(),
                    corner: point.corner,
                });
                continue;
            };
            let z = match (point.z, point.length) {
                (Some(_), Some(_)) => return Err(say::form_point_z_and_l(number)),
                (Some(z), None) => Some(z.value()),
                (None, Some(length)) => Some(last.z - length.value()),
                (None, None) => None,
            };
            let slope = match point.angle.map(Thousandths::value) {
                None => None,
                Some(angle) if angle > 0.0 && angle < 90.0 => Some(tan(angle.to_radians())),
                Some(_) => return Err(say::form_point_angle(number)),
            };
            let (x, z) = match (x, z, slope) {
                (Some(_), Some(_), Some(_)) => return Err(say::form_point_over(number)),
                (None, None, _) => return Err(say::form_point_missing(number)),
                (Some(x), Some(z), None) => (x, z),
                (Some(x), None, None) => (x, last.z),
                (None, Some(z), None) => (last.x, z),
                (Some(x), None, Some(slope)) => (x, last.z - fabs(x - last.x) / slope),
                (None, Some(z), Some(slope)) => (last.x + side * (last.z - z) * slope, z),
            };
            vertices.push(OutlineVertex {
                x,
                z,
                corner: point.corner,
            });
        }
        Ok(vertices)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_keep_their_text_and_complete_each_other() {
        let outline = TurnedOutline::parse("x20 z0 c2; L20; X30 A45 R1; Z-40").unwrap();
        assert_eq!(outline.to_string(), "X20Z0C2/L20/X30A45R1/Z-40");
        let vertices = outline.vertices(1.0).unwrap();
        let places: Vec<(f64, f64)> = vertices.iter().map(|it| (it.x, it.z)).collect();
        assert_eq!(places[..2], [(10.0, 0.0), (10.0, -20.0)]);
        assert!((places[2].1 + 25.0).abs() < 1e-9, "{places:?}");
        assert_eq!(places[3], (15.0, -40.0));
    }

    #[test]
    fn points_that_say_too_little_or_too_much_are_refused() {
        for text in [
            "X20",
            "Z0;X5",
            "X20;X30Z-5A20",
            "X20;R2",
            "X20;X30A90",
            "X20;L5Z-5",
        ] {
            let outline = TurnedOutline::parse(text).unwrap();
            assert!(outline.vertices(1.0).is_err(), "{text}");
        }
        for text in ["Y5", "X", "X1X2", "R2C1", "X--5", "R0"] {
            assert!(TurnedOutline::parse(text).is_err(), "{text}");
        }
    }
}
