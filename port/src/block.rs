//! Splits a line into words, comments and blanks, and writes it again after its words were
//! changed. All that is not changed keeps its text.

use crate::number::Number;

/// A word of a foreign program: a letter with a number, or with a variable or formula in its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ForeignWord {
    /// Upper-case letter of the address.
    pub letter: u8,
    /// Whether a comma precedes the letter, as in `,C2.`.
    pub has_comma: bool,
    /// Value of the number after the letter; `None` if a variable or formula stands in its place.
    pub number: Option<Number>,
    /// The word as written, with the comma and the blanks inside it.
    pub written: String,
}

impl ForeignWord {
    /// Returns the word as messages show it: in upper case and without blanks.
    pub fn shown(&self) -> String {
        let upper = self.written.to_ascii_uppercase();
        upper.split_whitespace().collect()
    }
}

/// A piece of a foreign block: a word, a text that stays unchanged, or a formula.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum LinePiece {
    /// A letter with a number or variable, such as `X12.5`.
    Word(ForeignWord),
    /// Text that stays unchanged: blanks, comments, a skip mark, `%`.
    Text(String),
    /// Text that no rule reads: formulas and keywords of macros.
    Formula(String),
}

impl LinePiece {
    /// Returns the piece as it is in the text.
    pub fn written(&self) -> &str {
        match self {
            Self::Word(word) => &word.written,
            Self::Text(text) | Self::Formula(text) => text,
        }
    }
}

/// A foreign block, split into pieces, with the lines that the porter adds around it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct ForeignBlock {
    /// Line of the block in the foreign text, from 1.
    pub line: u32,
    /// The words, texts and formulas of the block, in the order of the text.
    pub pieces: Vec<LinePiece>,
    /// Lines that the porter writes before the block.
    pub before: Vec<String>,
    /// Lines that the porter writes after the block.
    pub after: Vec<String>,
}

impl ForeignBlock {
    /// Returns the words of the block, in the order of the text.
    pub fn words(&self) -> impl Iterator<Item = &ForeignWord> {
        self.pieces.iter().filter_map(|piece| match piece {
            LinePiece::Word(word) => Some(word),
            LinePiece::Text(_) | LinePiece::Formula(_) => None,
        })
    }

    /// Returns the first word with this letter and no comma; `None` if the block has none.
    pub fn word(&self, letter: u8) -> Option<&ForeignWord> {
        self.words()
            .find(|word| word.letter == letter && !word.has_comma)
    }

    /// Returns the number of the first word with this letter; `None` if the block has no such word,
    /// or a variable stands for the number.
    pub fn number(&self, letter: u8) -> Option<Number> {
        self.word(letter)?.number
    }

    /// Whether the block has a word with this letter.
    pub fn has(&self, letter: u8) -> bool {
        self.word(letter).is_some()
    }

    /// Whether the block has a word with one of these letters.
    pub fn has_any(&self, letters: &[u8]) -> bool {
        letters.iter().any(|letter| self.has(*letter))
    }

    /// Whether the block has this G code; `code` in tenths, G92 is 920.
    pub fn has_g(&self, code: i64) -> bool {
        self.g_codes().any(|it| it == code)
    }

    /// Returns the G codes of the block, in tenths: G92.1 is 921.
    pub fn g_codes(&self) -> impl Iterator<Item = i64> {
        let words = self.words().filter(|word| word.letter == b'G');
        words.filter_map(|word| Some(word.number?.micro / 100_000))
    }

    /// Replaces the first word with this letter by `text`; returns `false` if the block has no such
    /// word.
    pub fn replace(&mut self, letter: u8, text: &str) -> bool {
        for piece in &mut self.pieces {
            if let LinePiece::Word(word) = piece
                && word.letter == letter
                && !word.has_comma
            {
                *piece = LinePiece::Text(text.to_owned());
                return true;
            }
        }
        false
    }

    /// Replaces the first G code equal to `code` (tenths: G92 is 920) by `text`.
    pub fn replace_g(&mut self, code: i64, text: &str) {
        self.replace_where(
            |word| word.letter == b'G' && word.number.is_some_and(|it| it.micro / 100_000 == code),
            text,
        );
    }

    /// Replaces the first word for which `is` returns true by `text`; returns `false` if there is
    /// none.
    pub fn replace_where(&mut self, is: impl Fn(&ForeignWord) -> bool, text: &str) -> bool {
        let found = self
            .pieces
            .iter_mut()
            .find(|piece| matches!(piece, LinePiece::Word(word) if is(word)));
        match found {
            Some(piece) => {
                *piece = LinePiece::Text(text.to_owned());
                true
            }
            None => false,
        }
    }

