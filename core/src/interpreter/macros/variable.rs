//! References to variables: finds what `#i` refers to when the reader reads its block.
//!
//! ```text
//!   #200–#231 #500–#515   common, read and written at once
//!   #9nnn                 the variable whose number is in #nnn
//!   #1000–#1015 #1032     G54, G55 of the ladder   | wait until every
//!   #1100–#1115 #1132     F54, F55 to the ladder   | earlier command
//!   #1133                 F56–F59 to the ladder    | is finished
//! ```

use gsk_messages::{Message, say};

use crate::alarm::{Alarm, number};
use crate::command::MotionCode;
use crate::interpreter::codes::count_words::CountWords;
use crate::interpreter::host::Host;
use crate::memory::Variables;
use crate::program::{BlockError, ProgramBlock, Syntax, VariableReference};

/// The reason why a block cannot be read, or a variable not read or written, at this moment.
#[derive(Clone, Debug, PartialEq)]
pub enum ReadError {
    /// The block must wait until every earlier command is finished.
    Wait,
    /// Reading fails: the block raises this alarm.
    Fault(Alarm),
}

impl From<Alarm> for ReadError {
    fn from(alarm: Alarm) -> Self {
        Self::Fault(alarm)
    }
}

impl From<BlockError> for ReadError {
    fn from(error: BlockError) -> Self {
        Self::Fault(error.into())
    }
}

/// A variable of macro A, which G65 can read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MacroVariable {
    /// A common variable by its number, #200–#231 or #500–#515.
    Common(u16),
    /// #1000–#1015: one input from the ladder, bit 0 to 15.
    Input(u8),
    /// #1032: the sixteen inputs from the ladder as one number.
    Inputs,
    /// #1100–#1115: one output to the ladder, bit 0 to 15.
    Output(u8),
    /// #1132: the sixteen outputs to the ladder as one number.
    Outputs,
    /// #1133: the thirty-two outputs F56–F59 to the ladder as one number.
    MoreOutputs,
}

/// Position of the first bit of #1133 in the outputs of the host.
const MORE_OUTPUTS_SHIFT: u32 = 16;
const LOW_16: u64 = 0xFFFF;
const LOW_32: u64 = 0xFFFF_FFFF;

impl MacroVariable {
    /// Finds the variable with the number `number`. #9nnn is the variable whose number is in
    /// #nnn.
    ///
    /// # Errors
    /// 115 for an unknown number.
    pub(crate) fn find(number: u16, host: &impl Host) -> Result<Self, Alarm> {
        if !(9000..=9999).contains(&number) {
            return Self::from_number(number)
                .ok_or_else(|| illegal_variable_alarm(say::variable_unknown(number)));
        }
        let pointer = number - 9000;
        if !Variables::has_integer(pointer) {
            return Err(illegal_variable_alarm(say::variable_unknown_through(
                number, pointer,
            )));
        }
        let target_number = host.variables().get(pointer).unwrap_or(0);
        let variable = u16::try_from(target_number)
            .ok()
            .and_then(Self::from_number);
        variable.ok_or_else(|| {
            illegal_variable_alarm(say::variable_unknown_meant(number, pointer, target_number))
        })
    }

    fn from_number(number: u16) -> Option<Self> {
        match number {
            1000..=1015 => Some(Self::Input((number - 1000) as u8)),
            1032 => Some(Self::Inputs),
            1100..=1115 => Some(Self::Output((number - 1100) as u8)),
            1132 => Some(Self::Outputs),
            1133 => Some(Self::MoreOutputs),
            _ => Variables::has_integer(number).then_some(Self::Common(number)),
        }
    }

    /// Reads the variable; one without a value is 0. For signals of the ladder the caller must
    /// wait until every earlier command is finished.
    pub(crate) fn read(self, host: &impl Host) -> Result<i64, ReadError> {
        if let Self::Common(number) = self {
            return Ok(host.variables().get(number).unwrap_or(0));
        }
        if !host.is_at_standstill() {
            return Err(ReadError::Wait);
        }
        let word = match self {
            Self::Common(_) => 0,
            Self::Input(bit) => u64::from(host.interface_inputs() >> bit & 1),
            Self::Inputs => host.interface_inputs().into(),
            Self::Output(bit) => host.interface_outputs() >> bit & 1,
            Self::Outputs => host.interface_outputs() & LOW_16,
            Self::MoreOutputs => host.interface_outputs() >> MORE_OUTPUTS_SHIFT & LOW_32,
        };
        Ok(word as i64)
    }

    /// Checks that the variable can be set to `value` now. Every value but zero switches a
    /// single output on.
    ///
    /// # Errors
    /// 116 for inputs, 111 for a value that the variable cannot hold; or a wait for an earlier
    /// command.
    pub(crate) fn check(self, value: i64, host: &impl Host) -> Result<(), ReadError> {
        let greatest = match self {
            Self::Input(_) | Self::Inputs => {
                return Err(Alarm::new(number::READ_ONLY)
                    .with_detail(say::variable_read_only())
                    .into());
            }
            Self::Common(_) => return Ok(()),
            Self::Output(_) => Variables::GREATEST,
            Self::Outputs => LOW_16 as i64,
            Self::MoreOutputs => LOW_32 as i64,
        };
        let is_in_range = matches!(self, Self::Output(_)) || (0..=greatest).contains(&value);
        if !is_in_range {
            return Err(Alarm::new(number::MACRO_RANGE)
                .with_detail(say::variable_word_out_of_range(value, greatest))
                .into());
        }
        if host.is_at_standstill() {
            Ok(())
        } else {
            Err(ReadError::Wait)
        }
    }

    /// Sets the variable to a value that [`Self::check`] has accepted.
    pub(crate) fn write(self, value: i64, host: &mut impl Host) -> Result<(), Alarm> {
        let outputs = host.interface_outputs();
        let changed = match self {
            Self::Common(number) => return host.variables_mut().set(number, value),
            Self::Input(_) | Self::Inputs => return Ok(()),
            Self::Output(bit) => outputs & !(1 << bit) | u64::from(value != 0) << bit,
            Self::Outputs => outputs & !LOW_16 | value as u64 & LOW_16,
            Self::MoreOutputs => outputs & LOW_16 | (value as u64 & LOW_32) << MORE_OUTPUTS_SHIFT,
        };
        host.set_interface_outputs(changed);
        Ok(())
    }
}

fn illegal_variable_alarm(detail: Message) -> Alarm {
    Alarm::new(number::BAD_VARIABLE).with_detail(detail)
}

/// Reads the referenced variable, without the sign of the reference. Returns an error if the
/// variable is invalid or must wait.
pub(crate) fn read_value(variable: VariableReference, host: &impl Host) -> Result<i64, ReadError> {
    MacroVariable::find(variable.number, host)?.read(host)
}

/// Copies a block with its references to variables replaced by numbers; `motion` is the code of
/// group 01 in force before it. Returns an error if a variable is invalid or must wait, or if a
/// number is out of range.
pub(crate) fn resolve_variables(
    block: ProgramBlock,
    syntax: Syntax,
    motion: MotionCode,
    host: &impl Host,
) -> Result<ProgramBlock, ReadError> {
    let counts = CountWords::find(&block, motion);
    let is_count = |address| counts.has(address);
    let block = block.resolve(syntax, is_count, |variable| read_value(variable, host))?;
    if block.has_g(65) {
        return Err(Alarm::new(number::BAD_IN_MACRO)
            .with_detail(say::macro_code_from_variable())
            .into());
    }
    Ok(block)
}
