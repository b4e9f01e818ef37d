//! Names of programs in their texts: O words and `%P01`.

use gsk_messages::say;

use super::Program;
use crate::alarm::number;
use crate::program::block_head::BlockHead;
use crate::program::syntax::{BlockError, Syntax};

impl Program {
    /// A copy of the program with another number: replaces the O word, or inserts it at the
    /// beginning.
    #[must_use]
    pub fn renumbered(&self, number: u16) -> Self {
        let shared = &self.shared;
        let name = (0..shared.blocks.len().min(NAME_SEARCH_BLOCKS)).find_map(|index| {
            let (start, end) = BlockHead::read(shared.block(index)).o_span?;
            let byte = shared.blocks.get(index)?.byte as usize;
            Some((byte + start, byte + end))
        });
        let text = &shared.text;
        let percent = percent_name(text).filter(|_| name.is_none());
        if let Some((_, (start, end))) = percent {
            let (before, after) = (text.get(..start), text.get(end..));
            let (before, after) = (before.unwrap_or(""), after.unwrap_or(""));
            return Self::new(format!("{before}{number:02}{after}"));
        }
        let text = match name {
            Some((start, end)) => format!(
                "{}O{number:04}{}",
                text.get(..start).unwrap_or(""),
                text.get(end..).unwrap_or("")
            ),
            None => {
                let first = shared.blocks.get(0).map_or(0, |place| place.byte as usize);
                let (before, after) = text.split_at_checked(first).unwrap_or(("", text));
                format!("{before}O{number:04};\n{after}")
            }
        };
        Self::new(text)
    }

    /// Checks the number of `%P01` on models that name programs so: alarm 043 if it is out
    /// of range.
    #[cold]
    pub(super) fn check_percent_name(&self, syntax: Syntax) -> Result<(), BlockError> {
        let record = syntax.model.record();
        let Some((number, (start, _))) = percent_name(&self.shared.text) else {
            return Ok(());
        };
        let last = record.last_program;
        if !record.program_name.starts_with('%') || (1..=last).contains(&number) {
            return Ok(());
        }
        let rule = say::program_name_out_of_range(number, last);
        Err(BlockError::at(number::OUT_OF_RANGE, start, rule))
    }
}

/// The number of `%P01` at the start of a text (Huaxing), and the byte range of its digits;
/// `None` if the text begins otherwise.
pub(super) fn percent_name(text: &str) -> Option<(u16, (usize, usize))> {
    let line = text.lines().next()?;
    let after = line.trim_start().strip_prefix('%')?.trim_start();
    let digits = after.strip_prefix(['P', 'p'])?;
    let count = digits.bytes().take_while(u8::is_ascii_digit).count();
    let number = digits
        .get(..count)
        .filter(|it| (1..=4).contains(&it.len()))?;
    let start = line.len() - digits.len();
    Some((number.parse().ok()?, (start, start + count)))
}

/// Number of blocks, from the first one, that are searched for the O word of a program.
pub(super) const NAME_SEARCH_BLOCKS: usize = 16;

/// Splits the text of a file into programs, each of which begins with an O word. Lines keep
/// their numbers in the file. A `String` with a single program is not copied.
pub fn split_programs(text: impl Into<String>) -> Vec<Program> {
    let whole = Program::new(text);
    let starts = &whole.shared.names;
    if starts.len() < 2 {
        return vec![whole];
    }
    let text = whole.text();
    let end = whole.shared.blocks.end() as usize;
    let mut programs = Vec::with_capacity(starts.len());
    for (index, place) in starts.iter().enumerate() {
        // The text before the first O word belongs to the first program.
        let (byte, line) = if index == 0 {
            (0, 1)
        } else {
            (place.byte as usize, place.line)
        };
        let next = starts.get(index + 1).map_or(end, |next| next.byte as usize);
        let part = text.get(byte..next).unwrap_or("");
        programs.push(Program::from_line(part.to_owned(), line));
    }
    programs
}