    /// Removes all words for which `is` returns true, and returns them.
    pub fn remove_where(&mut self, is: impl Fn(&ForeignWord) -> bool) -> Vec<ForeignWord> {
        let mut removed = Vec::new();
        let mut at = 0;
        while at < self.pieces.len() {
            match &self.pieces[at] {
                LinePiece::Word(word) if is(word) => {
                    removed.push(word.clone());
                    self.pieces.remove(at);
                    self.remove_blank_at(at);
                }
                _ => at += 1,
            }
        }
        removed
    }

    /// Removes all words with one of these letters, and returns them.
    pub fn remove(&mut self, letters: &[u8]) -> Vec<ForeignWord> {
        self.remove_where(|word| !word.has_comma && letters.contains(&word.letter))
    }

    /// Removes the G codes with these numbers, in tenths: G92 is 920.
    pub fn remove_g(&mut self, codes: &[i64]) {
        self.remove_where(|word| {
            let code = word.number.map(|it| it.micro / 100_000);
            word.letter == b'G' && code.is_some_and(|it| codes.contains(&it))
        });
    }

    /// Removes the blank at a position from which a word was removed, so that one blank remains
    /// between its neighbours.
    fn remove_blank_at(&mut self, at: usize) {
        let is_blank = |piece: Option<&LinePiece>| matches!(piece, Some(LinePiece::Text(text)) if text.trim().is_empty());
        let is_end = at == self.pieces.len();
        let follows_blank = at > 0 && is_blank(self.pieces.get(at - 1));
        if is_end && follows_blank {
            self.pieces.pop();
        } else if is_blank(self.pieces.get(at)) && (at == 0 || follows_blank) {
            self.pieces.remove(at);
        }
    }

    /// Removes empty pieces and blanks that follow a blank.
    pub fn drop_double_blanks(&mut self) {
        let is_blank =
            |piece: &LinePiece| matches!(piece, LinePiece::Text(text) if text.trim().is_empty());
        self.pieces
            .retain(|piece| !matches!(piece, LinePiece::Text(text) if text.is_empty()));
        self.pieces
            .dedup_by(|next, kept| is_blank(next) && is_blank(kept));
    }

    /// Adds the word `text` after the last word of the block, before comments.
    pub fn append(&mut self, text: &str) {
        let is_content = |piece: &LinePiece| match piece {
            LinePiece::Word(_) | LinePiece::Formula(_) => true,
            LinePiece::Text(text) => is_word_text(text),
        };
        let end = self.pieces.iter().rposition(is_content);
        let at = end.map_or(0, |end| end + 1);
        let text = if at == 0 {
            text.to_owned()
        } else {
            format!(" {text}")
        };
        self.pieces.insert(at, LinePiece::Text(text));
    }

    /// Adds the word `text` after N and the block skip mark, before the other words.
    pub fn prepend(&mut self, text: &str) {
        let is_first = |piece: &LinePiece| match piece {
            LinePiece::Word(word) => word.letter != b'N' && word.letter != b'O',
            LinePiece::Formula(_) => true,
            LinePiece::Text(text) => is_word_text(text) && !text.starts_with('N'),
        };
        let at = self.pieces.iter().position(is_first);
        let at = at.unwrap_or(self.pieces.len());
        self.pieces.insert(at, LinePiece::Text(format!("{text} ")));
    }

    /// Whether the block has anything besides its program and sequence numbers and comments.
    pub fn has_content(&self) -> bool {
        self.pieces.iter().any(|piece| match piece {
            LinePiece::Word(word) => word.letter != b'N',
            LinePiece::Formula(_) => true,
            LinePiece::Text(text) => is_word_text(text) && !text.starts_with('N'),
        })
    }

    /// Returns the block as text, with the changes made so far.
    pub fn text(&self) -> String {
        self.pieces.iter().map(LinePiece::written).collect()
    }
}

/// Whether a text begins with an upper-case letter, as the words that the porter writes do; the
/// blank before an appended word does not count.
fn is_word_text(text: &str) -> bool {
    text.trim_start()
        .bytes()
        .next()
        .is_some_and(|byte| byte.is_ascii_uppercase())
}

/// Splits the text of one block into words, unchanged texts and formulas; `line` is its line, from
/// 1.
pub(crate) fn split_block(line: u32, text: &str) -> ForeignBlock {
    let mut pieces = Vec::new();
    let bytes = text.as_bytes();
    let mut at = 0;
    while at < bytes.len() {
        let end = match bytes[at] {
            b'(' => comment_end(text, at),
            b' ' | b'\t' | b'/' | b'%' => at + 1,
            b',' | b'a'..=b'z' | b'A'..=b'Z' | b':' => {
                let (end, word) = split_word(text, at);
                match word {
                    Some(word) => pieces.push(LinePiece::Word(word)),
                    None => push_formula(&mut pieces, &text[at..end]),
                }
                at = end;
                continue;
            }
            _ => {
                let end = text[at..].char_indices().nth(1);
                let end = end.map_or(text.len(), |(size, _)| at + size);
                push_formula(&mut pieces, &text[at..end]);
                at = end;
                continue;
            }
        };
        pieces.push(LinePiece::Text(text[at..end].to_owned()));
        at = end;
    }
    ForeignBlock {
        line,
        pieces,
        ..ForeignBlock::default()
    }
}

