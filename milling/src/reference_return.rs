//! Describes the reference return of each axis of a GSK980MDi by its parameters.

use std::collections::BTreeMap;

use gsk_messages::{Message, say};

use crate::memory::parameter;
use crate::parameter_table::{MillParameterRow, mill_parameter_rows};

/// Values of mill parameters read from a file, by number; missing ones are 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ParameterValues(BTreeMap<u16, i32>);

/// Parameter whose bits, from [`FIRST_SWITCH`] on, are the zero switches of the axes: 1 acts
/// at +24 V, 0 when open.
const SWITCHES: u16 = 4;
const FIRST_SWITCH: usize = 3;
/// Parameter number and bit: 1 if the jog key holds itself during a reference return.
const KEY: (u16, usize) = (11, 2);
/// Number of the parameter whose bits, from bit 0 on, are 1 for axes that return in minus
/// direction.
const DIRECTIONS: u16 = 13;
/// Number of the parameter with the fast speed of a reference return, mm/min.
const FAST: u16 = 31;
const SLOW: u16 = 32;
/// Parameter number and bit: 1 if the axes have absolute encoders.
const ENCODERS: (u16, usize) = (760, 0);
/// Parameter number and bit of a fourth or fifth axis: 1 if its reference return is method D.
const METHOD_D: (u16, usize) = (parameter::ROLLOVER, 6);
/// Number of the axis parameter with the distance of machine zero from the stop, 0.001 mm.
const OFFSET: u16 = 1246;
/// Letters of the axes X, Y and Z.
const BASIC: [char; 3] = ['X', 'Y', 'Z'];

impl ParameterValues {
    /// Parses a line of a parameter file and stores its value: `13=00001000`, `13.3=1` or
    /// `31=3000`. A comment starts with `#` or `;`.
    ///
    /// # Errors
    ///
    /// Returns a message if the form, the number or the value is wrong.
    pub fn parse_line(&mut self, line: &str) -> Result<(), Message> {
        let text = line.split(['#', ';']).next().unwrap_or_default().trim();
        if text.is_empty() {
            return Ok(());
        }
        let form = || say::mill_parameter_form(text);
        let (name, value) = text.split_once('=').ok_or_else(form)?;
        let (name, value) = (name.trim(), value.trim());
        if let Some((number, bit)) = name.split_once('.') {
            let number: u16 = number.parse().map_err(|_| form())?;
            let bit = bit.parse().ok().filter(|bit| *bit < 8_u8);
            let bit = bit.ok_or_else(form)?;
            let known = rows_of_number(number).any(|row| row.bit == Some(bit));
            if !known {
                return Err(say::mill_parameter_unknown(name));
            }
            let on = match value {
                "0" => false,
                "1" => true,
                _ => return Err(form()),
            };
            let whole = self.0.entry(number).or_default();
            *whole = *whole & !(1 << bit) | i32::from(on) << bit;
            return Ok(());
        }
        let number: u16 = name.parse().map_err(|_| form())?;
        let bits = value.len() == 8 && value.bytes().all(|it| matches!(it, b'0' | b'1'));
        let value: i32 = if bits {
            i32::from_str_radix(value, 2).map_err(|_| form())?
        } else {
            value.parse().map_err(|_| form())?
        };
        let mut rows = rows_of_number(number).peekable();
        if rows.peek().is_none() {
            return Err(say::mill_parameter_unknown(name));
        }
        if !rows.any(|row| in_range(row, value)) {
            return Err(say::mill_parameter_range(name, value));
        }
        self.0.insert(number, value);
        Ok(())
    }

    fn value(&self, number: u16) -> i32 {
        self.0.get(&number).copied().unwrap_or(0)
    }

    fn bit(&self, number: u16, bit: usize) -> bool {
        self.value(number) >> bit & 1 == 1
    }

    /// Returns a speed with its parameter number, or the number alone if the file has no
    /// value.
    fn speed(&self, number: u16) -> String {
        match self.0.get(&number) {
            Some(speed) => format!("{speed} mm/min ({number:03})"),
            None => format!("{number:03}"),
        }
    }
}

