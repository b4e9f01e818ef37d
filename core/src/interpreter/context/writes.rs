//! Parameters that a cycle writes.

use serde::{Deserialize, Serialize};

use crate::interpreter::context::exact::scaled;
use crate::memory::{ParameterError, Parameters};

/// Parameters to be written when the block is carried out.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Writes(Vec<(u16, i32)>);

impl Writes {
    /// A whole number.
    pub(crate) fn push(&mut self, number: u16, value: i64) {
        let value = i32::try_from(value).unwrap_or(if value < 0 { i32::MIN } else { i32::MAX });
        self.0.push((number, value));
    }

    /// A length in millionths, as thousandths.
    pub(crate) fn push_length(&mut self, number: u16, length: i64) {
        self.push(number, scaled(length, 1, 1000));
    }

    /// The value of a parameter after these writes.
    pub(crate) fn value(&self, number: u16, parameters: &Parameters) -> i32 {
        let written = self.0.iter().rev().find(|(written, _)| *written == number);
        written.map_or_else(|| parameters.value(number), |(_, value)| *value)
    }

    /// Carries the writes out.
    #[inline]
    pub(crate) fn apply(&mut self, parameters: &mut Parameters) -> Result<(), ParameterError> {
        if self.0.is_empty() {
            return Ok(());
        }
        for (number, value) in core::mem::take(&mut self.0) {
            parameters.set(number, value)?;
        }
        Ok(())
    }
}
