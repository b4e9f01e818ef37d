//! Evaluates a G65 H block: an operation on variables, a jump, or an alarm (manual I-3.7.3).
//!
//! ```text
//!   G65 Hm P#i Q#j R#k    #i = #j m #k        H01–H34
//!   G65 Hm P n Q#j R#k    to N n if #j m #k   H80–H86; P negative: backward first
//!   G65 H99 P n           raises the alarm 500 + n
//! ```

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::interpreter::host::Host;
use crate::interpreter::macros::arithmetic::{self, Operands, Operation};
use crate::interpreter::macros::variable::{MacroVariable, ReadError, read_value};
use crate::memory::Variables;
use crate::program::{ProgramBlock, WordNumber};

/// Greatest P of H99, the number of a user alarm.
const LAST_USER_ALARM: i64 = 99;

/// The effect of a G65 H block, which the caller carries out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MacroBlockEffect {
    /// The block stores this value into this variable.
    Value(MacroVariable, i64),
    /// Jumps to this sequence number; a negative one is searched backward first.
    Jump(i64),
    /// Continues with the next block: the condition of a jump does not hold.
    Nothing,
}

/// Evaluates a G65 H block without changing anything; the caller carries out the effect.
///
/// # Errors
/// 111 to 116, 119, 125, the alarm of H99, or a variable that cannot be read yet.
pub(crate) fn evaluate_macro_block(
    block: &ProgramBlock,
    host: &impl Host,
) -> Result<MacroBlockEffect, ReadError> {
    let Some(h) = block.number(b'H') else {
        return Err(missing_h_alarm(block).into());
    };
    let h = read_operand(Some(h), host)?;
    let Some(operation) = Operation::from_h_code(h) else {
        return Err(Alarm::new(number::BAD_OPERATION)
            .with_detail(say::macro_operation_unknown(h))
            .into());
    };
    let p = block.number(b'P');
    let read_operands = |i| {
        Ok::<_, ReadError>(Operands {
            i,
            j: read_operand(block.number(b'Q'), host)?,
            k: read_operand(block.number(b'R'), host)?,
        })
    };
    match operation {
        Operation::Value(function) => {
            let variable = find_result_variable(p, host)?;
            let before = if Operation::reads_result(h) {
                variable.read(host)?
            } else {
                0
            };
            let operands = read_operands(before)?;
            let value = arithmetic::compute(function, operands).map_err(|fault| {
                let Operands { j, k, .. } = operands;
                let detail = say::operation_of(h, j, k, fault.reason());
                Alarm::new(fault.alarm_number()).with_detail(detail)
            })?;
            variable.check(value, host)?;
            Ok(MacroBlockEffect::Value(variable, value))
        }
        Operation::Jump(condition) => {
            let Operands { j, k, .. } = read_operands(0)?;
            if condition(j, k) {
                Ok(MacroBlockEffect::Jump(read_operand(p, host)?))
            } else {
                Ok(MacroBlockEffect::Nothing)
            }
        }
        Operation::Alarm => Err(user_alarm(read_operand(p, host)?).into()),
    }
}

fn missing_h_alarm(block: &ProgramBlock) -> Alarm {
    if block.has(b'P') {
        return Alarm::new(number::BAD_IN_MACRO).with_detail(say::macro_call_with_arguments());
    }
    Alarm::new(number::BAD_OPERATION).with_detail(say::macro_operation_missing())
}

/// Reads an operand: a constant or the value of a variable; 0 if the word is missing. Returns an
/// error if the constant is out of range, or the variable is invalid or must wait.
fn read_operand(number: Option<WordNumber>, host: &impl Host) -> Result<i64, ReadError> {
    let Some(number) = number else {
        return Ok(0);
    };
    let Some(variable) = number.variable() else {
        let value = number.integer();
        if (Variables::LEAST..=Variables::GREATEST).contains(&value) {
            return Ok(value);
        }
        return Err(Alarm::new(number::MACRO_RANGE)
            .with_detail(say::macro_value_out_of_range(value))
            .into());
    };
    let value = read_value(variable, host)?;
    Ok(if variable.negative { -value } else { value })
}

/// Finds the variable of P, in which an operation stores its result. Returns an error if P names no
/// variable that can be written.
fn find_result_variable(
    p: Option<WordNumber>,
    host: &impl Host,
) -> Result<MacroVariable, ReadError> {
    let variable = p.and_then(WordNumber::variable);
    let Some(variable) = variable.filter(|variable| !variable.negative) else {
        return Err(Alarm::new(number::BAD_VARIABLE)
            .with_detail(say::macro_result_variable_missing())
            .into());
    };
    let result = MacroVariable::find(variable.number, host)?;
    if matches!(result, MacroVariable::Input(_) | MacroVariable::Inputs) {
        result.check(0, host)?;
    }
    Ok(result)
}

fn user_alarm(p: i64) -> Alarm {
    match u16::try_from(p) {
        Ok(number) if p <= LAST_USER_ALARM => {
            Alarm::new(number::USER_ALARM + number).with_detail(say::macro_user_alarm(p))
        }
        _ => Alarm::new(number::OUT_OF_RANGE)
            .with_detail(say::macro_user_alarm_out_of_range(p, LAST_USER_ALARM)),
    }
}
