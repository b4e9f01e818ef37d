//! The operations of G65 (manual I-3.7.3) on whole numbers; fractions are dropped toward zero.

use gsk_messages::{Message, say};

use crate::alarm::number;

/// The operands of an operation of G65 H.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Operands {
    /// The value of the variable of P before the operation; only H26 reads this value.
    pub(crate) i: i64,
    /// The value of the word Q, the first operand.
    pub(crate) j: i64,
    /// The value of the word R, the second operand.
    pub(crate) k: i64,
}

/// The reason why an operation of G65 H has no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ArithmeticFault {
    DivisionByZero,
    UndefinedTangent,
    UndefinedDirection,
    NegativeRoot,
    NegativeDecimalCode,
    InvalidDecimalDigit,
    OutOfRange,
}

impl ArithmeticFault {
    pub(crate) const fn alarm_number(self) -> u16 {
        match self {
            Self::DivisionByZero | Self::UndefinedTangent | Self::UndefinedDirection => {
                number::DIVISION_BY_ZERO
            }
            Self::NegativeRoot | Self::NegativeDecimalCode | Self::InvalidDecimalDigit => {
                number::NEGATIVE_ARGUMENT
            }
            Self::OutOfRange => number::MACRO_RANGE,
        }
    }

    pub(crate) fn reason(self) -> Message {
        match self {
            Self::DivisionByZero => say::macro_division_by_zero(),
            Self::UndefinedTangent => say::macro_tangent_of_right_angle(),
            Self::UndefinedDirection => say::macro_angle_of_nothing(),
            Self::NegativeRoot => say::macro_root_of_negative(),
            Self::NegativeDecimalCode => say::macro_decimal_code_negative(),
            Self::InvalidDecimalDigit => say::macro_decimal_code_digit(),
            Self::OutOfRange => say::macro_result_out_of_range(),
        }
    }
}

/// The operation of a G65 block, by its H code.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Operation {
    /// Computes a result with this function and stores it into the variable of P.
    Value(fn(Operands) -> Result<i128, ArithmeticFault>),
    /// Jumps to the sequence number P if this condition holds for Q and R.
    Jump(fn(i64, i64) -> bool),
    /// Raises the user alarm with the number 500 + P.
    Alarm,
}

impl Operation {
    /// The operation of the H code `h`; `None` for an unknown code.
    pub(crate) fn from_h_code(h: i64) -> Option<Self> {
        use Operation::{Alarm, Jump, Value};
        Some(match h {
            1 => Value(|o| Ok(o.j.into())),
            2 => Value(|o| Ok(i128::from(o.j) + i128::from(o.k))),
            3 => Value(|o| Ok(i128::from(o.j) - i128::from(o.k))),
            4 => Value(|o| Ok(i128::from(o.j) * i128::from(o.k))),
            5 => Value(|o| divide(o.j.into(), o.k)),
            11 => Value(|o| Ok((o.j | o.k).into())),
            12 => Value(|o| Ok((o.j & o.k).into())),
            13 => Value(|o| Ok((o.j ^ o.k).into())),
            21 => Value(|o| square_root(o.j)),
            22 => Value(|o| Ok(i128::from(o.j).abs())),
            23 => Value(|o| find_remainder(o.j, o.k)),
            24 => Value(|o| from_decimal_code(o.j)),
            25 => Value(|o| to_decimal_code(o.j)),
            26 => Value(|o| divide(i128::from(o.i) * i128::from(o.j), o.k)),
            27 => Value(|o| Ok(hypotenuse(o.j, o.k))),
            31 => Value(|o| Ok(multiply_by_sine(o.j, i128::from(o.k)))),
            32 => Value(|o| {
                Ok(multiply_by_sine(
                    o.j,
                    i128::from(o.k) + i128::from(QUARTER_TURN),
                ))
            }),
            33 => Value(|o| multiply_by_tangent(o.j, o.k)),
            34 => Value(|o| direction_angle(o.j, o.k)),
            80 => Jump(|_, _| true),
            81 => Jump(|j, k| j == k),
            82 => Jump(|j, k| j != k),
            83 => Jump(|j, k| j > k),
            84 => Jump(|j, k| j < k),
            85 => Jump(|j, k| j >= k),
            86 => Jump(|j, k| j <= k),
            99 => Alarm,
            _ => return None,
        })
    }

    /// Returns which of the letters Q and R the operation of the H code `h` does not read.
    pub(crate) const fn unread_words(h: i64) -> &'static [u8] {
        match h {
            1 | 21 | 22 | 24 | 25 => b"R",
            80 | 99 => b"QR",
            _ => b"",
        }
    }

    /// Whether the result of the H code `h` depends on the previous value of the variable of
    /// P.
    pub(crate) const fn reads_result(h: i64) -> bool {
        h == 26
    }
}

