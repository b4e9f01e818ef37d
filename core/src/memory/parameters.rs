//! The parameters: one value per number, checked on each write.

use core::fmt;
use std::collections::BTreeMap;

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use super::factory_values::FACTORY_VALUES;
use super::parameter;
use super::parameter_table::{self, EffectiveTime, ElectronicDisk, LAST_PARAMETER, ParameterRange};
use crate::alarm::Alarm;
use crate::model::{ModelId, ModelRecord};

const PARAMETER_COUNT: usize = LAST_PARAMETER as usize + 1;

/// The values of the state parameters 001–014, 164, 168, 172–185 and of the data parameters
/// 015–124.
///
/// The caller first checks whether writing is allowed (parameter switch, mode, level); these
/// methods check only numbers and ranges.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "BTreeMap<u16, i32>", try_from = "BTreeMap<u16, i32>")]
pub struct ControlParameters {
    values: Vec<i32>,
}

/// The reason why a parameter was not written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ParameterError {
    /// The control has no parameter or bit with this number.
    Unknown {
        /// Number of the parameter.
        number: u16,
        /// Bit number; `None` if a whole parameter was addressed.
        bit: Option<u8>,
    },
    /// The value is outside the permitted range of the parameter.
    Range {
        /// Number of the parameter.
        number: u16,
        /// The value that was refused.
        value: i32,
        /// The permitted values of the parameter.
        range: ParameterRange,
    },
}

impl ParameterError {
    /// The message that explains to the operator why the value was not written.
    pub fn message(&self) -> Message {
        match self {
            Self::Unknown { number, bit: None } => say::parameter_unknown(number),
            Self::Unknown {
                number,
                bit: Some(bit),
            } => say::parameter_bit_unknown(number, bit),
            Self::Range {
                number,
                value,
                range,
            } => say::parameter_out_of_range(number, value, range),
        }
    }
}

impl fmt::Display for ParameterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.message().fmt(f)
    }
}

impl core::error::Error for ParameterError {}

impl From<ParameterError> for Alarm {
    fn from(error: ParameterError) -> Self {
        Self::new(43).with_detail(error.message())
    }
}

impl Default for ControlParameters {
    fn default() -> Self {
        Self::factory(ElectronicDisk::N0)
    }
}

impl ControlParameters {
    /// The factory values on an electronic disk (manual, appendix 2).
    pub fn factory(disk: ElectronicDisk) -> Self {
        let mut values = vec![0; PARAMETER_COUNT];
        for (number, factory) in FACTORY_VALUES {
            if let Some(value) = values.get_mut(usize::from(*number)) {
                *value = factory[disk.factory_index()];
            }
        }
        Self { values }
    }

    /// The value of a parameter; of a state parameter its eight bits as a byte. 0 for a number
    /// that does not exist.
    #[inline]
    pub fn value(&self, number: u16) -> i32 {
        self.values.get(usize::from(number)).copied().unwrap_or(0)
    }

    /// Returns the eight bits of a state parameter as a byte.
    #[inline]
    pub fn byte(&self, number: u16) -> u8 {
        self.value(number) as u8
    }

    /// A bit of a state parameter, 0 to 7; `false` for a higher bit number.
    #[inline]
    pub fn bit(&self, number: u16, bit: u8) -> bool {
        bit < 8 && self.value(number) >> bit & 1 != 0
    }

    /// Writes a parameter. A negative interval of the pitch error table is stored as a
    /// positive one (manual III-10.5).
    ///
    /// # Errors
    /// An unknown number, or a value out of range (alarm 043).
    pub fn set(&mut self, number: u16, value: i32) -> Result<(), ParameterError> {
        self.set_within(number, value, None)
    }

    /// Writes a parameter of the control model `record`, which may have special ranges.
    ///
    /// # Errors
    /// As [`Self::set`].
    pub fn set_for_model(
        &mut self,
        record: &ModelRecord,
        number: u16,
        value: i32,
    ) -> Result<(), ParameterError> {
        self.set_within(number, value, record.parameter_range(number))
    }

