//! Splits a line of a program into words, for highlighting, hover and edits. It accepts what
//! the control accepts and marks the rest. Only the control reports errors.

use std::borrow::Cow;
use std::ops::Range;

/// The kind of a span of a line, such as a word or a comment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpanKind {
    /// The span is an N or O word, which names a block or a program.
    Name,
    /// The span is a G word.
    Code,
    /// The span is an M word.
    Function,
    /// The span is an S, T or F word.
    Setting,
    /// The span is an X, Z, U or W word.
    Axis,
    /// The span is a word with any other letter.
    Other,
    /// The span is a statement of macro B, up to the end of its block.
    Statement,
    /// The span is a comment with its parentheses.
    Comment,
    /// The span is the end of a block, a block skip or a program mark.
    Mark,
    /// The span is a character that belongs to no word.
    Foreign,
}

impl SpanKind {
    /// Returns whether the span is a word: a letter with its number.
    pub const fn is_word(self) -> bool {
        !matches!(
            self,
            Self::Statement | Self::Comment | Self::Mark | Self::Foreign
        )
    }
}

/// A range of a line, such as a word or comment, with its kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Span {
    /// Range of the span's bytes in the line, from 0.
    pub range: Range<usize>,
    /// The kind of the span, such as a word or comment.
    pub kind: SpanKind,
}

/// A word of a program: its address and the text of its number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParsedWord<'a> {
    /// The letter of the word in upper case.
    pub address: char,
    /// Number of the word: sign, digits and point in ASCII without blanks. A variable begins
    /// with `#`, a formula with `[`.
    pub value: Cow<'a, str>,
}

impl ParsedWord<'_> {
    /// Returns the number of the word if it is an integer without a sign; otherwise `None`.
    pub fn number(&self) -> Option<u32> {
        let digits = self.value.bytes().all(|byte| byte.is_ascii_digit());
        digits.then(|| self.value.parse().ok())?
    }
}

/// The first words of the statements of macro B.
const STATEMENTS: [&str; 5] = ["IF", "GOTO", "WHILE", "DO", "END"];

/// Splits a line into its spans, in their order, without the blanks between them.
pub fn spans(line: &str) -> Vec<Span> {
    let mut spans = Vec::new();
    let mut at = 0;
    let mut begins_block = true;
    while let Some(character) = line[at..].chars().next() {
        let end = at + character.len_utf8();
        let letter = to_half_width(character);
        if is_blank(character) {
            at = end;
            continue;
        }
        let (end, kind) = match letter {
            '(' => (comment_end(line, at), SpanKind::Comment),
            _ if begins_block && begins_statement(&line[at..]) => {
                (statement_end(line, at), SpanKind::Statement)
            }
            ';' | '*' | '/' | '%' => (end, SpanKind::Mark),
            'a'..='z' | 'A'..='Z' => word(line, end, letter),
            _ => (end, SpanKind::Foreign),
        };
        begins_block = match kind {
            SpanKind::Mark | SpanKind::Name => true,
            SpanKind::Comment => begins_block,
            _ => false,
        };
        spans.push(Span {
            range: at..end,
            kind,
        });
        at = end;
    }
    spans
}

/// Returns the spans of the block that contains the byte `byte` of its line.
pub(crate) fn block_at(spans: &[Span], line: &str, byte: usize) -> Vec<Span> {
    let ends = |it: &Span| {
        it.kind == SpanKind::Mark && matches!(line.get(it.range.clone()), Some(";" | "*" | "%"))
    };
    let mut blocks = spans.split_inclusive(ends);
    let around = blocks.find(|block| block.last().is_some_and(|it| byte <= it.range.start));
    let last = || spans.rsplit(ends).next().unwrap_or(&[]);
    around.unwrap_or_else(last).to_vec()
}

/// Returns the word in a span; `None` if the span is not a word.
pub fn word_of<'a>(line: &'a str, span: &Span) -> Option<ParsedWord<'a>> {
    let text = line.get(span.range.clone())?;
    let first = text.chars().next()?;
    let address = to_half_width(first).to_ascii_uppercase();
    let value = ascii_value(text.get(first.len_utf8()..)?.trim_matches(is_blank));
    (address.is_ascii_uppercase() && !value.is_empty()).then_some(ParsedWord { address, value })
}

/// Returns the words of a line in their order.
pub fn words(line: &str) -> impl Iterator<Item = ParsedWord<'_>> {
    let spans = spans(line).into_iter();
    spans
        .filter(|span| span.kind.is_word())
        .filter_map(|span| word_of(line, &span))
}

/// Whether a character is blank: the control skips it between words.
const fn is_blank(character: char) -> bool {
    matches!(character, ' ' | '\t' | '\u{3000}' | '\u{A0}' | '\u{FEFF}')
}

/// Converts a full-width character to ASCII, as the control reads it.
pub(crate) fn to_half_width(character: char) -> char {
    match u32::from(character) {
        wide @ 0xFF01..=0xFF5E => char::from_u32(wide - 0xFEE0).unwrap_or(character),
        0x3000 => ' ',
        _ => character,
    }
}

/// Returns the text of a number in ASCII, without blanks.
fn ascii_value(value: &str) -> Cow<'_, str> {
    let is_plain = |byte: u8| byte.is_ascii_graphic();
    if value.bytes().all(is_plain) {
        return Cow::Borrowed(value);
    }
    let narrowed = value.chars().map(to_half_width);
    Cow::Owned(narrowed.filter(|it| !is_blank(*it)).collect())
}

