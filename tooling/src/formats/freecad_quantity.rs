//! Quantities as FreeCAD writes them: a number with a unit.

use gsk_messages::{Message, say};
use serde_json::Value;

/// What a quantity measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum QuantityUnit {
    /// A length in mm.
    Length,
    /// An angle in degrees.
    Angle,
}

impl QuantityUnit {
    /// What a text of this kind must be.
    pub(super) fn rule(self) -> Message {
        match self {
            Self::Length => say::tool_freecad_length(),
            Self::Angle => say::tool_freecad_angle(),
        }
    }

    fn factor(self, unit: &str) -> Option<f64> {
        let factor = match (self, unit) {
            (_, "") | (Self::Length, "mm") | (Self::Angle, "°" | "deg") => 1.0,
            (Self::Length, "in" | "\"") => 25.4,
            (Self::Length, "cm") => 10.0,
            (Self::Length, "m") => 1000.0,
            // Micro sign and Greek letter.
            (Self::Length, "\u{b5}m" | "\u{3bc}m" | "um") => 0.001,
            (Self::Angle, "rad") => 180.0 / core::f64::consts::PI,
            _ => return None,
        };
        Some(factor)
    }
}

/// A length in mm or an angle in degrees; `None` for another unit or no finite number.
pub(super) fn parse_quantity(value: &Value, unit: QuantityUnit) -> Option<f64> {
    let Value::String(text) = value else {
        return value.as_f64();
    };
    let text = text.trim().replace(',', ".");
    let end = text
        .find(|it: char| !(it.is_ascii_digit() || matches!(it, '.' | '-' | '+' | 'e' | 'E')))
        .unwrap_or(text.len());
    let (number, name) = text.split_at(end);
    let number: f64 = number.trim().parse().ok()?;
    let value = number * unit.factor(name.trim())?;
    value.is_finite().then_some(value)
}
