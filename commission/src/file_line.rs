//! Line parser of the measurement files: numbers, directions, axes, and their errors.

use gsk_core::units::parse_finite;
use gsk_messages::{Message, say};

use crate::measurement::ApproachDirection;

pub(crate) const MAX_READINGS: usize = 20_000;
const MAX_POSITION_MM: f64 = 9999.999;
/// Larger values are in a wrong unit.
const MAX_VALUE_UM: f64 = 10_000.0;

/// An error in a line of a measurement file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileFault {
    /// Line in the file, from 1.
    pub line: u32,
    /// The rule that is broken, as a message.
    pub rule: Message,
}

impl FileFault {
    pub(crate) const fn new(line: u32, rule: Message) -> Self {
        Self { line, rule }
    }

    /// Returns the rule with the line number in front.
    pub fn message(&self) -> Message {
        say::pitch_file_line(self.line, self.rule.clone())
    }
}

/// Lists the lines with content, numbered from 1, without comments.
pub(crate) fn lines(text: &str) -> impl Iterator<Item = (u32, &str)> {
    (1..)
        .zip(text.lines())
        .map(|(number, line)| (number, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with(['#', '!']))
}

pub(crate) fn parse_number(line: u32, field: &str) -> Result<f64, FileFault> {
    parse_finite(field.trim()).ok_or_else(|| FileFault::new(line, say::pitch_not_a_number(field)))
}

/// Parses a position in mm.
pub(crate) fn parse_position(line: u32, field: &str) -> Result<f64, FileFault> {
    let value = parse_number(line, field)?;
    if value.abs() > MAX_POSITION_MM {
        let rule = say::pitch_position_too_far(value, MAX_POSITION_MM);
        return Err(FileFault::new(line, rule));
    }
    Ok(value)
}

/// Checks a deviation in µm.
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

/// Parses an axis letter of the machine.
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
