//! M functions (manual I-3.3).

use gsk_messages::{Message, say};

use crate::alarm::{Alarm, number};
use crate::dialect;
use crate::interpreter::context::Context;
use crate::interpreter::context::machine_codes::MachineCodes;

/// What an M code is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Function {
    /// M00.
    Stop,
    /// M30.
    End,
    /// M98.
    Call,
    /// M99.
    Return,
    /// Given to the PLC.
    Output(u8),
}

/// Whether an M code has a function of its own, in the control or in the ladder.
pub(crate) const fn has_function(code: u8, machine: MachineCodes) -> bool {
    machine.has(code) || matches!(code, 0 | 3..=5 | 8..=13 | 30 | 32 | 33 | 41..=44 | 98 | 99)
}

/// Sorts an M code; alarm 019 for one that the control does not have.
pub(crate) fn function(code: u8, context: &Context<'_>) -> Result<Function, Alarm> {
    match code {
        0 => Ok(Function::Stop),
        30 => Ok(Function::End),
        98 | 99 if context.mdi => Err(fault(say::m_call_in_mdi(code))),
        98 => Ok(Function::Call),
        99 => Ok(Function::Return),
        3..=5 | 8..=13 | 32 | 33 => Ok(Function::Output(code)),
        41..=44 if context.parameters.automatic_gears() => Ok(Function::Output(code)),
        41..=44 => Err(fault(say::m_needs_gear_change(code))),
        _ if context.machine_codes.has(code) => Ok(Function::Output(code)),
        _ => Err(fault(dialect::advised(
            say::m_unknown(code),
            dialect::instead_of_m(code),
        ))),
    }
}

fn fault(detail: Message) -> Alarm {
    Alarm::new(number::BAD_M).because(detail)
}
