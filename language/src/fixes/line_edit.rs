//! Edits of one line: deletes, replaces and inserts words.

use crate::text::{Position, TextChange, TextRange};
use crate::words::{ParsedWord, Span, SpanKind, spans, word_of};

/// A line of a program that a fix changes.
#[derive(Clone, Debug)]
pub(super) struct EditedLine<'a> {
    /// Index of the line, from 0.
    line: u32,
    text: &'a str,
    spans: Vec<Span>,
}

impl<'a> EditedLine<'a> {
    /// Reads the line `number` (from 1) with its text.
    pub(super) fn new(number: u32, text: &'a str) -> Self {
        Self {
            line: number.saturating_sub(1),
            text,
            spans: spans(text),
        }
    }

    /// Returns the words of the line in their order, each with its span.
    pub(super) fn words(&self) -> impl DoubleEndedIterator<Item = (&Span, ParsedWord<'a>)> {
        let words = self.spans.iter().filter(|span| span.kind.is_word());
        words.filter_map(|span| Some((span, word_of(self.text, span)?)))
    }

    /// Returns the last word with the letter `address`; `None` without one.
    pub(super) fn word(&self, address: char) -> Option<(&Span, ParsedWord<'a>)> {
        self.words().rev().find(|(_, word)| word.address == address)
    }

    /// Returns the span that contains the character in `column` (from 1).
    pub(super) fn span_at_column(&self, column: u32) -> Option<&Span> {
        let skipped = (column as usize).saturating_sub(1);
        let (byte, _) = self.text.char_indices().nth(skipped)?;
        self.spans.iter().find(|span| span.range.contains(&byte))
    }

    /// Whether the line has one block: no other block follows its end.
    pub(super) fn is_one_block(&self) -> bool {
        let is_end = |span: &&Span| {
            span.kind == SpanKind::Mark && matches!(self.text.get(span.range.clone()), Some(";"))
        };
        let last = self.spans.last().map(|span| span.range.start);
        let mut ends = self.spans.iter().filter(is_end);
        ends.all(|end| Some(end.range.start) == last)
    }

    /// Replaces a span by `text`.
    pub(super) fn replace(&self, span: &Span, text: impl Into<String>) -> TextChange {
        TextChange::replace(&TextRange::new(self.line, &span.range), text)
    }

    /// Replaces the whole line by `text`.
    pub(super) fn replace_all(&self, text: impl Into<String>) -> TextChange {
        TextChange::replace(&TextRange::new(self.line, &(0..self.text.len())), text)
    }

    /// Deletes a span with the blanks beside it; the whole line if nothing else is in it.
    pub(super) fn delete(&self, span: &Span) -> TextChange {
        let (before, after) = self.text.split_at(span.range.start);
        let after = &after[span.range.len()..];
        if before.trim().is_empty() && matches!(after.trim(), "" | ";") {
            return self.delete_line();
        }
        let (from, to) = match after.len() - after.trim_start().len() {
            0 => (before.trim_end().len(), span.range.end),
            blanks if blanks == after.len() => (before.trim_end().len(), self.text.len()),
            blanks => (span.range.start, span.range.end + blanks),
        };
        TextChange::replace(&TextRange::new(self.line, &(from..to)), "")
    }

    fn delete_line(&self) -> TextChange {
        TextChange {
            from: self.start(),
            to: Position {
                line: self.line + 1,
                byte: 0,
            },
            text: String::new(),
        }
    }

    /// Inserts `word` before the first word of the block that is no name.
    pub(super) fn insert_word(&self, word: &str) -> TextChange {
        let first = self.spans.iter().find(|span| {
            !matches!(
                span.kind,
                SpanKind::Name | SpanKind::Mark | SpanKind::Comment
            )
        });
        let byte = first.map_or(self.text.len(), |span| span.range.start);
        TextChange::replace(
            &TextRange::new(self.line, &(byte..byte)),
            format!("{word} "),
        )
    }

    /// Inserts a line with the text `block` before this line.
    pub(super) fn insert_line_before(&self, block: &str) -> TextChange {
        TextChange {
            from: self.start(),
            to: self.start(),
            text: format!("{block}\n"),
        }
    }

    const fn start(&self) -> Position {
        Position {
            line: self.line,
            byte: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::TextDocument;

    fn edited(line: &str, change: impl Fn(&EditedLine<'_>) -> TextChange) -> String {
        let mut text = TextDocument::new(format!("(first)\n{line}\nM30\n"));
        text.apply(&change(&EditedLine::new(2, line)));
        text.as_str().replacen("(first)\n", "", 1)
    }

    #[test]
    fn a_deleted_word_leaves_single_blanks() {
        let delete = |line: &str, address: char| {
            edited(line, |it| {
                let (span, _) = it.word(address).expect("the word");
                it.delete(span)
            })
        };
        assert_eq!(delete("G01 X5 K2 F100", 'K'), "G01 X5 F100\nM30\n");
        assert_eq!(delete("G01 X5 K2 ;", 'K'), "G01 X5 ;\nM30\n");
        assert_eq!(delete("G01X5K2", 'K'), "G01X5\nM30\n");
        assert_eq!(delete("G01 X5  K2  ", 'K'), "G01 X5\nM30\n");
        assert_eq!(delete(" G21 ;", 'G'), "M30\n");
    }

    #[test]
    fn words_and_lines_are_inserted_before_a_block() {
        let word = |line: &str| edited(line, |it| it.insert_word("G99"));
        assert_eq!(word("/N10 G01 X5"), "/N10 G99 G01 X5\nM30\n");
        assert_eq!(word("X5"), "G99 X5\nM30\n");
        let line = edited("N10 X5", |it| it.insert_line_before("M03"));
        assert_eq!(line, "M03\nN10 X5\nM30\n");
    }

    #[test]
    fn a_block_after_another_one_is_found() {
        assert!(EditedLine::new(1, "G01 X5;").is_one_block());
        assert!(EditedLine::new(1, "G01 X5 (a;b)").is_one_block());
        assert!(!EditedLine::new(1, "G01 X5; X6").is_one_block());
    }
}
