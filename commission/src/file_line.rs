//! Line parser of the measurement files: numbers, directions, axes, and their errors.

use gsk_core::units::parse_finite;
use gsk_messages::{Message, say};

use crate::measurement::ApproachDirection;

pub(crate) const MAX_READINGS: usize = 20_000;
const MAX_POSITION_MM: f64 = 9999.999;
/// Largest deviation that is accepted, µm. Larger values are in a wrong unit.
const MAX_VALUE_UM: f64 = 10_000.0;

/// A fault in a line of a measurement file: the rule that the line breaks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileFault {
    /// Number of the faulty line in the file, from 1.
    pub line: u32,
    /// The message about the rule that the line breaks.
    pub rule: Message,
}

impl FileFault {
    pub(crate) const fn new(line: u32, rule: Message) -> Self {
        Self { line, rule }
    }

    /// Returns the message about the fault with the line number in front.
    pub fn message(&self) -> Message {
        say::pitch_file_line(self.line, self.rule.clone())
    }
}

/// Returns the lines with content, without comments, each with its number from 1.
pub(crate) fn lines(text: &str) -> impl Iterator<Item = (u32, &str)> {
    (1..)
        .zip(text.lines())
        .map(|(number, line)| (number, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with(['#', '!']))
}

pub(crate) fn parse_number(line: u32, field: &str) -> Result<f64, FileFault> {
    parse_finite(field.trim()).ok_or_else(|| FileFault::new(line, say::pitch_not_a_number(field)))
}

/// Parses a position in mm. `line` is the number of the field's line for the error.
pub(crate) fn parse_position(line: u32, field: &str) -> Result<f64, FileFault> {
    let value = parse_number(line, field)?;
    if value.abs() > MAX_POSITION_MM {
        let rule = say::pitch_position_too_far(value, MAX_POSITION_MM);
        return Err(FileFault::new(line, rule));
    }
    Ok(value)
}

/// Returns a deviation in µm unchanged if it is within the limits. `line` is its line for the
/// error.
pub(crate) fn check_microns(line: u32, value: f64) -> Result<f64, FileFault> {
    if value.abs() > MAX_VALUE_UM {
        let rule = say::pitch_value_too_large(value, MAX_VALUE_UM);
        return Err(FileFault::new(line, rule));
    }
    Ok(value)
}

pub(crate) fn parse_direction(line: u32, field: &str) -> Result<ApproachDirection, FileFault> {
    match field.trim().to_ascii_lowercase().as_str() {
        "+" | "+1" | "1" | "plus" | "forward" | "fwd" | "up" | "正" | "正向" => {
            Ok(ApproachDirection::Plus)
        }
        "-" | "-1" | "2" | "minus" | "reverse" | "rev" | "backward" | "负" | "负向" | "反向" => {
            Ok(ApproachDirection::Minus)
        }
        _ => Err(FileFault::new(line, say::pitch_not_a_direction(field))),
    }
}

/// Parses an axis letter, which must be one of the machine's `axes`. `line` is for the error.
pub(crate) fn parse_axis(line: u32, field: &str, axes: &[char]) -> Result<char, FileFault> {
    let mut letters = field
        .trim()
        .chars()
        .map(|letter| letter.to_ascii_uppercase());
    let letter = letters.next().filter(|_| letters.next().is_none());
    let known = letter.filter(|letter| axes.contains(letter));
    known.ok_or_else(|| {
        let names: Vec<String> = axes.iter().map(ToString::to_string).collect();
        FileFault::new(line, say::pitch_not_an_axis(field, names.join(", ")))
    })
}
