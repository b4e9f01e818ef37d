//! Evaluates formulas of macro B: real numbers, angles in degrees, and null for a variable
//! without a value.

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::interpreter::macros::variable::NotNow;
use crate::memory::Variables;
use crate::program::{Block, Condition, Expression, Function, Operator, Relation, Step, Syntax};

/// A number; `None` is null.
pub(crate) type Value = Option<f64>;

/// What the evaluation of a formula reads.
#[derive(Clone, Copy)]
pub(crate) struct Read<'a> {
    /// Reads a variable by its number.
    pub(crate) variable: &'a dyn Fn(u32) -> Result<Value, NotNow>,
    /// Whether `ASIN` and `ATAN` give −90 to 90 and −180 to 180 degrees instead of 0 to 360.
    pub(crate) signed_angles: bool,
}

impl<'a> Read<'a> {
    /// A context with angles from 0 to 360 degrees.
    pub(crate) const fn of(variable: &'a dyn Fn(u32) -> Result<Value, NotNow>) -> Self {
        Self {
            variable,
            signed_angles: false,
        }
    }

    fn angle(self, degrees: f64) -> f64 {
        if self.signed_angles {
            degrees
        } else {
            turned(degrees)
        }
    }
}

/// Least and greatest absolute value, besides 0.
const LEAST: f64 = 1e-29;
const GREATEST: f64 = Variables::GREATEST_REAL;

/// Evaluates a formula. `ROUND` rounds to a multiple of `unit`: 1, or the least increment of
/// the word that contains the formula.
///
/// # Errors
/// 111, 112, 115 or 119; or a variable that cannot be read yet.
pub(crate) fn evaluate(
    expression: &Expression,
    unit: f64,
    read: Read<'_>,
) -> Result<Value, NotNow> {
    let mut stack: Vec<Value> = Vec::with_capacity(8);
    // The parser has read the formula to its end, so each step finds its operands.
    let operand = |stack: &mut Vec<Value>| stack.pop().flatten().unwrap_or(0.0);
    for step in expression.steps() {
        let result = match *step {
            Step::Number(value) => Some(within(value)?),
            Step::Variable => {
                let index = operand(&mut stack);
                let value = (read.variable)(variable_number(index)?)?;
                value.map(within).transpose()?
            }
            Step::Negate => Some(-operand(&mut stack)),
            Step::Operator(operator) => {
                let right = operand(&mut stack);
                let left = operand(&mut stack);
                Some(within(operate(operator, left, right)?)?)
            }
            Step::Function(function) => {
                Some(within(apply(function, operand(&mut stack), unit, read)?)?)
            }
            Step::ArcTangent => {
                let across = operand(&mut stack);
                let up = operand(&mut stack);
                Some(within(read.angle(arc_tangent(up, across)?))?)
            }
        };
        stack.push(result);
    }
    Ok(stack.pop().flatten())
}

/// A copy of a block with values in place of the formulas of its words.
pub(crate) fn in_words(
    block: &Block,
    formulas: &[Expression],
    syntax: Syntax,
    read: Read<'_>,
) -> Result<Block, NotNow> {
    let mut values = vec![None; formulas.len()];
    for word in block.words() {
        let Some(formula) = word.value.variable() else {
            continue;
        };
        let index = usize::from(formula.number);
        let (Some(value), Some(formula)) = (values.get_mut(index), formulas.get(index)) else {
            continue;
        };
        *value = evaluate(formula, syntax.unit(word.address), read)?;
    }
    Ok(block.with_values(&values, syntax)?)
}

/// Whether a condition holds. Null equals only null; for greater and less it counts as 0.
pub(crate) fn holds(condition: &Condition, read: Read<'_>) -> Result<bool, NotNow> {
    let left = evaluate(&condition.left, 1.0, read)?;
    let right = evaluate(&condition.right, 1.0, read)?;
    let (a, b) = (left.unwrap_or(0.0), right.unwrap_or(0.0));
    Ok(match condition.relation {
        Relation::Equal => left == right,
        Relation::NotEqual => left != right,
        Relation::Greater => a > b,
        Relation::GreaterOrEqual => a >= b,
        Relation::Less => a < b,
        Relation::LessOrEqual => a <= b,
    })
}

