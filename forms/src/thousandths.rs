//! A number of thousandths: the exact decimal of a field, with the least increment of the
//! control.

use core::fmt;
use core::ops::{Add, Sub};

use gsk_units::parse_finite;

/// Greatest number that a field accepts, in whole units.
const GREATEST: f64 = 99_999.0;

/// A decimal number with three places, stored as a whole number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Thousandths(pub i64);

impl Thousandths {
    /// A whole number.
    pub const fn whole(value: i64) -> Self {
        Self(value * 1000)
    }

    /// Rounds a value to three places; a value that is not finite becomes 0.
    pub fn round(value: f64) -> Self {
        if value.is_finite() {
            Self(libm::round(value.clamp(-GREATEST, GREATEST) * 1000.0) as i64)
        } else {
            Self(0)
        }
    }

    /// Reads a decimal number; `None` if it is no number, too large, or has a fourth place
    /// other than 0.
    pub fn parse(text: &str) -> Option<Self> {
        let value = parse_finite(text.trim()).filter(|value| value.abs() <= GREATEST)?;
        let rounded = Self::round(value);
        ((rounded.value() - value).abs() < 1e-7).then_some(rounded)
    }

    /// The number in its unit.
    pub const fn value(self) -> f64 {
        self.0 as f64 / 1000.0
    }

    /// The digits of a word of the control, always with a decimal point: `40.` or `0.25`.
    pub fn with_point(self) -> String {
        let digits = self.to_string();
        if digits.contains('.') {
            digits
        } else {
            format!("{digits}.")
        }
    }
}

impl Add for Thousandths {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for Thousandths {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl fmt::Display for Thousandths {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = if self.0 < 0 { "-" } else { "" };
        let (whole, rest) = (self.0.unsigned_abs() / 1000, self.0.unsigned_abs() % 1000);
        let digits = format!("{sign}{whole}.{rest:03}");
        formatter.write_str(digits.trim_end_matches('0').trim_end_matches('.'))
    }
}

#[cfg(test)]
mod tests {
    use super::Thousandths;

    #[test]
    fn a_number_keeps_its_digits() {
        for (text, shown, word) in [
            ("40", "40", "40."),
            ("0.250", "0.25", "0.25"),
            ("-1.005", "-1.005", "-1.005"),
            ("100", "100", "100."),
            ("0", "0", "0."),
        ] {
            let number = Thousandths::parse(text).unwrap();
            assert_eq!(number.to_string(), shown);
            assert_eq!(number.with_point(), word);
        }
        for text in ["", "1.2345", "x", "1e9", "nan", "inf"] {
            assert_eq!(Thousandths::parse(text), None, "{text}");
        }
    }
}
