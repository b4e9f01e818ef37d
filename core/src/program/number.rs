//! The number of a word, stored exactly as written.

use core::fmt;

use serde::{Deserialize, Serialize};

/// The number 1 in the unit that [`WordNumber`] stores.
const MILLIONTHS: i64 = 1_000_000;

/// The notation in which a number was written in the program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
enum NumberNotation {
    #[default]
    Integer,
    Decimal,
    Variable,
    NegativeVariable,
}

/// The number of a word: an exact decimal in millionths, and its notation.
///
/// On addresses that accept a point (X Z U W R I J K, and F) the value is in mm, s, mm/min,
/// …, with or without a point. Lengths are rounded to the least input increment of 0.001
/// (manual I-1.3.1). A number can also be a reference to a variable, until
/// [`ProgramBlock::resolve`] replaces it.
///
/// [`ProgramBlock::resolve`]: super::ProgramBlock::resolve
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct WordNumber {
    millionths: i64,
    digits: u8,
    form: NumberNotation,
}

/// A reference `#i` or `-#i` that a word has instead of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct VariableReference {
    /// The number after `#`; `9nnn` means the variable whose number is the value of `#nnn`
    /// (manual I-3.7.2).
    pub number: u16,
    /// Whether a minus sign is before the `#`.
    pub negative: bool,
}

impl WordNumber {
    pub(super) const ZERO: Self = Self {
        millionths: 0,
        digits: 0,
        form: NumberNotation::Integer,
    };

    /// The number `value`, written without a point and with `digits` digits.
    pub(crate) const fn from_integer(value: i64, digits: u8) -> Self {
        Self {
            millionths: value.saturating_mul(MILLIONTHS),
            digits,
            form: NumberNotation::Integer,
        }
    }

    /// A number written with a point, from its value in millionths.
    pub(crate) const fn from_millionths(millionths: i64) -> Self {
        Self {
            millionths,
            digits: 0,
            form: NumberNotation::Decimal,
        }
    }

    /// The number of a word from the value of its formula. A length is rounded to its
    /// increment `length`, in millionths; F is not rounded; other numbers are rounded to an
    /// integer. Halves are rounded away from zero.
    pub(super) fn from_value(value: f64, address: u8, length: Option<i64>) -> Self {
        if address == b'F' {
            return Self::from_millionths(round_to_multiple(value, 1));
        }
        if let Some(increment) = length {
            return Self::from_millionths(round_to_multiple(value, increment));
        }
        Self::from_integer(round_to_multiple(value, MILLIONTHS) / MILLIONTHS, 0)
    }

    pub(super) const fn from_variable(variable: VariableReference) -> Self {
        Self {
            millionths: variable.number as i64,
            digits: 0,
            form: if variable.negative {
                NumberNotation::NegativeVariable
            } else {
                NumberNotation::Variable
            },
        }
    }

    /// The variable that the word refers to; `None` for a number.
    pub const fn variable(self) -> Option<VariableReference> {
        let negative = match self.form {
            NumberNotation::Variable => false,
            NumberNotation::NegativeVariable => true,
            NumberNotation::Integer | NumberNotation::Decimal => return None,
        };
        Some(VariableReference {
            number: self.millionths as u16,
            negative,
        })
    }

    /// The exact value, in millionths of the unit of the address (mm, s, mm/min …).
    pub const fn millionths(self) -> i64 {
        self.millionths
    }

    /// The value in thousandths of the unit of the address; a smaller fraction is dropped.
    pub const fn thousandths(self) -> i64 {
        self.millionths / 1000
    }

    /// The value in the unit of the address (mm, s, mm/min …).
    pub fn value(self) -> f64 {
        self.millionths as f64 / MILLIONTHS as f64
    }

    /// The value of a length, mm; a diameter remains a diameter.
    pub fn mm(self) -> f64 {
        self.value()
    }

    /// The value of an integer address; a fraction is dropped.
    pub const fn integer(self) -> i64 {
        self.millionths / MILLIONTHS
    }

    /// Whether the number was written with a decimal point.
    pub const fn has_point(self) -> bool {
        matches!(self.form, NumberNotation::Decimal)
    }

    /// Number of digits written in a number without a point (`T0101` and `T1` have different
    /// meanings); 0 for other numbers.
    pub const fn digits(self) -> u8 {
        self.digits
    }

    /// Converts a length or a feed from inches to millimetres.
    pub const fn inches_to_mm(self) -> Self {
        Self::from_millionths(self.millionths.saturating_mul(254) / 10)
    }

    /// Rounds to a multiple of `increment`, the least input increment in millionths of the
    /// unit.
    pub(super) const fn rounded_to_increment(self, increment: i64) -> Self {
        let half = if self.millionths < 0 {
            -increment / 2
        } else {
            increment / 2
        };
        let millionths = (self.millionths + half) / increment * increment;
        Self { millionths, ..self }
    }
}

/// Whether the numbers of an address are lengths in mm.
pub(super) const fn is_length(address: u8) -> bool {
    matches!(
        address,
        b'X' | b'Z' | b'U' | b'W' | b'R' | b'I' | b'J' | b'K'
    )
}

/// Rounds a value to a multiple of `unit` millionths, in millionths. Halves are rounded away
/// from zero, including those that a binary fraction represents too small: 1.2345 yields
/// 1.235.
fn round_to_multiple(value: f64, unit: i64) -> i64 {
    /// Values below a half by less than this (in multiples of `unit`) count as a half.
    const HALF_TOLERANCE: f64 = 1e-7;
    let size = value.abs() * (MILLIONTHS as f64) / unit as f64;
    let units = libm::floor(size + 0.5 + HALF_TOLERANCE) as i64;
    let size = units.saturating_mul(unit);
    if value < 0.0 { -size } else { size }
}

impl fmt::Display for WordNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(variable) = self.variable() {
            let sign = if variable.negative { "-" } else { "" };
            return write!(f, "{sign}#{}", variable.number);
        }
        if self.millionths < 0 {
            f.write_str("-")?;
        }
        let size = self.millionths.unsigned_abs();
        let one = MILLIONTHS.unsigned_abs();
        let (whole, fraction) = (size / one, size % one);
        if !self.has_point() {
            return write!(f, "{whole:0width$}", width = usize::from(self.digits));
        }
        if fraction == 0 {
            return write!(f, "{whole}.");
        }
        let digits = format!("{fraction:06}");
        write!(f, "{whole}.{}", digits.trim_end_matches('0'))
    }
}