fn push_formula(pieces: &mut Vec<LinePiece>, text: &str) {
    match pieces.last_mut() {
        Some(LinePiece::Formula(formula)) => formula.push_str(text),
        _ => pieces.push(LinePiece::Formula(text.to_owned())),
    }
}

/// Returns the byte after the comment that begins at byte `at`; brackets inside it are counted.
fn comment_end(text: &str, at: usize) -> usize {
    let mut depth = 0;
    for (offset, byte) in text[at..].bytes().enumerate() {
        match byte {
            b'(' => depth += 1,
            b')' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return at + offset + 1;
        }
    }
    text.len()
}

/// Returns the byte after the word that begins at byte `at`, and the word; `None` if no number or
/// variable follows the letter.
fn split_word(text: &str, at: usize) -> (usize, Option<ForeignWord>) {
    let bytes = text.as_bytes();
    let blank = |mut at: usize| {
        while matches!(bytes.get(at), Some(b' ' | b'\t')) {
            at += 1;
        }
        at
    };
    let has_comma = bytes[at] == b',';
    let letter_at = if has_comma { blank(at + 1) } else { at };
    let Some(letter) = bytes
        .get(letter_at)
        .filter(|it| it.is_ascii_alphabetic() || **it == b':')
    else {
        return (at + 1, None);
    };
    let begin = blank(letter_at + 1);
    let mut end = begin;
    if matches!(bytes.get(end), Some(b'-' | b'+')) {
        end = blank(end + 1);
    }
    let is_variable = matches!(bytes.get(end), Some(b'#' | b'['));
    if is_variable {
        end = variable_end(bytes, end);
    } else {
        while matches!(bytes.get(end), Some(b'0'..=b'9' | b'.')) {
            end += 1;
        }
    }
    let number: String = text[begin..end].split_whitespace().collect();
    let number = Number::parse(&number);
    if number.is_none() && !is_variable {
        return (letter_at + 1, None);
    }
    let word = ForeignWord {
        letter: match letter {
            b':' => b'O',
            _ => letter.to_ascii_uppercase(),
        },
        has_comma,
        number,
        written: text[at..end].to_owned(),
    };
    (end, Some(word))
}

/// Returns the byte after the variable, or after the formula in brackets, that begins at `at`.
fn variable_end(bytes: &[u8], at: usize) -> usize {
    let mut end = at;
    while bytes.get(end) == Some(&b'#') {
        end += 1;
    }
    let (open, close) = match bytes.get(end) {
        Some(b'<') => (b'<', b'>'),
        Some(b'[') => (b'[', b']'),
        _ => {
            while bytes.get(end).is_some_and(u8::is_ascii_digit) {
                end += 1;
            }
            return end;
        }
    };
    let mut depth = 0;
    while let Some(byte) = bytes.get(end) {
        end += 1;
        if *byte == open {
            depth += 1;
        } else if *byte == close {
            depth -= 1;
            if depth == 0 {
                break;
            }
        }
    }
    end
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_keeps_its_text() {
        for text in [
            "N10 G01 X50. ,C2. (A (NESTED) COMMENT)",
            "#100=#101+1",
            "IF[#1GT2]GOTO5",
            "x 5. z -3",
            "/N5M01",
            "% G0 中文",
            "G1 X[1+[2*3]] Z#<deep> ,",
        ] {
            assert_eq!(split_block(1, text).text(), text);
        }
    }

    #[test]
    fn words_have_letters_and_values() {
        let block = split_block(3, "g1x-.5,r2. Z#101");
        let words: Vec<_> = block
            .words()
            .map(|it| (it.letter, it.has_comma, it.number.map(|it| it.micro)))
            .collect();
        assert_eq!(
            words,
            [
                (b'G', false, Some(1_000_000)),
                (b'X', false, Some(-500_000)),
                (b'R', true, Some(2_000_000)),
                (b'Z', false, None),
            ]
        );
    }

    #[test]
    fn a_removed_word_leaves_one_blank() {
        let mut block = split_block(1, "N5 G54 G00 X1. (A)");
        block.remove_g(&[540]);
        assert_eq!(block.text(), "N5 G00 X1. (A)");
        block.append("M08");
        assert_eq!(block.text(), "N5 G00 X1. M08 (A)");
        block.prepend("G99");
        assert_eq!(block.text(), "N5 G99 G00 X1. M08 (A)");
    }
}
