//! Macro variables: the integers #200–#231 and #500–#515 (manual I-3.7.2), and the real
//! numbers #100–#199 and #500–#999 of macro B. A number in both ranges is one variable:
//! macro A reads it without its fraction.

use std::collections::BTreeMap;

use gsk_messages::say;
use serde::{Deserialize, Serialize};

use crate::alarm::{Alarm, number};

/// First number and count of the numbers of the two groups of variables of macro A.
const MACRO_A_GROUPS: [(u16, usize); 2] = [(200, 32), (500, 16)];
const MACRO_A_COUNT: usize = 48;

/// Numbers of the real variables that are kept over power-off; the next ones are not.
const RETAINED_NUMBERS: core::ops::RangeInclusive<u16> = 500..=999;
const VOLATILE_NUMBERS: core::ops::RangeInclusive<u16> = 100..=199;
/// Numbers of the variables of Huaxing lathes, which are not kept over power-off.
const HUAXING_NUMBERS: core::ops::RangeInclusive<u16> = 1..=99;

/// The common variables of macro A and macro B, which all programs share. They are kept over
/// power-off, except #100 to #199. A variable without a value is zero, or null if only macro B
/// has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "BTreeMap<u16, Stored>", try_from = "BTreeMap<u16, Stored>")]
pub struct Variables {
    values: [i64; MACRO_A_COUNT],
    /// Values with a fraction, and values of variables that only macro B has.
    reals: BTreeMap<u16, f64>,
}

/// A variable as it is serialized: integer, real or empty.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(untagged)]
enum Stored {
    Whole(i64),
    Real(f64),
}

impl Default for Variables {
    fn default() -> Self {
        Self {
            values: [0; MACRO_A_COUNT],
            reals: BTreeMap::new(),
        }
    }
}

impl Variables {
    /// Least value of an integer variable, −2³².
    pub const LEAST: i64 = -(1 << 32);
    /// Greatest value of an integer variable, 2³² − 1.
    pub const GREATEST: i64 = (1 << 32) - 1;
    /// Greatest absolute value of a real variable.
    pub const GREATEST_REAL: f64 = 1e47;

    /// Whether macro A has a common variable with this number.
    pub fn has_integer(number: u16) -> bool {
        value_index(number).is_some()
    }

    /// The numbers of the common variables of macro A, ascending.
    pub fn numbers() -> impl Iterator<Item = u16> {
        MACRO_A_GROUPS
            .into_iter()
            .flat_map(|(first, count)| (first..).take(count))
    }

    /// The value of a variable of macro A; `None` if macro A has no such variable.
    pub fn get(&self, number: u16) -> Option<i64> {
        self.values.get(value_index(number)?).copied()
    }

    /// Sets a variable of macro A.
    ///
    /// # Errors
    /// 115 for an invalid number, 111 for a value beyond −2³² to 2³² − 1.
    pub fn set(&mut self, number: u16, value: i64) -> Result<(), Alarm> {
        let Some(slot) = value_index(number).and_then(|index| self.values.get_mut(index)) else {
            let detail = say::variable_not_common(number);
            return Err(Alarm::new(number::BAD_VARIABLE).with_detail(detail));
        };
        if !(Self::LEAST..=Self::GREATEST).contains(&value) {
            let detail = say::variable_value_out_of_range(value, number);
            return Err(Alarm::new(number::MACRO_RANGE).with_detail(detail));
        }
        *slot = value;
        self.reals.remove(&number);
        Ok(())
    }

    /// Whether macro B has a common variable with this number.
    pub(crate) fn has_real(number: u16) -> bool {
        RETAINED_NUMBERS.contains(&number)
            || VOLATILE_NUMBERS.contains(&number)
            || Self::has_integer(number)
    }

    /// The numbers that the variable page lists if programs use macro B: the local variables
    /// #1 to #33 and all common ones.
    pub fn numbers_of_macro_b() -> impl Iterator<Item = u16> {
        let (first, count) = MACRO_A_GROUPS[0];
        let of_both = (first..).take(count);
        (1..=33)
            .chain(VOLATILE_NUMBERS)
            .chain(of_both)
            .chain(RETAINED_NUMBERS)
    }

    /// The numbers of the variables of Huaxing lathes.
    pub fn numbers_of_huaxing() -> impl Iterator<Item = u16> {
        HUAXING_NUMBERS
    }

    /// The value of a variable of the Huaxing lathes; `None` is the value null.
    pub(crate) fn huaxing_value(&self, number: u16) -> Option<f64> {
        self.reals.get(&number).copied()
    }

    /// Sets a variable of the Huaxing lathes; `None` is the value null.
    ///
    /// # Errors
    /// 111 for a value that formulas cannot yield.
    pub(crate) fn set_huaxing_value(
        &mut self,
        number: u16,
        value: Option<f64>,
    ) -> Result<(), Alarm> {
        match value.filter(|_| HUAXING_NUMBERS.contains(&number)) {
            Some(value) => self.reals.insert(number, Self::check_real(number, value)?),
            None => self.reals.remove(&number),
        };
        Ok(())
    }

    /// The value of a variable as macro B reads it; `None` is the value null.
    pub fn real_value(&self, number: u16) -> Option<f64> {
        let real = self.reals.get(&number).copied();
        real.or_else(|| self.get(number).map(|whole| whole as f64))
    }

