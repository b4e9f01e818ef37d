//! Stores the text of a document with its lines, positions and ranges.

use std::ops::Range;

/// A position in a text between two characters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Position {
    /// Index of the line, from 0.
    pub line: u32,
    /// Byte in the line before which the position is, from 0.
    pub byte: u32,
}

/// A range of bytes in one line.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TextRange {
    /// Index of the line that contains the range, from 0.
    pub line: u32,
    /// First byte of the range in its line, from 0.
    pub from: u32,
    /// The byte in the line after the last one of the range.
    pub to: u32,
}

impl TextRange {
    /// Creates the range of `bytes` in `line`, both from 0.
    pub fn new(line: u32, bytes: &Range<usize>) -> Self {
        Self {
            line,
            from: to_u32(bytes.start),
            to: to_u32(bytes.end),
        }
    }

    /// Returns whether a position is inside the range or at its end, where a cursor touches
    /// it.
    pub const fn touches(&self, at: Position) -> bool {
        self.line == at.line && self.from <= at.byte && at.byte <= self.to
    }

    /// Returns the position of the first byte and the position after the last byte.
    pub fn start_and_end(&self) -> (Position, Position) {
        let at = |byte| Position {
            line: self.line,
            byte,
        };
        (at(self.from), at(self.to))
    }
}

/// A change of a text: replaces the text between two positions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextChange {
    /// Start of the text to replace.
    pub from: Position,
    /// End of the text to replace.
    pub to: Position,
    /// The text that is inserted instead.
    pub text: String,
}

impl TextChange {
    /// Creates a change that replaces a range of a line with `text`.
    pub fn replace(range: &TextRange, text: impl Into<String>) -> Self {
        let (from, to) = range.start_and_end();
        Self {
            from,
            to,
            text: text.into(),
        }
    }
}

/// A text and the starts of its lines. A line ends at LF, CR LF or CR, as for the control and
/// for editors.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextDocument {
    text: String,
    /// Offset of the first byte of each line in the text. The first entry is 0.
    starts: Vec<u32>,
}

/// Length at which a longer text is cut, bytes. Program files end at 256 MB.
const MAX_BYTES: usize = u32::MAX as usize - 16;

impl TextDocument {
    /// Stores a text and finds its lines. A text over 4 GB is cut.
    pub fn new(text: impl Into<String>) -> Self {
        let mut text = text.into();
        if text.len() > MAX_BYTES {
            text.truncate(text.floor_char_boundary(MAX_BYTES));
        }
        let mut starts = vec![0];
        let bytes = text.as_bytes();
        let ends = bytes.iter().enumerate();
        let ends = ends.filter(|(_, byte)| matches!(byte, b'\n' | b'\r'));
        let after = ends.map(|(at, _)| at + 1);
        starts.extend(after.filter(|at| begins_line(bytes, *at)).map(to_u32));
        Self { text, starts }
    }

    /// Returns the whole text.
    pub fn as_str(&self) -> &str {
        &self.text
    }

    /// Returns the number of lines, including the one after the last line end.
    pub fn line_count(&self) -> u32 {
        to_u32(self.starts.len())
    }

    /// Returns the line with index `line` (from 0) without its line end; empty beyond the last
    /// line.
    pub fn line(&self, line: u32) -> &str {
        let start = self.start(line);
        let text = self.text.get(start..self.start(line.saturating_add(1)));
        text.unwrap_or("").trim_end_matches(['\n', '\r'])
    }

    /// Returns all lines with their numbers, from 0.
    pub fn lines(&self) -> impl Iterator<Item = (u32, &str)> {
        (0..self.line_count()).map(|line| (line, self.line(line)))
    }

    /// Returns the byte offset of a position in the text. An invalid position gives the
    /// nearest offset before it.
    pub fn offset(&self, at: Position) -> usize {
        let (start, line) = (self.start(at.line), self.line(at.line));
        let offset = (at.byte as usize).min(line.len());
        start + line.floor_char_boundary(offset)
    }

    /// Applies a change to the text. If `to` is before `from`, the change only inserts.
    pub fn apply(&mut self, edit: &TextChange) {
        let from = self.offset(edit.from);
        let to = self.offset(edit.to).max(from);
        if self.text.len() - (to - from) + edit.text.len() > MAX_BYTES {
            return;
        }
        self.text.replace_range(from..to, &edit.text);
        // A byte and the one before it determine whether a line begins there.
        let after = from + edit.text.len();
        let tail = self.starts.partition_point(|start| *start as usize <= to);
        let tail = self.starts.split_off(tail);
        let head = self
            .starts
            .partition_point(|start| (*start as usize) < from);
        self.starts.truncate(head.max(1));
        let bytes = self.text.as_bytes();
        let begin = |at: &usize| begins_line(bytes, *at);
        let new = (from.max(1)..=after).filter(begin).map(to_u32);
        self.starts.extend(new);
        let moved = tail.into_iter().map(|start| start as usize - to + after);
        self.starts.extend(moved.map(to_u32));
    }

    /// Applies changes that do not overlap; they may be in any order.
    pub fn apply_all(&mut self, edits: &[TextChange]) {
        let mut order: Vec<&TextChange> = edits.iter().collect();
        order.sort_by_key(|edit| edit.from);
        for edit in order.into_iter().rev() {
            self.apply(edit);
        }
    }

    fn start(&self, line: u32) -> usize {
        let start = self.starts.get(line as usize);
        start.map_or(self.text.len(), |start| *start as usize)
    }
}

/// Whether a line begins at byte `at`; false for the first line.
fn begins_line(bytes: &[u8], at: usize) -> bool {
    match bytes.get(at - 1) {
        Some(b'\n') => true,
        Some(b'\r') => bytes.get(at) != Some(&b'\n'),
        _ => false,
    }
}

pub(crate) fn to_u32(at: usize) -> u32 {
    u32::try_from(at).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn lines_end_as_the_control_ends_them() {
        let text = TextDocument::new("O1\r\nN10\rN20\n\n车");
        let lines: Vec<&str> = text.lines().map(|(_, line)| line).collect();
        assert_eq!(lines, ["O1", "N10", "N20", "", "车"]);
        assert_eq!(text.offset(Position { line: 4, byte: 1 }), 13);
        assert_eq!(text.offset(Position { line: 9, byte: 9 }), 16);
        assert_eq!(text.line(7), "");
    }

    fn fragment() -> impl Strategy<Value = String> {
        proptest::collection::vec(
            prop_oneof![
                Just("\r"),
                Just("\n"),
                Just("\r\n"),
                Just("G1"),
                Just("车"),
                Just("")
            ],
            0..5,
        )
        .prop_map(|fragments| fragments.concat())
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn a_changed_text_is_the_text_read_anew(
            begin in fragment(),
            changes in proptest::collection::vec((0..6_u32, 0..6_u32, 0..6_u32, 0..6_u32, fragment()), 1..6),
        ) {
            let mut text = TextDocument::new(begin);
            for (line, byte, to_line, to_byte, with) in changes {
                let from = Position { line, byte };
                let to = Position { line: to_line, byte: to_byte };
                text.apply(&TextChange { from, to, text: with });
                prop_assert_eq!(&text, &TextDocument::new(text.as_str()));
            }
        }
    }
}