/// The byte after the comment that starts at byte `at`. A full-width opening parenthesis
/// accepts either closing parenthesis.
fn comment_end(line: &str, at: usize) -> usize {
    let wide = line[at..].starts_with('（');
    let close = line[at..].find(|it| it == ')' || wide && it == '）');
    close.map_or(line.len(), |close| {
        let length = line[at + close..].chars().next().map_or(1, char::len_utf8);
        at + close + length
    })
}

/// Whether `rest` begins with a statement of macro B.
fn begins_statement(rest: &str) -> bool {
    if rest.starts_with('#') {
        return true;
    }
    let letters = rest.bytes().take_while(u8::is_ascii_alphabetic).count();
    let word = &rest[..letters];
    STATEMENTS.iter().any(|it| word.eq_ignore_ascii_case(it))
}

/// The byte after the statement at byte `at`: the end of its block or the start of a comment.
fn statement_end(line: &str, at: usize) -> usize {
    let rest = &line[at..];
    let end = rest
        .find(|it| matches!(to_half_width(it), ';' | '%' | '('))
        .unwrap_or(rest.len());
    at + rest[..end].trim_end_matches(is_blank).len()
}

/// The byte after a word whose letter ends at byte `from`, and the kind of the word.
fn word(line: &str, from: usize, letter: char) -> (usize, SpanKind) {
    let rest = &line[from..];
    let blanks = rest.len() - rest.trim_start_matches(is_blank).len();
    let number = &rest[blanks..];
    let is_number = |it: char| matches!(to_half_width(it), '0'..='9' | '+' | '-' | '.' | '#');
    let plain = number.find(|it| !is_number(it)).unwrap_or(number.len());
    let length = match number[plain..].starts_with('[') {
        true => plain + formula_length(&number[plain..]),
        false => plain,
    };
    if length == 0 {
        return (from, SpanKind::Foreign);
    }
    let kind = match letter.to_ascii_uppercase() {
        'N' | 'O' => SpanKind::Name,
        'G' => SpanKind::Code,
        'M' => SpanKind::Function,
        'S' | 'T' | 'F' => SpanKind::Setting,
        'X' | 'Z' | 'U' | 'W' => SpanKind::Axis,
        _ => SpanKind::Other,
    };
    (from + blanks + length, kind)
}

/// Length in bytes of the formula that starts with a bracket. An unclosed formula reaches to
/// the end of the line.
fn formula_length(text: &str) -> usize {
    let mut depth = 0_u32;
    for (at, byte) in text.bytes().enumerate() {
        match byte {
            b'[' => depth += 1,
            b']' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return at + 1;
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(line: &str) -> Vec<(&str, SpanKind)> {
        spans(line)
            .into_iter()
            .map(|span| (&line[span.range], span.kind))
            .collect()
    }

    #[test]
    fn a_block_falls_into_its_words() {
        let line = "/N10 g1X-20.5 Z #201(到 20);车";
        assert_eq!(
            found(line),
            [
                ("/", SpanKind::Mark),
                ("N10", SpanKind::Name),
                ("g1", SpanKind::Code),
                ("X-20.5", SpanKind::Axis),
                ("Z #201", SpanKind::Axis),
                ("(到 20)", SpanKind::Comment),
                (";", SpanKind::Mark),
                ("车", SpanKind::Foreign),
            ]
        );
        let words: Vec<ParsedWord<'_>> = words(line).collect();
        let second = ParsedWord {
            address: 'G',
            value: "1".into(),
        };
        assert_eq!(words[1], second);
        assert_eq!(words[3].value, "#201");
        assert_eq!(words.len(), 4);
    }

    #[test]
    fn a_statement_of_macro_b_is_one_span() {
        assert_eq!(
            found("N10 IF [#1 GT 5] GOTO 20 (on);G1 X[#1/2]Z-#2"),
            [
                ("N10", SpanKind::Name),
                ("IF [#1 GT 5] GOTO 20", SpanKind::Statement),
                ("(on)", SpanKind::Comment),
                (";", SpanKind::Mark),
                ("G1", SpanKind::Code),
                ("X[#1/2]", SpanKind::Axis),
                ("Z-#2", SpanKind::Axis),
            ]
        );
        assert_eq!(found("#1=#2*3"), [("#1=#2*3", SpanKind::Statement)]);
        assert_eq!(found("end 1"), [("end 1", SpanKind::Statement)]);
    }

    #[test]
    fn full_width_words_are_words() {
        let line = "Ｇ０１　Ｘ５（中)";
        let words: Vec<ParsedWord<'_>> = words(line).collect();
        assert_eq!((words[0].address, words[0].number()), ('G', Some(1)));
        assert_eq!((words[1].address, &*words[1].value), ('X', "5"));
        assert_eq!(spans(line)[2].kind, SpanKind::Comment);
    }

    #[test]
    fn invalid_characters_are_separate_spans() {
        for line in [
            "",
            "   ",
            "G",
            "(offen",
            "X--1",
            "%",
            "（中）",
            "G 0 1",
            "X[",
            "X][",
        ] {
            let spans = spans(line);
            let covered = spans
                .windows(2)
                .all(|two| two[0].range.end <= two[1].range.start);
            assert!(covered, "{line}");
        }
    }
}