/// Rounds a value as a variable stores it: eight significant digits, halves away from zero.
pub(crate) fn kept(value: f64) -> f64 {
    const DIGITS: i32 = 8;
    if value == 0.0 {
        return 0.0;
    }
    let size = value.abs();
    let mut exponent = libm::floor(libm::log10(size)) as i32;
    // The logarithm may be off by one near a power of ten.
    if power_of_ten(exponent + 1) <= size {
        exponent += 1;
    }
    let shift = DIGITS - 1 - exponent;
    let whole = |scaled: f64| libm::floor(scaled + 0.5);
    let size = if shift >= 0 {
        let scale = power_of_ten(shift);
        whole(size * scale) / scale
    } else {
        let scale = power_of_ten(-shift);
        whole(size / scale) * scale
    };
    size.copysign(value)
}

fn power_of_ten(exponent: i32) -> f64 {
    (0..exponent.abs()).fold(1.0, |power, _| {
        if exponent > 0 {
            power * 10.0
        } else {
            power / 10.0
        }
    })
}

/// Relative error of the last bits of a calculation.
const NOISE: f64 = 1e-10;

/// Rounds to a whole number, halves away from zero. A value below a half by the error of the
/// last bits counts as a half: 20.4 * 43.75.
pub(crate) fn rounded(value: f64) -> f64 {
    let size = value.abs();
    libm::floor(size + 0.5 + NOISE * size.max(1.0)).copysign(value)
}

/// The number of the variable that a formula commands.
///
/// # Errors
/// 115 outside 0 to 99999.
pub(crate) fn variable_number(value: f64) -> Result<u32, NotNow> {
    let whole = rounded(value);
    if (0.0..=99_999.0).contains(&whole) {
        return Ok(whole as u32);
    }
    let detail = say::variable_number_of_formula(whole);
    Err(Alarm::new(number::BAD_VARIABLE).because(detail).into())
}

fn within(value: f64) -> Result<f64, NotNow> {
    if value == 0.0 || (LEAST..=GREATEST).contains(&value.abs()) {
        return Ok(value);
    }
    Err(Alarm::new(number::MACRO_RANGE)
        .because(say::formula_out_of_range())
        .into())
}

fn divided_by_zero(detail: gsk_messages::Message) -> NotNow {
    Alarm::new(number::DIVISION_BY_ZERO).because(detail).into()
}

/// The alarm for a value that a function does not take.
fn refused(function: &'static str, value: f64) -> NotNow {
    Alarm::new(number::NEGATIVE_ARGUMENT)
        .because(say::formula_argument_refused(function, value))
        .into()
}

fn operate(operator: Operator, left: f64, right: f64) -> Result<f64, NotNow> {
    Ok(match operator {
        Operator::Add => left + right,
        Operator::Subtract => left - right,
        Operator::Multiply => left * right,
        Operator::Divide if right == 0.0 => {
            return Err(divided_by_zero(say::macro_division_by_zero()));
        }
        Operator::Divide => left / right,
        Operator::Modulo => {
            let (left, right) = (rounded(left), rounded(right));
            if right == 0.0 {
                return Err(divided_by_zero(say::macro_division_by_zero()));
            }
            // The result has the sign of the dividend and is exact.
            left % right
        }
        Operator::And => f64::from(bits("AND", left)? & bits("AND", right)?),
        Operator::Or => f64::from(bits("OR", left)? | bits("OR", right)?),
        Operator::Xor => f64::from(bits("XOR", left)? ^ bits("XOR", right)?),
    })
}

fn bits(name: &'static str, value: f64) -> Result<u32, NotNow> {
    let whole = rounded(value);
    if (0.0..=f64::from(i32::MAX)).contains(&whole) {
        Ok(whole as u32)
    } else {
        Err(refused(name, value))
    }
}

