//! Finds the targets of words in a text, N numbers, programs and lines, and searches for text.

use std::ops::Range;

use gsk_language::words::{Span, spans, words};
use gsk_language::{ReferenceTarget, reference_target};

/// The target of a jump in a program text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JumpTarget {
    /// Jump to the block with this N number.
    Sequence(u16),
    /// Jump to the program with this O number.
    Program(u16),
    /// Jump to the line with this number, from 1.
    Line(u32),
}

impl JumpTarget {
    /// Parses a typed target: `N30`, `O2`, or a line number. `None` for other texts.
    pub fn parse(text: &str) -> Option<Self> {
        let text = text.trim();
        if let Ok(line) = text.parse::<u32>() {
            return (line > 0).then_some(Self::Line(line));
        }
        let number = text.get(1..)?.trim().parse().ok()?;
        match text.chars().next()?.to_ascii_uppercase() {
            'N' => Some(Self::Sequence(number)),
            'O' => Some(Self::Program(number)),
            _ => None,
        }
    }

    /// The target that a word of a line refers to (manual I-2.4, I-3.3, I-5); `None` if it
    /// refers to none.
    pub fn from_word(line: &str, word: &Span) -> Option<Self> {
        match reference_target(line, &spans(line), word)?.0 {
            ReferenceTarget::Block(number) | ReferenceTarget::Caller(number) => {
                Some(Self::Sequence(number))
            }
            ReferenceTarget::Program(number) => Some(Self::Program(number)),
            ReferenceTarget::Computed => None,
        }
    }

    /// The line of the target in a text, from 0; `None` if the text lacks it. If several
    /// blocks have the number, it is the next one after the line `after`, as in the control's
    /// search.
    pub fn find_line(self, text: &str, after: usize) -> Option<usize> {
        let begins_with = |line: &str, address: char, number: u16| {
            let line = line.trim_start_matches(['/', ' ']);
            words(line)
                .next()
                .is_some_and(|word| word.address == address && word.number() == Some(number.into()))
        };
        let (address, number) = match self {
            Self::Line(line) => {
                let last = text.lines().count().saturating_sub(1);
                return Some((line as usize).saturating_sub(1).min(last));
            }
            Self::Sequence(number) => ('N', number),
            Self::Program(number) => ('O', number),
        };
        let mut first = None;
        for (index, line) in text.lines().enumerate() {
            if begins_with(line, address, number) {
                if index > after {
                    return Some(index);
                }
                first = first.or(Some(index));
            }
        }
        first
    }
}

/// The byte range of the next match at byte `from` or later, else of the first match in the
/// text; `None` without a match. ASCII letters match in upper and lower case.
pub fn find_text(text: &str, sought: &str, from: usize) -> Option<Range<usize>> {
    if sought.is_empty() {
        return None;
    }
    let (text, sought) = (text.to_ascii_uppercase(), sought.to_ascii_uppercase());
    let from = (from..=text.len()).find(|at| text.is_char_boundary(*at))?;
    let found = text[from..].find(&sought).map(|at| from + at);
    let at = found.or_else(|| text.find(&sought))?;
    Some(at..at + sought.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "O0001\nG71 P30 Q50 U0.5\nN30 G00 X10\nN50 X20\nM98 P20003\nM99 P30\nO0003\n\
                        N30 M99\n";

    fn target_of(line: &str, address: char) -> Option<JumpTarget> {
        let spans = spans(line);
        let word = spans
            .iter()
            .find(|span| line[span.range.start..].starts_with(address))?;
        JumpTarget::from_word(line, word)
    }

    #[test]
    fn p_and_q_lead_to_their_blocks_and_programs() {
        assert_eq!(
            target_of("G71 P30 Q50 U0.5", 'P'),
            Some(JumpTarget::Sequence(30))
        );
        assert_eq!(
            target_of("G71 P30 Q50 U0.5", 'Q'),
            Some(JumpTarget::Sequence(50))
        );
        assert_eq!(target_of("M98 P20003", 'P'), Some(JumpTarget::Program(3)));
        assert_eq!(target_of("M98 P3", 'P'), Some(JumpTarget::Program(3)));
        assert_eq!(target_of("M99 P30", 'P'), Some(JumpTarget::Sequence(30)));
        assert_eq!(
            target_of("G65 H80 P12", 'P'),
            Some(JumpTarget::Sequence(12))
        );
        assert_eq!(target_of("G04 P300", 'P'), None);
        assert_eq!(target_of("G75 X10 Q3000", 'Q'), None);
    }

    #[test]
    fn targets_are_found_from_where_they_are_sought() {
        assert_eq!(JumpTarget::Sequence(30).find_line(TEXT, 0), Some(2));
        assert_eq!(JumpTarget::Sequence(30).find_line(TEXT, 5), Some(7));
        assert_eq!(JumpTarget::Sequence(30).find_line(TEXT, 7), Some(2));
        assert_eq!(JumpTarget::Program(3).find_line(TEXT, 0), Some(6));
        assert_eq!(JumpTarget::Program(9).find_line(TEXT, 0), None);
        assert_eq!(JumpTarget::Line(400).find_line(TEXT, 0), Some(7));
    }

    #[test]
    fn typed_targets_are_numbers_or_names() {
        assert_eq!(JumpTarget::parse(" n30 "), Some(JumpTarget::Sequence(30)));
        assert_eq!(JumpTarget::parse("O0002"), Some(JumpTarget::Program(2)));
        assert_eq!(JumpTarget::parse("17"), Some(JumpTarget::Line(17)));
        for nothing in ["", "0", "X3", "N", "车3", "N99999"] {
            assert_eq!(JumpTarget::parse(nothing), None, "{nothing}");
        }
    }

    #[test]
    fn finding_continues_at_the_beginning() {
        let text = "G00 X1\n(粗车) g00 X2\n";
        assert_eq!(find_text(text, "g00", 0), Some(0..3));
        let second = text.find("g00");
        assert_eq!(find_text(text, "G00", 1).map(|found| found.start), second);
        assert_eq!(find_text(text, "g00", text.len()), Some(0..3));
        assert_eq!(
            find_text(text, "车", 9),
            text.find("车").map(|at| at..at + 3)
        );
        assert_eq!(
            (find_text(text, "G99", 0), find_text(text, "", 0)),
            (None, None)
        );
    }
}
