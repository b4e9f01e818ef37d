//! M functions (manual I-3.3).

use crate::alarm::Alarm;
use crate::interpreter::block::Context;
use crate::interpreter::numbers;

use serde::{Deserialize, Serialize};

/// M codes that the machine's ladder carries out beside the control's own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MachineCodes([u64; 2]);

impl MachineCodes {
    /// Those that a ladder names.
    pub fn of(ladder: &gsk_plc::Ladder) -> Self {
        let mut codes = Self::default();
        for m in ladder.m_codes() {
            if let Some(half) = codes.0.get_mut(usize::from(m.code / 64)) {
                *half |= 1 << (m.code % 64);
            }
        }
        codes
    }

    const fn has(self, code: u8) -> bool {
        code < 128 && self.0[(code / 64) as usize] >> (code % 64) & 1 == 1
    }
}

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
        98 | 99 if context.mdi => Err(fault(format!(
            "M{code} calls and returns in programs only, not in MDI"
        ))),
        98 => Ok(Function::Call),
        99 => Ok(Function::Return),
        3..=5 | 8..=13 | 32 | 33 => Ok(Function::Output(code)),
        41..=44 if context.parameters.automatic_gears() => Ok(Function::Output(code)),
        41..=44 => Err(fault(format!(
            "M{code} needs automatic gear change (164.7) and the analog spindle (001.4)"
        ))),
        _ if context.machine_codes.has(code) => Ok(Function::Output(code)),
        _ => Err(fault(format!(
            "M{code:02} is not a function of this control"
        ))),
    }
}

fn fault(detail: String) -> Alarm {
    Alarm::new(numbers::BAD_M).because(detail)
}
