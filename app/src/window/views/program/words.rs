//! A line of a program as its words, for colours and for what the pointer is on. It takes
//! what the control takes and marks the rest; the control alone says what is wrong.

use std::ops::Range;

/// What a piece of a line is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// N and O: where a block or a program begins.
    Name,
    /// G.
    Code,
    /// M.
    Function,
    /// S, T, F.
    Setting,
    /// X, Z, U, W.
    Axis,
    /// Any other letter with its number.
    Other,
    /// In parentheses.
    Comment,
    /// End of block, block skip, program mark.
    Mark,
    /// No word.
    Foreign,
}

/// A piece of a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Span {
    /// Bytes of the line.
    pub range: Range<usize>,
    /// What it is.
    pub kind: Kind,
}

/// The letter of a word and its number as it stands there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Word<'a> {
    /// Upper case.
    pub address: char,
    /// Sign, digits, point; a variable begins with `#`.
    pub value: &'a str,
}

/// The pieces of a line in order; blanks between them are none.
pub fn spans(line: &str) -> Vec<Span> {
    let mut spans = Vec::new();
    let mut at = 0;
    while let Some(letter) = line[at..].chars().next() {
        let end = at + letter.len_utf8();
        if letter.is_whitespace() {
            at = end;
            continue;
        }
        let (end, kind) = match letter {
            '(' => {
                let close = line[at..]
                    .find(')')
                    .map_or(line.len(), |close| at + close + 1);
                (close, Kind::Comment)
            }
            ';' | '/' | '%' => (end, Kind::Mark),
            'a'..='z' | 'A'..='Z' => word(line, end, letter),
            _ => (end, Kind::Foreign),
        };
        spans.push(Span {
            range: at..end,
            kind,
        });
        at = end;
    }
    spans
}

/// The word that a span is.
pub fn word_of<'a>(line: &'a str, span: &Span) -> Option<Word<'a>> {
    let text = line.get(span.range.clone())?;
    let address = text.chars().next()?.to_ascii_uppercase();
    let value = text.get(1..)?.trim();
    (address.is_ascii_uppercase() && !value.is_empty()).then_some(Word { address, value })
}

/// The words of a line.
pub fn words(line: &str) -> impl Iterator<Item = Word<'_>> {
    let spans = spans(line).into_iter();
    spans
        .filter(|span| !matches!(span.kind, Kind::Comment | Kind::Mark | Kind::Foreign))
        .filter_map(|span| word_of(line, &span))
}

/// Where a word ends whose letter ends at a byte, and what it is.
fn word(line: &str, from: usize, letter: char) -> (usize, Kind) {
    let rest = &line[from..];
    let blanks = rest.len() - rest.trim_start_matches(' ').len();
    let number = &rest[blanks..];
    let length = number
        .find(|letter: char| !(letter.is_ascii_digit() || matches!(letter, '+' | '-' | '.' | '#')))
        .unwrap_or(number.len());
    if length == 0 {
        return (from, Kind::Foreign);
    }
    let kind = match letter.to_ascii_uppercase() {
        'N' | 'O' => Kind::Name,
        'G' => Kind::Code,
        'M' => Kind::Function,
        'S' | 'T' | 'F' => Kind::Setting,
        'X' | 'Z' | 'U' | 'W' => Kind::Axis,
        _ => Kind::Other,
    };
    (from + blanks + length, kind)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_falls_into_its_words() {
        let line = "/N10 g1X-20.5 Z #201(到 20);车";
        let found: Vec<(&str, Kind)> = spans(line)
            .into_iter()
            .map(|span| (&line[span.range], span.kind))
            .collect();
        assert_eq!(
            found,
            [
                ("/", Kind::Mark),
                ("N10", Kind::Name),
                ("g1", Kind::Code),
                ("X-20.5", Kind::Axis),
                ("Z #201", Kind::Axis),
                ("(到 20)", Kind::Comment),
                (";", Kind::Mark),
                ("车", Kind::Foreign),
            ]
        );
        let words: Vec<Word<'_>> = words(line).collect();
        let second = Word {
            address: 'G',
            value: "1",
        };
        assert_eq!(words[1], second);
        assert_eq!(words.len(), 4);
    }

    #[test]
    fn what_is_no_word_stays_in_one_piece_each() {
        for line in ["", "   ", "G", "(offen", "X--1", "%", "（中）", "G 0 1"] {
            let spans = spans(line);
            let covered = spans
                .windows(2)
                .all(|two| two[0].range.end <= two[1].range.start);
            assert!(covered, "{line}");
        }
    }
}