    /// Writes the delivered values in which a control model differs from the GSK980TD.
    pub fn apply_delivered_values(&mut self, record: &ModelRecord) {
        for (number, value) in &record.delivered {
            self.write_unchecked(*number, *value);
        }
    }

    pub(super) fn write_unchecked(&mut self, number: u16, value: i32) {
        if let Some(slot) = self.values.get_mut(usize::from(number)) {
            *slot = value;
        }
    }

    fn set_within(
        &mut self,
        number: u16,
        value: i32,
        range: Option<(i32, i32)>,
    ) -> Result<(), ParameterError> {
        let unknown = ParameterError::Unknown { number, bit: None };
        let Some(row) = parameter_table::parameter_row(number, None) else {
            return Err(unknown);
        };
        let range = match range {
            Some((low, high)) => ParameterRange::Span(low, high),
            None => row.range.clone(),
        };
        let interval = matches!(
            number,
            parameter::X_PITCH_INTERVAL | parameter::Z_PITCH_INTERVAL
        );
        let value = if interval {
            value.saturating_abs()
        } else {
            value
        };
        // Some factory values, such as those of 051 and 055, are below their range. 020
        // accepts more; power-on corrects it.
        let delivered = row.factory.contains(&value);
        let debounce = number == DEBOUNCE && (0..=255).contains(&value);
        if !(range.contains(value) || delivered || debounce) {
            return Err(ParameterError::Range {
                number,
                value,
                range,
            });
        }
        let slot = self.values.get_mut(usize::from(number)).ok_or(unknown)?;
        *slot = value;
        Ok(())
    }

    /// Writes one bit of a state parameter, which may be an unused bit.
    ///
    /// # Errors
    /// A number that is not a state parameter, or a bit above 7.
    pub fn set_bit(&mut self, number: u16, bit: u8, on: bool) -> Result<(), ParameterError> {
        let state = parameter_table::parameter_row(number, None).is_some_and(|row| row.state);
        if !state || bit > 7 {
            return Err(ParameterError::Unknown {
                number,
                bit: Some(bit),
            });
        }
        let rest = self.value(number) & !(1 << bit);
        self.set(number, rest | i32::from(on) << bit)
    }

    /// Corrects values as power-on does: a debounce width 020 above 15 becomes 2.
    pub fn power_on(&mut self) {
        if self.value(DEBOUNCE) > 15 {
            // Cannot fail: 2 is in the range of 020.
            let _ = self.set(DEBOUNCE, 2);
        }
    }

    /// Whether a value differs from `before` that needs a power cycle to change (alarm 000).
    pub(crate) fn needs_power_cycle(&self, before: &Self) -> bool {
        parameter_table::parameter_rows().iter().any(|row| {
            row.effective == EffectiveTime::AtPowerOn { alarm: true }
                && match row.bit {
                    Some(bit) => self.bit(row.number, bit) != before.bit(row.number, bit),
                    None => self.value(row.number) != before.value(row.number),
                }
        })
    }

    /// A copy of these values in which those that take effect at power-on with alarm 000 are
    /// as `at_power_on`.
    #[must_use]
    pub(crate) fn active_values(&self, at_power_on: &Self) -> Self {
        let mut in_force = self.clone();
        for row in parameter_table::parameter_rows() {
            if row.effective != (EffectiveTime::AtPowerOn { alarm: true }) {
                continue;
            }
            match row.bit {
                // Cannot fail: the row is a bit of a state parameter.
                Some(bit) => {
                    let _ = in_force.set_bit(row.number, bit, at_power_on.bit(row.number, bit));
                }
                None => in_force.write_unchecked(row.number, at_power_on.value(row.number)),
            }
        }
        in_force
    }

    /// Returns all parameters with their values, by number.
    pub fn iter(&self) -> impl Iterator<Item = (u16, i32)> {
        let numbers = FACTORY_VALUES.iter().map(|(number, _)| *number);
        numbers.map(|number| (number, self.value(number)))
    }
}

