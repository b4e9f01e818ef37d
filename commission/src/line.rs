//! What both forms of a file share: lines, numbers, words, and what is wrong with them.

use gsk_core::units::parse_finite;
use gsk_messages::{Message, say};

use crate::measurement::Direction;

/// Readings that are taken at most.
pub(crate) const MOST_READINGS: usize = 20_000;
/// The farthest position, mm.
const FARTHEST_MM: f64 = 9999.999;
/// The largest value, µm: beyond it the unit is wrong.
const LARGEST_UM: f64 = 10_000.0;

/// What is wrong with a line of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileFault {
    /// The line, from 1.
    pub line: u32,
    /// What is wrong with it.
    pub rule: Message,
}

impl FileFault {
    pub(crate) const fn new(line: u32, rule: Message) -> Self {
        Self { line, rule }
    }

    /// Line and rule.
    pub fn message(&self) -> Message {
        say::pitch_file_line(self.line, self.rule.clone())
    }
}

/// Lines with content, from 1, without remarks.
pub(crate) fn lines(text: &str) -> impl Iterator<Item = (u32, &str)> {
    (1..)
        .zip(text.lines())
        .map(|(number, line)| (number, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with(['#', '!']))
}

/// A number as it stands in a field.
pub(crate) fn number(line: u32, field: &str) -> Result<f64, FileFault> {
    parse_finite(field.trim()).ok_or_else(|| FileFault::new(line, say::pitch_not_a_number(field)))
}

/// A position, mm.
pub(crate) fn position(line: u32, field: &str) -> Result<f64, FileFault> {
    let value = number(line, field)?;
    if value.abs() > FARTHEST_MM {
        let rule = say::pitch_position_too_far(value, FARTHEST_MM);
        return Err(FileFault::new(line, rule));
    }
    Ok(value)
}

/// A deviation or a value, µm.
pub(crate) fn microns(line: u32, value: f64) -> Result<f64, FileFault> {
    if value.abs() > LARGEST_UM {
        let rule = say::pitch_value_too_large(value, LARGEST_UM);
        return Err(FileFault::new(line, rule));
    }
    Ok(value)
}

/// The word of a direction.
pub(crate) fn direction(line: u32, field: &str) -> Result<Direction, FileFault> {
    match field.trim().to_ascii_lowercase().as_str() {
        "+" | "+1" | "1" | "plus" | "forward" | "fwd" | "up" | "正" | "正向" => {
            Ok(Direction::Plus)
        }
        "-" | "-1" | "2" | "minus" | "reverse" | "rev" | "backward" | "负" | "负向" | "反向" => {
            Ok(Direction::Minus)
        }
        _ => Err(FileFault::new(line, say::pitch_not_a_direction(field))),
    }
}

/// The word of an axis: its letter, one of those of the machine.
pub(crate) fn axis(line: u32, field: &str, axes: &[char]) -> Result<char, FileFault> {
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
