//! Defines the subjects of topics and how they are written.

use core::cmp::Ordering;
use core::fmt;

use gsk_core::alarm::{self, AlarmClass, groups};
use gsk_core::memory;

/// Names of the two families of parameters.
const EVERY_STATE_PARAMETER: &str = "every state parameter";
const EVERY_DATA_PARAMETER: &str = "every data parameter";

/// The item that a help topic explains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject<'a> {
    /// An alarm, by its number. A range of alarms has its first number.
    Alarm(u16),
    /// A whole parameter, by its number.
    Parameter(u16),
    /// A bit of a state parameter, by parameter number and bit (0 to 7).
    Bit(u16, u8),
    /// A word of programs as it is written: a G or M code, an operation of G65, a statement or
    /// function of macros (`G71`, `M30`, `G65 H01`, `ATAN`), or one of the words S, T and F.
    Code(&'a str),
    /// A panel key, by its name in scripts.
    Key(&'a str),
    /// A lamp of the status strip, by its name in scripts.
    Lamp(&'a str),
    /// An LCD page, by its name in scripts.
    Page(&'a str),
    /// A field of an LCD page: name of the page (`*` for any page) and label on its screen. A
    /// label that differs by language is Chinese, `|` and English: `编程速率|PRG.FEED`.
    Field(&'a str, &'a str),
    /// A PLC signal, by its address: `X0.5`.
    Signal(&'a str),
    /// An item of the diagnosis page, by its number.
    Diagnosis(u16),
    /// Any other subject, by its name: `dry run`, `mode AUTO`, `address X`.
    Notion(&'a str),
}

impl<'a> Subject<'a> {
    /// Parses a subject of the panel as the help table writes it: `key RESET`, `page pos-abs`.
    /// Returns `None` if invalid.
    pub(crate) fn parse_panel(written: &'a str) -> Option<Self> {
        let (family, rest) = written.split_once(' ').unwrap_or((written, ""));
        Some(match family {
            "key" => Self::Key(rest),
            "lamp" => Self::Lamp(rest),
            "page" => Self::Page(rest),
            "field" => {
                let (page, label) = rest.split_once(' ')?;
                Self::Field(page, label)
            }
            "DGN" => Self::Diagnosis(rest.parse().ok()?),
            _ => Self::Notion(written),
        })
    }

    /// Parses a code or a word of programs. A capital letter or `#` begins a code, anything
    /// else a notion.
    pub(crate) fn parse_program_word(written: &'a str) -> Self {
        match written.starts_with(|it: char| it.is_ascii_uppercase() || it == '#') {
            true => Self::Code(written),
            false => Self::Notion(written),
        }
    }

    /// Returns the name of the family whose subjects are handled alike, for example `every
    /// signal`; `None` if the subject is in no family. What is shown about a family is shown
    /// about each of its subjects.
    pub fn family(&self) -> Option<&'static str> {
        match *self {
            Self::Parameter(number) => {
                let row = memory::parameter_rows()
                    .iter()
                    .find(|row| row.number == number)?;
                Some(match row.bit.is_some() || row.state {
                    true => EVERY_STATE_PARAMETER,
                    false => EVERY_DATA_PARAMETER,
                })
            }
            Self::Bit(..) => Some(EVERY_STATE_PARAMETER),
            Self::Diagnosis(_) => Some("every diagnosis"),
            Self::Signal(_) => Some("every signal"),
            Self::Alarm(number) => {
                let row = alarm::row(number)?;
                let by_reset = row.class == AlarmClass::Ps && !groups::survives_reset(number);
                by_reset.then_some("every alarm of a program")
            }
            _ => None,
        }
    }

    /// Returns what the order of subjects compares, in this sequence: kind, number, bit, texts.
    const fn order(&self) -> (u8, u16, u8, [&'a str; 2]) {
        match *self {
            Self::Alarm(number) => (0, number, 0, ["", ""]),
            Self::Parameter(number) => (1, number, 0, ["", ""]),
            Self::Bit(number, bit) => (2, number, bit, ["", ""]),
            Self::Code(name) => (3, 0, 0, [name, ""]),
            Self::Key(id) => (4, 0, 0, [id, ""]),
            Self::Lamp(id) => (5, 0, 0, [id, ""]),
            Self::Page(id) => (6, 0, 0, [id, ""]),
            Self::Field(page, label) => (7, 0, 0, [page, label]),
            Self::Signal(address) => (8, 0, 0, [address, ""]),
            Self::Diagnosis(number) => (9, number, 0, ["", ""]),
            Self::Notion(name) => (10, 0, 0, [name, ""]),
        }
    }

    /// Returns the number of an alarm, a whole parameter or a diagnosis item; `None` for other
    /// subjects.
    pub const fn number(&self) -> Option<u16> {
        match *self {
            Self::Alarm(number) | Self::Parameter(number) | Self::Diagnosis(number) => Some(number),
            _ => None,
        }
    }
}

/// By kind and then by number, also of a number within a text: `DT2` before `DT10`.
impl Ord for Subject<'_> {
    fn cmp(&self, other: &Self) -> Ordering {
        let (kind, number, bit, [first, second]) = self.order();
        let (other_kind, other_number, other_bit, other_texts) = other.order();
        (kind, number, bit)
            .cmp(&(other_kind, other_number, other_bit))
            .then_with(|| compare_by_value(first, other_texts[0]))
            .then_with(|| compare_by_value(second, other_texts[1]))
    }
}

impl PartialOrd for Subject<'_> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Compares texts, the numbers in them by their value. Only equal texts are equal.
fn compare_by_value(left: &str, right: &str) -> Ordering {
    (split_numbers(left).cmp(split_numbers(right))).then_with(|| left.cmp(right))
}

/// Splits a text into pieces that end with a number: `X0.5` into `X`, 0 and `.`, 5. A piece
/// without a number has 0.
fn split_numbers(text: &str) -> impl Iterator<Item = (&str, u64)> {
    let mut rest = text;
    core::iter::from_fn(move || {
        let begin = rest.find(|it: char| it.is_ascii_digit());
        let (letters, numbered) = rest.split_at(begin.unwrap_or(rest.len()));
        let end = numbered.find(|it: char| !it.is_ascii_digit());
        let (digits, after) = numbered.split_at(end.unwrap_or(numbered.len()));
        let is_end = rest.is_empty();
        rest = after;
        (!is_end).then(|| (letters, digits.parse().unwrap_or_default()))
    })
}

/// Writes the subject as a search query: `alarm 031`, `No. 004.3`, `G71`, `key RESET`, `page
/// pos-abs`.
impl fmt::Display for Subject<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Alarm(number) => write!(f, "alarm {number:03}"),
            Self::Parameter(number) => write!(f, "No. {number:03}"),
            Self::Bit(number, bit) => write!(f, "No. {number:03}.{bit}"),
            Self::Key(id) => write!(f, "key {id}"),
            Self::Lamp(id) => write!(f, "lamp {id}"),
            Self::Page(id) => write!(f, "page {id}"),
            Self::Field("*", label) => write!(f, "field {}", label.replace('|', " ")),
            Self::Field(page, label) => write!(f, "field {page} {}", label.replace('|', " ")),
            Self::Diagnosis(number) => write!(f, "DGN {number:03}"),
            Self::Code(name) | Self::Signal(name) | Self::Notion(name) => f.write_str(name),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subjects_are_in_the_order_of_their_numbers() {
        let mut names = ["DT10", "X1.0", "DT2", "X0.5", "DT", "X0.10", "DT02"].map(Subject::Signal);
        names.sort();
        let expected = ["DT", "DT02", "DT2", "DT10", "X0.5", "X0.10", "X1.0"];
        assert_eq!(names, expected.map(Subject::Signal));
    }
}
