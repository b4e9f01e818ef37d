//! Evaluates a G65 H block: an operation on variables, a jump, or an alarm (manual I-3.7.3).
//!
//! ```text
//!   G65 Hm P#i Q#j R#k    #i = #j m #k        H01–H34
//!   G65 Hm P n Q#j R#k    to N n if #j m #k   H80–H86; P negative: backward first
//!   G65 H99 P n           raises the alarm 500 + n
//! ```

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::interpreter::context::host::Host;
use crate::interpreter::macros::arithmetic::{self, Operands, Operation};
use crate::interpreter::macros::variable::{NotNow, Slot, value};
use crate::memory::Variables;
use crate::program::{Block, Number};

/// Greatest P of H99.
const LAST_USER_ALARM: i64 = 99;

/// What a G65 block does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Sets a variable to a value.
    Value(Slot, i64),
    /// Jumps to a sequence number; if negative, searches backward first.
    Jump(i64),
    /// Continues with the next block.
    Nothing,
}

/// Evaluates a G65 block without changing anything.
///
/// # Errors
/// 111 to 116, 119, 125, the alarm of H99, or a variable that cannot be read yet.
pub(crate) fn evaluate(block: &Block, host: &impl Host) -> Result<Outcome, NotNow> {
    let Some(h) = block.number(b'H') else {
        return Err(without_h(block).into());
    };
    let h = operand(Some(h), host)?;
    let Some(operation) = Operation::of(h) else {
        return Err(Alarm::new(number::BAD_OPERATION)
            .because(say::macro_operation_unknown(h))
            .into());
    };
    let p = block.number(b'P');
    let values = |i| {
        Ok::<_, NotNow>(Operands {
            i,
            j: operand(block.number(b'Q'), host)?,
            k: operand(block.number(b'R'), host)?,
        })
    };
    match operation {
        Operation::Value(function) => {
            let slot = result(p, host)?;
            let before = if Operation::reads_result(h) {
                slot.read(host)?
            } else {
                0
            };
            let operands = values(before)?;
            let value = arithmetic::work_out(function, operands).map_err(|fault| {
                let Operands { j, k, .. } = operands;
                let detail = say::operation_of(h, j, k, fault.reason());
                Alarm::new(fault.number()).because(detail)
            })?;
            slot.check(value, host)?;
            Ok(Outcome::Value(slot, value))
        }
        Operation::Jump(condition) => {
            let Operands { j, k, .. } = values(0)?;
            if condition(j, k) {
                Ok(Outcome::Jump(operand(p, host)?))
            } else {
                Ok(Outcome::Nothing)
            }
        }
        Operation::Alarm => Err(user_alarm(operand(p, host)?).into()),
    }
}

fn without_h(block: &Block) -> Alarm {
    if block.has(b'P') {
        return Alarm::new(number::BAD_IN_MACRO).because(say::macro_call_with_arguments());
    }
    Alarm::new(number::BAD_OPERATION).because(say::macro_operation_missing())
}

/// A constant, or the value of a variable; 0 if the word is missing.
fn operand(number: Option<Number>, host: &impl Host) -> Result<i64, NotNow> {
    let Some(number) = number else {
        return Ok(0);
    };
    let Some(variable) = number.variable() else {
        let value = number.integer();
        if (Variables::LEAST..=Variables::GREATEST).contains(&value) {
            return Ok(value);
        }
        return Err(Alarm::new(number::MACRO_RANGE)
            .because(say::macro_value_out_of_range(value))
            .into());
    };
    let value = value(variable, host)?;
    Ok(if variable.negative { -value } else { value })
}

/// The variable P of an operation.
fn result(p: Option<Number>, host: &impl Host) -> Result<Slot, NotNow> {
    let variable = p.and_then(Number::variable);
    let Some(variable) = variable.filter(|variable| !variable.negative) else {
        return Err(Alarm::new(number::BAD_VARIABLE)
            .because(say::macro_result_variable_missing())
            .into());
    };
    let slot = Slot::find(variable.number, host)?;
    if matches!(slot, Slot::Input(_) | Slot::Inputs) {
        slot.check(0, host)?;
    }
    Ok(slot)
}

fn user_alarm(p: i64) -> Alarm {
    match u16::try_from(p) {
        Ok(number) if p <= LAST_USER_ALARM => {
            Alarm::new(number::USER_ALARM + number).because(say::macro_user_alarm(p))
        }
        _ => Alarm::new(number::OUT_OF_RANGE)
            .because(say::macro_user_alarm_out_of_range(p, LAST_USER_ALARM)),
    }
}
