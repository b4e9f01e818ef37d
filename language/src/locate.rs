//! Locates the cause of an alarm in a text: its line and the characters that raise it.

use std::ops::Range;

use gsk_core::alarm::{Alarm, number};

use crate::words::{Span, spans, word_of};

/// The message of an alarm that a cycle raises in a block of its profile.
const IN_PROFILE: &str = "in_profile";

/// A range of bytes in a line of a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LineSpan {
    /// Line of the program, from 1.
    pub line: u32,
    /// Range of the bytes in the line, from 0.
    pub bytes: Range<usize>,
}

/// Returns where the cause of an alarm is: the word at its column if the alarm has one, else
/// its block without surrounding blanks. An error in a cycle's profile is located in the
/// profile. `line_of` returns a line (from 1) of the alarm's program. `None` for an alarm
/// without a source line.
pub fn locate_alarm<'a>(alarm: &Alarm, line_of: impl Fn(u32) -> &'a str) -> Option<LineSpan> {
    let source = alarm.source?;
    let detail = alarm.detail.as_ref();
    let profile = detail.filter(|detail| detail.id().name() == IN_PROFILE);
    let profile = profile.and_then(|detail| detail.plain_value("line")?.parse().ok());
    let line = profile.unwrap_or(source.line);
    let column = detail.and_then(|detail| detail.find_value("column"));
    let column = column.and_then(|column| column.parse().ok());
    let text = line_of(line);
    let code = match column {
        Some(_) => None,
        None => foreign_code_bytes(alarm, text),
    };
    Some(LineSpan {
        line,
        bytes: code.unwrap_or_else(|| bytes_at_column(text, column)),
    })
}

/// Returns the bytes of the G or M code that an alarm is about; `None` for other alarms.
fn foreign_code_bytes(alarm: &Alarm, line: &str) -> Option<Range<usize>> {
    let address = match alarm.number {
        number::BAD_G => 'G',
        number::BAD_M => 'M',
        _ => return None,
    };
    let code: u32 = alarm.detail.as_ref()?.find_value("code")?.parse().ok()?;
    let is_code = |span: &&Span| {
        let word = word_of(line, span).filter(|word| word.address == address);
        word.and_then(|word| word.number()) == Some(code)
    };
    let all_spans = spans(line);
    let span = all_spans.iter().find(is_code)?;
    Some(span.range.clone())
}

/// Returns the bytes of the word at a column (characters from 1), or of the whole line without
/// surrounding blanks.
pub(crate) fn bytes_at_column(line: &str, column: Option<usize>) -> Range<usize> {
    let all_spans = spans(line);
    let Some(column) = column else {
        return trimmed_range(line);
    };
    let mut characters = line.char_indices().skip(column.saturating_sub(1));
    let Some((at, character)) = characters.next() else {
        // Something missing at the end of a line is shown at its last span.
        let last = all_spans.last();
        return last.map_or(0..line.len(), |span| span.range.clone());
    };
    let word = spans(line)
        .into_iter()
        .find(|span| span.range.contains(&at));
    word.map_or(at..at + character.len_utf8(), |span| span.range)
}

/// Returns the bytes of a line without surrounding blanks.
pub(crate) fn trimmed_range(line: &str) -> Range<usize> {
    let from = line.len() - line.trim_start().len();
    let to = line.trim_end().len();
    from.min(to)..to
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_word_at_a_column_or_the_line() {
        assert_eq!(bytes_at_column("G00 X20 ?", Some(9)), 8..9);
        assert_eq!(bytes_at_column("(车) G00 X20.", Some(10)), 10..14);
        assert_eq!(bytes_at_column("  G00 X20  ", None), 2..9);
        assert_eq!(bytes_at_column("G00 X", Some(40)), 4..5);
        assert_eq!(bytes_at_column("", Some(3)), 0..0);
        assert_eq!(bytes_at_column("   ", None), 0..0);
        assert_eq!(bytes_at_column("G00 X1; G1 ?", Some(12)), 11..12);
    }
}
