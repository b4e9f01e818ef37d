//! Access to the variables of macro B: the run stores #0 to #33, each control the others.

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::interpreter::macros::formula::{self, FormulaContext, FormulaValue};
use crate::interpreter::macros::levels::{LAST_LOCAL, Levels};
use crate::interpreter::macros::variable::ReadError;

/// Reads the variables above #33, which a control stores.
pub trait VariableReader {
    /// Returns the value of the variable `number`; `None` is null.
    ///
    /// # Errors
    /// 115 for an unknown number, or a wait for a variable that cannot be read yet.
    fn read_system(&self, number: u32) -> Result<Option<f64>, ReadError>;

    /// Whether #1 to #33 are local variables; if not, the control stores them, too.
    fn has_local_variables(&self) -> bool {
        true
    }

    /// Whether the results of `ASIN` and `ATAN` are −90 to 90 and −180 to 180 degrees; if not,
    /// 0 to 360.
    fn signed_angles(&self) -> bool {
        false
    }
}

/// Writes the variables above #33, which a control stores.
pub trait VariableWriter {
    /// Sets the variable `number` to `value`; `None` makes it null.
    ///
    /// # Errors
    /// 115 for an unknown number, 116 for a read-only variable, 043 or 111 for a value that the
    /// variable does not take, or a wait for a variable that cannot be written yet.
    fn write_system(&mut self, number: u32, value: Option<f64>) -> Result<(), ReadError>;

    /// Whether #1 to #33 are local variables; if not, the control stores them, too.
    fn has_local_variables(&self) -> bool {
        true
    }
}

/// Reads the variable `number`: a local one from `levels`, others from the control.
///
/// # Errors
/// As for [`VariableReader::read_system`].
pub(crate) fn read_variable(
    number: u32,
    levels: &Levels,
    variables: &impl VariableReader,
) -> Result<FormulaValue, ReadError> {
    match number {
        0 => Ok(None),
        1..=LAST_LOCAL if variables.has_local_variables() => Ok(levels.get(number as u8)),
        _ => variables.read_system(number),
    }
}

/// Sets the variable `number`: a local one in `levels`, others in the control.
///
/// # Errors
/// 116 for #0; else as for [`VariableWriter::write_system`].
pub(crate) fn write_variable(
    number: u32,
    value: FormulaValue,
    levels: &mut Levels,
    variables: &mut impl VariableWriter,
) -> Result<(), ReadError> {
    let value = value.map(formula::round_to_stored);
    match number {
        0 => {
            let detail = say::variable_of_macro_read_only(number);
            Err(Alarm::new(number::READ_ONLY).with_detail(detail).into())
        }
        1..=LAST_LOCAL if variables.has_local_variables() => {
            levels.set(number as u8, value);
            Ok(())
        }
        _ => variables.write_system(number, value),
    }
}

/// Evaluates with a context whose formulas read from `levels` and `variables`.
pub(crate) fn with_formula_context<T>(
    levels: &Levels,
    variables: &impl VariableReader,
    evaluate: impl FnOnce(FormulaContext<'_>) -> T,
) -> T {
    let read_variable = |number| read_variable(number, levels, variables);
    evaluate(FormulaContext {
        read_variable: &read_variable,
        signed_angles: variables.signed_angles(),
    })
}
