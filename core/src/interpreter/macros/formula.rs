//! Evaluates formulas of macro B: real numbers, angles in degrees, and null for a variable
//! without a value.

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::interpreter::macros::variable::ReadError;
use crate::memory::Variables;
use crate::program::{
    FormulaCode, FormulaFunction, FormulaOperator, FormulaStep, MacroCondition, MacroRelation,
    ProgramBlock, Syntax,
};

/// The value of a formula or variable; `None` is null, a variable without a value.
pub(crate) type FormulaValue = Option<f64>;

/// The variables and the angle range that the evaluation of a formula uses.
#[derive(Clone, Copy)]
pub(crate) struct FormulaContext<'a> {
    /// Function that reads the variable with this number.
    pub(crate) read_variable: &'a dyn Fn(u32) -> Result<FormulaValue, ReadError>,
    /// Whether the results of `ASIN` and `ATAN` are −90 to 90 and −180 to 180 degrees; if not,
    /// 0 to 360.
    pub(crate) signed_angles: bool,
}

impl FormulaContext<'_> {
    fn normalize_angle(self, degrees: f64) -> f64 {
        if self.signed_angles {
            degrees
        } else {
            to_positive_angle(degrees)
        }
    }
}

/// Least absolute value of a result other than 0.
const MIN_ABSOLUTE: f64 = 1e-29;
const MAX_ABSOLUTE: f64 = Variables::GREATEST_REAL;

/// Evaluates a formula; `None` is null. `ROUND` rounds to a multiple of `unit`: 1, or the
/// least increment of the word that contains the formula.
///
/// # Errors
/// 111 for a value out of range, 112 for a division by 0, 115 for an unknown variable, 119 for
/// a wrong argument; or a wait for a variable.
pub(crate) fn evaluate_formula(
    expression: &FormulaCode,
    unit: f64,
    context: FormulaContext<'_>,
) -> Result<FormulaValue, ReadError> {
    let mut stack: Vec<FormulaValue> = Vec::with_capacity(8);
    // The parser has read the formula to its end, so each step finds its operands.
    let operand = |stack: &mut Vec<FormulaValue>| stack.pop().flatten().unwrap_or(0.0);
    for step in expression.steps() {
        let result = match *step {
            FormulaStep::Number(value) => Some(check_range(value)?),
            FormulaStep::Variable => {
                let index = operand(&mut stack);
                let value = (context.read_variable)(to_variable_number(index)?)?;
                value.map(check_range).transpose()?
            }
            FormulaStep::Negate => Some(-operand(&mut stack)),
            FormulaStep::Operator(operator) => {
                let right = operand(&mut stack);
                let left = operand(&mut stack);
                Some(check_range(apply_operator(operator, left, right)?)?)
            }
            FormulaStep::Function(function) => Some(check_range(apply_function(
                function,
                operand(&mut stack),
                unit,
                context,
            )?)?),
            FormulaStep::ArcTangent => {
                let across = operand(&mut stack);
                let up = operand(&mut stack);
                Some(check_range(
                    context.normalize_angle(arc_tangent(up, across)?),
                )?)
            }
        };
        stack.push(result);
    }
    Ok(stack.pop().flatten())
}

/// Copies a block with the formulas of its words replaced by their values. Returns an error if a
/// formula has no value or must wait, or if a value is out of range.
pub(crate) fn evaluate_words(
    block: &ProgramBlock,
    formulas: &[FormulaCode],
    syntax: Syntax,
    context: FormulaContext<'_>,
) -> Result<ProgramBlock, ReadError> {
    let mut values = vec![None; formulas.len()];
    for word in block.words() {
        let Some(formula) = word.value.variable() else {
            continue;
        };
        let index = usize::from(formula.number);
        let (Some(value), Some(formula)) = (values.get_mut(index), formulas.get(index)) else {
            continue;
        };
        *value = evaluate_formula(formula, syntax.rounding_unit(word.address), context)?;
    }
    Ok(block.with_values(&values, syntax)?)
}