fn divide(dividend: i128, divisor: i64) -> Result<i128, ArithmeticFault> {
    dividend
        .checked_div(divisor.into())
        .ok_or(ArithmeticFault::DivisionByZero)
}

fn find_remainder(dividend: i64, divisor: i64) -> Result<i128, ArithmeticFault> {
    let remainder = i128::from(dividend).checked_rem(divisor.into());
    remainder.ok_or(ArithmeticFault::DivisionByZero)
}

fn square_root(value: i64) -> Result<i128, ArithmeticFault> {
    let value = u64::try_from(value).map_err(|_| ArithmeticFault::NegativeRoot)?;
    Ok(value.isqrt().into())
}

fn hypotenuse(j: i64, k: i64) -> i128 {
    let square = |value: i64| {
        let size = u128::from(value.unsigned_abs());
        size * size
    };
    square(j).saturating_add(square(k)).isqrt() as i128
}

/// Converts a binary-coded decimal, four bits per digit, to its number. Returns an error if the
/// code is negative or has an invalid digit.
fn from_decimal_code(code: i64) -> Result<i128, ArithmeticFault> {
    let mut rest = u64::try_from(code).map_err(|_| ArithmeticFault::NegativeDecimalCode)?;
    let (mut value, mut weight) = (0, 1);
    while rest > 0 {
        let digit = rest & 0xF;
        if digit > 9 {
            return Err(ArithmeticFault::InvalidDecimalDigit);
        }
        value += i128::from(digit) * weight;
        weight *= 10;
        rest >>= 4;
    }
    Ok(value)
}

/// Converts a number to a binary-coded decimal, four bits per digit. Returns an error if the number
/// is negative.
fn to_decimal_code(value: i64) -> Result<i128, ArithmeticFault> {
    let mut rest = u64::try_from(value).map_err(|_| ArithmeticFault::NegativeDecimalCode)?;
    let (mut code, mut shift) = (0, 0);
    while rest > 0 {
        code |= i128::from(rest % 10) << shift;
        shift += 4;
        rest /= 10;
    }
    Ok(code)
}

/// Thousandths of a degree in a quarter turn.
const QUARTER_TURN: i64 = 90_000;
const FULL_TURN: i64 = 4 * QUARTER_TURN;

fn to_radians(thousandths: i64) -> f64 {
    (thousandths as f64 / 1000.0).to_radians()
}

/// Cuts off the fraction, after rounding away the error of the last bits: 1000 · sin 30° is
/// 500.
fn truncate(value: f64) -> i128 {
    const NOISE: f64 = 1e6;
    libm::trunc(libm::round(value * NOISE) / NOISE) as i128
}

fn multiply_by_sine(factor: i64, angle: i128) -> i128 {
    let angle = angle.rem_euclid(FULL_TURN.into()) as i64;
    let factor = i128::from(factor);
    // Exact at the angles with an exact sine.
    match angle {
        0 | 180_000 => 0,
        30_000 | 150_000 => factor / 2,
        90_000 => factor,
        210_000 | 330_000 => -factor / 2,
        270_000 => -factor,
        _ => truncate(factor as f64 * libm::sin(to_radians(angle))),
    }
}

fn multiply_by_tangent(factor: i64, angle: i64) -> Result<i128, ArithmeticFault> {
    let angle = angle.rem_euclid(2 * QUARTER_TURN);
    Ok(match angle {
        0 => 0,
        45_000 => factor.into(),
        QUARTER_TURN => return Err(ArithmeticFault::UndefinedTangent),
        135_000 => -i128::from(factor),
        _ => truncate(factor as f64 * libm::tan(to_radians(angle))),
    })
}

/// The direction of the vector (`k`, `j`) in thousandths of a degree, 0 to 359999: the arc tangent
/// of `j` / `k`. Returns an error if both are 0.
fn direction_angle(j: i64, k: i64) -> Result<i128, ArithmeticFault> {
    if j == 0 && k == 0 {
        return Err(ArithmeticFault::UndefinedDirection);
    }
    let degrees = libm::atan2(j as f64, k as f64).to_degrees();
    let degrees = if degrees < 0.0 {
        degrees + 360.0
    } else {
        degrees
    };
    Ok(truncate(degrees * 1000.0).rem_euclid(FULL_TURN.into()))
}

/// Computes the result of an operation and checks that a variable can store it.
///
/// # Errors
/// The fault of the operation, or `OutOfRange` (alarm 111) for a result that no variable can
/// store.
pub(crate) fn compute(
    function: fn(Operands) -> Result<i128, ArithmeticFault>,
    operands: Operands,
) -> Result<i64, ArithmeticFault> {
    use crate::memory::Variables;
    let value = i64::try_from(function(operands)?).map_err(|_| ArithmeticFault::OutOfRange)?;
    if (Variables::LEAST..=Variables::GREATEST).contains(&value) {
        Ok(value)
    } else {
        Err(ArithmeticFault::OutOfRange)
    }
}
