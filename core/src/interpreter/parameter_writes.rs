//! Parameters that a cycle block writes.

use serde::{Deserialize, Serialize};

use crate::interpreter::exact::scale_rounded;
use crate::memory::{ControlParameters, ParameterError};

/// Numbers and values of parameters to write when the reader accepts the block.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ParameterWrites(Vec<(u16, i32)>);

impl ParameterWrites {
    /// Adds a write of `value` to the parameter `number`.
    pub(crate) fn push(&mut self, number: u16, value: i64) {
        let value = i32::try_from(value).unwrap_or(if value < 0 { i32::MIN } else { i32::MAX });
        self.0.push((number, value));
    }

    /// Adds a write of a length to the parameter `number`: `length` is in millionths of a
    /// millimetre, the parameter in thousandths.
    pub(crate) fn push_length(&mut self, number: u16, length: i64) {
        self.push(number, scale_rounded(length, 1, 1000));
    }

    /// The value of a parameter after these writes.
    pub(crate) fn value_after(&self, number: u16, parameters: &ControlParameters) -> i32 {
        let written = self.0.iter().rev().find(|(written, _)| *written == number);
        written.map_or_else(|| parameters.value(number), |(_, value)| *value)
    }

    /// Writes the parameters and empties the list.
    ///
    /// # Errors
    /// A value that the parameter does not take.
    #[inline]
    pub(crate) fn apply(
        &mut self,
        parameters: &mut ControlParameters,
    ) -> Result<(), ParameterError> {
        if self.0.is_empty() {
            return Ok(());
        }
        for (number, value) in core::mem::take(&mut self.0) {
            parameters.set(number, value)?;
        }
        Ok(())
    }
}