fn apply(function: Function, value: f64, unit: f64, read: Read<'_>) -> Result<f64, NotNow> {
    /// Greatest number of a binary-coded decimal.
    const CODED: f64 = 99_999_999.0;
    Ok(match function {
        Function::Sine => sine(value),
        Function::Cosine => sine(value + 90.0),
        Function::Tangent => tangent(value)?,
        Function::ArcSine if value.abs() > 1.0 => return Err(refused("ASIN", value)),
        Function::ArcSine => read.angle(libm::asin(value).to_degrees()),
        Function::ArcCosine if value.abs() > 1.0 => return Err(refused("ACOS", value)),
        Function::ArcCosine => libm::acos(value).to_degrees(),
        Function::Root if value < 0.0 => return Err(refused("SQRT", value)),
        Function::Root => libm::sqrt(value),
        Function::Absolute => value.abs(),
        // A division by a whole number gives 1.235 and not 1.2350000000000001.
        Function::Round => rounded(value / unit) / rounded(1.0 / unit),
        Function::Fix => libm::trunc(without_noise(value)),
        Function::Up => libm::ceil(without_noise(value).abs()).copysign(value),
        Function::Logarithm if value <= 0.0 => return Err(refused("LN", value)),
        Function::Logarithm => libm::log(value),
        Function::Exponential => libm::exp(value),
        Function::Binary => {
            let code = bits("BIN", value)?;
            let digits = (0..8).map(|place| code >> (4 * place) & 0xF);
            let wrong = || refused("BIN", value);
            digits.rev().try_fold(0.0, |sum, digit| match digit {
                0..=9 => Ok(sum * 10.0 + f64::from(digit)),
                _ => Err(wrong()),
            })?
        }
        Function::DecimalCode => {
            let whole = rounded(value);
            if !(0.0..=CODED).contains(&whole) {
                return Err(refused("BCD", value));
            }
            let mut rest = whole as u64;
            let (mut code, mut weight) = (0, 1);
            while rest > 0 {
                code += rest % 10 * weight;
                rest /= 10;
                weight *= 16;
            }
            code as f64
        }
    })
}

/// Removes the error of the last bits from a whole number: 37.8 - 25.8 is 12.
fn without_noise(value: f64) -> f64 {
    let whole = rounded(value);
    if (value - whole).abs() <= NOISE * value.abs().max(1.0) {
        whole
    } else {
        value
    }
}

/// Exact at the angles with an exact sine.
fn sine(degrees: f64) -> f64 {
    let turned = degrees.rem_euclid(360.0);
    if turned == 0.0 || turned == 180.0 {
        0.0
    } else if turned == 30.0 || turned == 150.0 {
        0.5
    } else if turned == 90.0 {
        1.0
    } else if turned == 210.0 || turned == 330.0 {
        -0.5
    } else if turned == 270.0 {
        -1.0
    } else {
        libm::sin(turned.to_radians())
    }
}

fn tangent(degrees: f64) -> Result<f64, NotNow> {
    let turned = degrees.rem_euclid(180.0);
    if turned == 90.0 {
        return Err(divided_by_zero(say::macro_tangent_of_right_angle()));
    }
    Ok(if turned == 0.0 {
        0.0
    } else if turned == 45.0 {
        1.0
    } else if turned == 135.0 {
        -1.0
    } else {
        libm::tan(turned.to_radians())
    })
}

/// The angle of (`up`, `across`), −180 to 180 degrees.
fn arc_tangent(up: f64, across: f64) -> Result<f64, NotNow> {
    if up == 0.0 && across == 0.0 {
        return Err(divided_by_zero(say::macro_angle_of_nothing()));
    }
    // Adding 0 removes the sign of a negative zero: half a turn is 180.
    Ok(libm::atan2(up + 0.0, across).to_degrees())
}

/// An angle from 0 up to 360 degrees.
fn turned(degrees: f64) -> f64 {
    let turned = if degrees < 0.0 {
        degrees + 360.0
    } else {
        degrees
    };
    if turned == 0.0 { 0.0 } else { turned }
}