/// Returns the table rows of a parameter number, which may be that of one axis.
fn rows_of_number(number: u16) -> impl Iterator<Item = &'static MillParameterRow> {
    mill_parameter_rows().iter().filter(move |row| {
        let mut own = row.axes.iter().map(|axis| row.number + axis * 10_000);
        (row.axes.is_empty() && row.number == number) || own.any(|own| own == number)
    })
}

fn in_range(row: &MillParameterRow, value: i32) -> bool {
    let bounds = row.range.split_once("..");
    let bounds = bounds.and_then(|(low, high)| Some((low.parse().ok()?, high.parse().ok()?)));
    match (row.bit, bounds) {
        (Some(_), _) => (0..=255).contains(&value),
        (None, Some((low, high))) => (low..=high).contains(&value),
        (None, None) => true,
    }
}

/// Returns a message about the reference return of each axis, and one about the jog key.
pub fn describe_reference_returns(values: &ParameterValues) -> Vec<Message> {
    let count = usize::try_from(values.value(parameter::AXES))
        .unwrap_or(0)
        .max(3);
    let axis = |index: usize| {
        let own = |number: u16| number + 10_000 * (index as u16 + 1);
        let letter = match BASIC.get(index) {
            Some(letter) => *letter,
            None => match values.value(own(parameter::NAME)) {
                66 => 'B',
                67 => 'C',
                0 if index == 4 => 'C',
                _ => 'A',
            },
        };
        if values.bit(ENCODERS.0, ENCODERS.1) {
            return say::mill_homing_of_absolute(letter);
        }
        let direction = if values.bit(DIRECTIONS, index) {
            '-'
        } else {
            '+'
        };
        let (fast, slow) = (values.speed(FAST), values.speed(SLOW));
        let offset = f64::from(values.value(own(OFFSET))) / 1000.0;
        if index >= BASIC.len() && values.bit(own(METHOD_D.0), METHOD_D.1) {
            return say::mill_homing_of_d(letter, direction, fast, slow, offset);
        }
        let bit = index + FIRST_SWITCH;
        let switch = match values.bit(SWITCHES, bit) {
            true => say::mill_homing_switch_closed(bit),
            false => say::mill_homing_switch_open(bit),
        };
        say::mill_homing_of_switch(letter, direction, fast, switch, slow, offset)
    };
    let mut sentences: Vec<Message> = (0..count.min(5)).map(axis).collect();
    sentences.push(match values.bit(KEY.0, KEY.1) {
        true => say::mill_homing_key_holds(),
        false => say::mill_homing_key_held(),
    });
    sentences
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_messages::Language;

    fn sentences_of(lines: &[&str]) -> Vec<String> {
        let mut values = ParameterValues::default();
        for line in lines {
            assert_eq!(values.parse_line(line), Ok(()), "{line}");
        }
        let sentences = describe_reference_returns(&values);
        sentences.iter().map(|it| it.text(Language::En)).collect()
    }

    #[test]
    fn every_axis_returns_by_its_parameters() {
        let lines = [
            "1010 = 5",
            "13=00010010   # Y and the fifth in minus",
            "4.5=1",
            "31=3000",
            "32=200",
            "",
            "; method D",
            "40188.6=1",
            "41246=-1500",
        ];
        let found = sentences_of(&lines);
        assert_eq!(found.len(), 6);
        assert!(found[0].starts_with('X') && found[0].contains("+ at 3000 mm/min (031)"));
        assert!(found[0].contains("004.3 = 0") && found[2].contains("004.5 = 1"));
        assert!(found[1].contains("- at 3000"), "{}", found[1]);
        assert!(found[3].starts_with('A') && found[3].contains("188.6"));
        assert!(found[3].contains("-1.5"), "{}", found[3]);
        assert!(found[4].starts_with('C') && found[4].contains("- at"));
        let absolute = sentences_of(&["760.0=1"]);
        assert_eq!(absolute.len(), 4);
        assert!(absolute[0].contains("760.0"), "{}", absolute[0]);
    }

    #[test]
    fn an_invalid_value_is_refused() {
        let mut values = ParameterValues::default();
        for line in [
            "31", "x=1", "31=x", "31=5", "32=2000", "4.1=1", "4.8=1", "13.0=2", "999=1", "188=64",
            "10188=64", "4=256",
        ] {
            assert!(values.parse_line(line).is_err(), "{line}");
        }
        assert_eq!(values, ParameterValues::default());
    }
}