/// Whether a condition holds. Null equals only null; in comparisons of size null counts as 0.
/// Returns an error if one of the formulas has no value or must wait.
pub(crate) fn is_condition_true(
    condition: &MacroCondition,
    context: FormulaContext<'_>,
) -> Result<bool, ReadError> {
    let left = evaluate_formula(&condition.left, 1.0, context)?;
    let right = evaluate_formula(&condition.right, 1.0, context)?;
    let (a, b) = (left.unwrap_or(0.0), right.unwrap_or(0.0));
    Ok(match condition.relation {
        MacroRelation::Equal => left == right,
        MacroRelation::NotEqual => left != right,
        MacroRelation::Greater => a > b,
        MacroRelation::GreaterOrEqual => a >= b,
        MacroRelation::Less => a < b,
        MacroRelation::LessOrEqual => a <= b,
    })
}

/// Rounds a value to eight significant digits, halves away from zero, as a variable stores it.
pub(crate) fn round_to_stored(value: f64) -> f64 {
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
    let round_half_up = |scaled: f64| libm::floor(scaled + 0.5);
    let size = if shift >= 0 {
        let scale = power_of_ten(shift);
        round_half_up(size * scale) / scale
    } else {
        let scale = power_of_ten(-shift);
        round_half_up(size / scale) * scale
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

/// Relative error that calculations may leave in the last bits of a value.
const RELATIVE_ERROR: f64 = 1e-10;

/// Rounds to a whole number, halves away from zero. A value below a half by the error of the
/// last bits counts as a half: 20.4 * 43.75.
pub(crate) fn round_half_away(value: f64) -> f64 {
    let size = value.abs();
    libm::floor(size + 0.5 + RELATIVE_ERROR * size.max(1.0)).copysign(value)
}

/// Converts the value of a formula after `#` to the number of a variable.
///
/// # Errors
/// 115 for a number outside 0 to 99999.
pub(crate) fn to_variable_number(value: f64) -> Result<u32, ReadError> {
    let whole = round_half_away(value);
    if (0.0..=99_999.0).contains(&whole) {
        return Ok(whole as u32);
    }
    let detail = say::variable_number_of_formula(whole);
    Err(Alarm::new(number::BAD_VARIABLE).with_detail(detail).into())
}

fn check_range(value: f64) -> Result<f64, ReadError> {
    if value == 0.0 || (MIN_ABSOLUTE..=MAX_ABSOLUTE).contains(&value.abs()) {
        return Ok(value);
    }
    Err(Alarm::new(number::MACRO_RANGE)
        .with_detail(say::formula_out_of_range())
        .into())
}

fn division_by_zero_alarm(detail: gsk_messages::Message) -> ReadError {
    Alarm::new(number::DIVISION_BY_ZERO)
        .with_detail(detail)
        .into()
}

/// The alarm for an argument outside the range of a function.
fn argument_alarm(function: &'static str, value: f64) -> ReadError {
    Alarm::new(number::NEGATIVE_ARGUMENT)
        .with_detail(say::formula_argument_refused(function, value))
        .into()
}

fn apply_operator(operator: FormulaOperator, left: f64, right: f64) -> Result<f64, ReadError> {
    Ok(match operator {
        FormulaOperator::Add => left + right,
        FormulaOperator::Subtract => left - right,
        FormulaOperator::Multiply => left * right,
        FormulaOperator::Divide if right == 0.0 => {
            return Err(division_by_zero_alarm(say::macro_division_by_zero()));
        }
        FormulaOperator::Divide => left / right,
        FormulaOperator::Modulo => {
            let (left, right) = (round_half_away(left), round_half_away(right));
            if right == 0.0 {
                return Err(division_by_zero_alarm(say::macro_division_by_zero()));
            }
            // The result has the sign of the dividend and is exact.
            left % right
        }
        FormulaOperator::And => f64::from(to_bits("AND", left)? & to_bits("AND", right)?),
        FormulaOperator::Or => f64::from(to_bits("OR", left)? | to_bits("OR", right)?),
        FormulaOperator::Xor => f64::from(to_bits("XOR", left)? ^ to_bits("XOR", right)?),
    })
}

fn to_bits(name: &'static str, value: f64) -> Result<u32, ReadError> {
    let whole = round_half_away(value);
    if (0.0..=f64::from(i32::MAX)).contains(&whole) {
        Ok(whole as u32)
    } else {
        Err(argument_alarm(name, value))
    }
}

fn apply_function(
    function: FormulaFunction,
    value: f64,
    unit: f64,
    context: FormulaContext<'_>,
) -> Result<f64, ReadError> {
    /// Greatest number that the function `BCD` can convert.
    const MAX_DECIMAL_CODE: f64 = 99_999_999.0;
    Ok(match function {
        FormulaFunction::Sine => sine(value),
        FormulaFunction::Cosine => sine(value + 90.0),
        FormulaFunction::Tangent => tangent(value)?,
        FormulaFunction::ArcSine if value.abs() > 1.0 => return Err(argument_alarm("ASIN", value)),
        FormulaFunction::ArcSine => context.normalize_angle(libm::asin(value).to_degrees()),
        FormulaFunction::ArcCosine if value.abs() > 1.0 => {
            return Err(argument_alarm("ACOS", value));
        }
        FormulaFunction::ArcCosine => libm::acos(value).to_degrees(),
        FormulaFunction::Root if value < 0.0 => return Err(argument_alarm("SQRT", value)),
        FormulaFunction::Root => libm::sqrt(value),
        FormulaFunction::Absolute => value.abs(),
        // A division by a whole number gives 1.235 and not 1.2350000000000001.
        FormulaFunction::Round => round_half_away(value / unit) / round_half_away(1.0 / unit),
        FormulaFunction::Fix => libm::trunc(snap_to_integer(value)),
        FormulaFunction::Up => libm::ceil(snap_to_integer(value).abs()).copysign(value),
        FormulaFunction::Logarithm if value <= 0.0 => return Err(argument_alarm("LN", value)),
        FormulaFunction::Logarithm => libm::log(value),
        FormulaFunction::Exponential => libm::exp(value),
        FormulaFunction::Binary => {
            let code = to_bits("BIN", value)?;
            let digits = (0..8).map(|place| code >> (4 * place) & 0xF);
            let bad_digit_alarm = || argument_alarm("BIN", value);
            digits.rev().try_fold(0.0, |sum, digit| match digit {
                0..=9 => Ok(sum * 10.0 + f64::from(digit)),
                _ => Err(bad_digit_alarm()),
            })?
        }
        FormulaFunction::DecimalCode => {
            let whole = round_half_away(value);
            if !(0.0..=MAX_DECIMAL_CODE).contains(&whole) {
                return Err(argument_alarm("BCD", value));
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

/// Rounds a value that differs from a whole number only by the error of the last bits: 37.8 -
/// 25.8 gives 12.
fn snap_to_integer(value: f64) -> f64 {
    let whole = round_half_away(value);
    if (value - whole).abs() <= RELATIVE_ERROR * value.abs().max(1.0) {
        whole
    } else {
        value
    }
}

/// The sine of an angle in degrees, without rounding error at multiples of 30 and 90 degrees
/// whose sine is 0, ±0.5 or ±1.
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

fn tangent(degrees: f64) -> Result<f64, ReadError> {
    let turned = degrees.rem_euclid(180.0);
    if turned == 90.0 {
        return Err(division_by_zero_alarm(say::macro_tangent_of_right_angle()));
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

/// The arc tangent of `up` / `across`, −180 to 180 degrees. Returns an alarm as error if both are
/// 0.
fn arc_tangent(up: f64, across: f64) -> Result<f64, ReadError> {
    if up == 0.0 && across == 0.0 {
        return Err(division_by_zero_alarm(say::macro_angle_of_nothing()));
    }
    // Adding 0 removes the sign of a negative zero: half a turn is 180.
    Ok(libm::atan2(up + 0.0, across).to_degrees())
}

/// Adds a full turn to a negative angle, in degrees, so that the angle is from 0 to 360.
fn to_positive_angle(degrees: f64) -> f64 {
    let turned = if degrees < 0.0 {
        degrees + 360.0
    } else {
        degrees
    };
    if turned == 0.0 { 0.0 } else { turned }
}