    /// Sets a variable to the result of a formula; `None` is null, which a variable of macro A
    /// stores as 0.
    ///
    /// # Errors
    /// 115 for an invalid number. 111 for a value that macro A could not read, and for one
    /// that formulas cannot yield.
    pub fn set_real(&mut self, number: u16, value: Option<f64>) -> Result<(), Alarm> {
        if Self::has_integer(number) {
            let value = Self::check_real(number, value.unwrap_or(0.0))?;
            self.set(number, libm::trunc(value) as i64)?;
            if libm::trunc(value) != value {
                self.reals.insert(number, value);
            }
            return Ok(());
        }
        if !Self::has_real(number) {
            let detail = say::variable_not_common(number);
            return Err(Alarm::new(number::BAD_VARIABLE).with_detail(detail));
        }
        match value {
            Some(value) => self.reals.insert(number, Self::check_real(number, value)?),
            None => self.reals.remove(&number),
        };
        Ok(())
    }

    /// Returns `value` if a variable can store it. `number`, in the alarm, may be a local
    /// variable.
    ///
    /// # Errors
    /// 111 for NaN and for a value that formulas cannot yield.
    pub(crate) fn check_real(number: u16, value: f64) -> Result<f64, Alarm> {
        if (-Self::GREATEST_REAL..=Self::GREATEST_REAL).contains(&value) {
            return Ok(value);
        }
        let detail = say::variable_value_beyond_formulas(format_args!("{value:e}"), number);
        Err(Alarm::new(number::MACRO_RANGE).with_detail(detail))
    }

    /// Removes the values that are not kept over power-off.
    pub fn power_on(&mut self) {
        self.reals.retain(|number, _| {
            !VOLATILE_NUMBERS.contains(number) && !HUAXING_NUMBERS.contains(number)
        });
    }
}

fn value_index(number: u16) -> Option<usize> {
    let mut before = 0;
    for (first, count) in MACRO_A_GROUPS {
        let within = usize::from(number.wrapping_sub(first));
        if within < count {
            return Some(before + within);
        }
        before += count;
    }
    None
}

impl From<Variables> for BTreeMap<u16, Stored> {
    fn from(variables: Variables) -> Self {
        let valued = |number| Some((number, variables.get(number)?));
        let all = Variables::numbers().filter_map(valued);
        let whole = all.filter(|(_, value)| *value != 0);
        let whole = whole.map(|(number, value)| (number, Stored::Whole(value)));
        let reals = variables.reals.iter();
        let reals = reals.map(|(number, value)| (*number, Stored::Real(*value)));
        whole.chain(reals).collect()
    }
}

impl TryFrom<BTreeMap<u16, Stored>> for Variables {
    type Error = Alarm;

    fn try_from(values: BTreeMap<u16, Stored>) -> Result<Self, Alarm> {
        let mut variables = Self::default();
        for (number, value) in values {
            match value {
                Stored::Whole(value) if Self::has_integer(number) => {
                    variables.set(number, value)?;
                }
                Stored::Whole(value) => variables.set_real(number, Some(value as f64))?,
                // Earlier versions stored such values from project folders. The variable is
                // empty then, and the reader of the file reports it.
                Stored::Real(value) if !value.is_finite() => {}
                Stored::Real(value) if HUAXING_NUMBERS.contains(&number) => {
                    variables.set_huaxing_value(number, Some(value))?;
                }
                Stored::Real(value) => variables.set_real(number, Some(value))?,
            }
        }
        Ok(variables)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_range() {
        let mut variables = Variables::default();
        let numbers: Vec<u16> = Variables::numbers().collect();
        assert_eq!(numbers.len(), MACRO_A_COUNT);
        for (value, number) in (0..).zip(&numbers) {
            variables.set(*number, value).unwrap();
        }
        for (value, number) in (0..).zip(&numbers) {
            assert_eq!(variables.get(*number), Some(value));
        }
        for number in [0, 199, 232, 499, 516, 1000, 9200, u16::MAX] {
            assert!(!Variables::has_integer(number));
            assert_eq!(variables.set(number, 0).unwrap_err().number, 115);
        }
        for value in [Variables::LEAST, Variables::GREATEST] {
            variables.set(200, value).unwrap();
            let beyond = value + value.signum();
            assert_eq!(variables.set(200, beyond).unwrap_err().number, 111);
            assert_eq!(variables.get(200), Some(value));
        }
    }

    #[test]
    fn stored_values_are_checked() {
        let mut variables = Variables::default();
        variables.set(231, -5).unwrap();
        variables.set(515, 7).unwrap();
        let text = ron::to_string(&variables).unwrap();
        assert_eq!(text, "{231:-5,515:7}");
        assert_eq!(ron::from_str::<Variables>(&text).unwrap(), variables);
        assert!(ron::from_str::<Variables>("{232:1}").is_err());
        assert!(ron::from_str::<Variables>("{200:4294967296}").is_err());
        let damaged = ron::from_str::<Variables>("{500:NaN,501:7,600:-inf,601:2.5}").unwrap();
        let values = [500, 501, 600, 601].map(|number| damaged.real_value(number));
        assert_eq!(values, [Some(0.0), Some(7.0), None, Some(2.5)]);
    }

    #[test]
    fn no_variable_takes_a_value_that_is_not_finite() {
        let mut variables = Variables::default();
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e48] {
            for number in [500, 600, 100] {
                let refused = variables.set_real(number, Some(value)).unwrap_err();
                assert_eq!(refused.number, 111, "#{number} = {value}");
            }
            assert_eq!(
                variables
                    .set_huaxing_value(7, Some(value))
                    .unwrap_err()
                    .number,
                111
            );
        }
        assert_eq!(variables, Variables::default());
    }
}
