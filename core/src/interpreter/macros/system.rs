//! Variables of macro B by their numbers.
//!
//! ```text
//!   #0                    null
//!   #1–#33                of the call                        levels
//!   #100–#199 #500–#999   of all programs; #200–#231 too     memory
//!   #1000–#1133           signals of the ladder
//!   #4001–#4004           G code of the groups 01 to 04      modal
//!   #4109 #4113 #4114 #4115 #4119 #4120   F M N O S T
//!   #5001 #5002           end of the last block              programmed
//!   #5021 #5022           position                           machine
//!   #5041 #5042           position, offset included          work
//!   #5081 #5082           tool offset in force
//! ```
//!
//! The axes of the lathe are 1, X as it is programmed, and 2, Z.

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::{ProgramId, Source};
use crate::interpreter::context::exact::Exact;
use crate::interpreter::context::host::Host;
use crate::interpreter::context::state::State;
use crate::interpreter::macros::formula::{self, Value};
use crate::interpreter::macros::levels::{LOCALS, Levels};
use crate::interpreter::macros::variable::{NotNow, Slot};
use crate::memory::Variables;
use crate::program::{Block, Expression, Program, Syntax};

/// What variables are read from, besides the host.
pub(crate) struct Known<'a> {
    pub(crate) levels: &'a Levels,
    /// After the block before.
    pub(crate) state: State,
    pub(crate) source: Source,
}

impl Known<'_> {
    /// The value of a variable.
    pub(crate) fn read(&self, number: u32, host: &impl Host) -> Result<Value, NotNow> {
        match number {
            0 => Ok(None),
            1..=LOCALS => Ok(self.levels.get(number as u8)),
            1000..=1133 => {
                let slot = Slot::find(number as u16, host)?;
                Ok(Some(slot.read(host)? as f64))
            }
            4000..=4999 => self
                .modal(number, host)
                .ok_or_else(|| unknown(number))
                .map(Some),
            5000..=5999 => self.position(number, host).map(Some),
            _ => Ok(host.variables().real(common(number)?)),
        }
    }

    /// A block with values in the place of its formulas.
    pub(crate) fn words(
        &self,
        block: &Block,
        formulas: &[Expression],
        syntax: Syntax,
        host: &impl Host,
    ) -> Result<Block, NotNow> {
        let read = |number| self.read(number, host);
        let block = formula::in_words(block, formulas, syntax, &read)?;
        if block.has_g(65) {
            let detail = say::macro_code_from_variable();
            return Err(Alarm::new(number::BAD_IN_MACRO).because(detail).into());
        }
        Ok(block)
    }

    fn modal(&self, number: u32, host: &impl Host) -> Option<f64> {
        let modal = &self.state.modal;
        Some(match number {
            4001 => modal.motion.into(),
            4002 => {
                if modal.surface_speed {
                    96.0
                } else {
                    97.0
                }
            }
            4003 => {
                if modal.feed_per_revolution {
                    99.0
                } else {
                    98.0
                }
            }
            4004 => modal.nose_compensation.into(),
            4109 => modal.feed,
            4113 => modal.m.unwrap_or(0).into(),
            4114 => self.source.sequence.map_or(0, u32::from).into(),
            4115 => match self.source.program {
                ProgramId::Stored(number) => number.into(),
                _ => {
                    let program = host.programs().get(self.source.program);
                    program.and_then(Program::number).unwrap_or(0).into()
                }
            },
            4119 => modal.spindle,
            4120 => (u16::from(modal.tool) * 100 + u16::from(modal.offset)).into(),
            _ => return None,
        })
    }

    fn position(&self, number: u32, host: &impl Host) -> Result<f64, NotNow> {
        let state = &self.state;
        let machine = || match host.settled() {
            true => Ok(Exact::from_point(host.machine_position())),
            false => Err(NotNow::Wait),
        };
        let point = match number {
            5001 | 5002 => state.position,
            5021 | 5022 => machine()?,
            5041 | 5042 => machine()? - state.zero,
            5081 | 5082 => state.offset,
            _ => return Err(unknown(number)),
        };
        let radius = host.parameters().radius_programming();
        let millionths = match (number % 10, radius) {
            (1, true) => point.x / 2,
            (1, false) => point.x,
            _ => point.z,
        };
        Ok(millionths as f64 / 1e6)
    }
}

/// The number of a variable that all programs have.
fn common(number: u32) -> Result<u16, NotNow> {
    let common = u16::try_from(number).ok();
    let common = common.filter(|it| Variables::has_real(*it));
    common.ok_or_else(|| unknown(number))
}

fn unknown(number: u32) -> NotNow {
    Alarm::new(number::BAD_VARIABLE)
        .because(say::variable_of_macro_unknown(number))
        .into()
}

/// Gives a variable its value.
///
/// # Errors
/// 111 for a value that it cannot hold, 115 for a number that is none, 116 for one that is
/// only read; or an output of the ladder before everything is finished.
pub(crate) fn write(
    number: u32,
    value: Value,
    levels: &mut Levels,
    host: &mut impl Host,
) -> Result<(), NotNow> {
    let value = value.map(formula::kept);
    match number {
        1..=LOCALS => levels.set(number as u8, value),
        0 | 4000..=5999 => {
            let detail = say::variable_of_macro_read_only(number);
            return Err(Alarm::new(number::READ_ONLY).because(detail).into());
        }
        1000..=1133 => {
            let slot = Slot::find(number as u16, host)?;
            let whole = formula::rounded(value.unwrap_or(0.0)) as i64;
            slot.check(whole, host)?;
            slot.write(whole, host)?;
        }
        _ => host.variables_mut().set_real(common(number)?, value)?,
    }
    Ok(())
}