const DEBOUNCE: u16 = 20;

impl From<ControlParameters> for BTreeMap<u16, i32> {
    fn from(parameters: ControlParameters) -> Self {
        parameters.iter().collect()
    }
}

/// Takes over stored values. A number that is missing gets its factory value.
impl TryFrom<BTreeMap<u16, i32>> for ControlParameters {
    type Error = ParameterError;

    fn try_from(values: BTreeMap<u16, i32>) -> Result<Self, ParameterError> {
        let mut parameters = Self::default();
        for (number, value) in values {
            // The control model is stored elsewhere: accept a value that any model allows.
            let mut models = ModelId::ALL.iter().map(|id| id.record());
            let is_in_model_range = |record: &'static ModelRecord| {
                let range = record.parameter_range(number);
                range.is_some_and(|(low, high)| (low..=high).contains(&value))
            };
            match models.find(|record| is_in_model_range(record)) {
                Some(record) => parameters.set_for_model(record, number, value)?,
                None => parameters.set(number, value)?,
            }
        }
        Ok(parameters)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factory_values() {
        let parameters = ControlParameters::default();
        assert_eq!(parameters.value(23), 7600);
        assert_eq!(parameters.byte(12), 0b0010_1011);
        assert!(parameters.bit(3, 4) && !parameters.bit(1, 4));
        assert_eq!(ControlParameters::factory(ElectronicDisk::N2).value(24), 50);
        assert_eq!(parameters.value(200), 0);
        assert!(!parameters.bit(12, 8) && !parameters.bit(12, 255));
    }

    #[test]
    fn writes_are_checked() {
        let mut parameters = ControlParameters::default();
        parameters.set(51, 4000).unwrap();
        parameters.set(51, 0).unwrap();
        let error = parameters.set(22, 15001).unwrap_err();
        assert_eq!(
            error.to_string(),
            "parameter 022: 15001 is outside 6..15000"
        );
        assert_eq!(Alarm::from(error).number, 43);
        assert!(parameters.set(0, 0).is_err() && parameters.set(125, 0).is_err());
        assert!(parameters.set(1, 256).is_err());
        parameters.set_bit(1, 4, true).unwrap();
        assert_eq!(parameters.byte(1), 0b0001_0000);
        assert!(parameters.set_bit(22, 0, true).is_err());
        assert!(parameters.set_bit(1, 8, true).is_err());
    }

    #[test]
    fn debounce_is_corrected_at_power_on() {
        let mut parameters = ControlParameters::default();
        parameters.set(20, 16).unwrap();
        parameters.power_on();
        assert_eq!(parameters.value(20), 2);
    }

    #[test]
    fn some_changes_need_a_power_cycle() {
        let before = ControlParameters::default();
        let mut parameters = before.clone();
        parameters.set(22, 4000).unwrap();
        parameters.set(20, 5).unwrap();
        assert!(!parameters.needs_power_cycle(&before));
        parameters.set_bit(11, 6, true).unwrap();
        assert!(parameters.needs_power_cycle(&before));
        let in_force = parameters.active_values(&before);
        assert_eq!(in_force.value(22), 4000);
        assert!(!in_force.bit(11, 6));
    }

    #[test]
    fn stored_values_are_checked() {
        let mut parameters = ControlParameters::factory(ElectronicDisk::N3);
        parameters.set(84, 8).unwrap();
        let text = ron::to_string(&parameters).unwrap();
        assert_eq!(
            ron::from_str::<ControlParameters>(&text).unwrap(),
            parameters
        );
        assert_eq!(
            ron::from_str::<ControlParameters>("{22:4000}")
                .unwrap()
                .value(22),
            4000
        );
        assert!(ron::from_str::<ControlParameters>("{22:70000}").is_err());
        assert!(ron::from_str::<ControlParameters>("{999:0}").is_err());
    }
}
