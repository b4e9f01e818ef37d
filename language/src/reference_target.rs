//! Finds the block or program that a word refers to (manual I-2.4, I-3.2.6, I-3.3.1, I-3.7.3,
//! and the jumps of macro B).

use std::ops::Range;

use crate::words::{ParsedWord, Span, SpanKind, word_of};

/// The block or program to which a word or statement refers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReferenceTarget {
    /// A block of the same program by its sequence number: P and Q of G70 to G73, P of G65 H80
    /// to H86, GOTO.
    Block(u16),
    /// A block of the calling program by its sequence number (P of M99); of this program if it
    /// is the main program.
    Caller(u16),
    /// A program with this number: P of M98, of G65 and of G66.
    Program(u16),
    /// A block of the same program whose number is computed at run time.
    Computed,
}

/// Returns the block or program to which a word or statement refers, and the bytes of the number.
/// `block` contains the spans of the block in `line`. `None` if it refers to nothing.
pub fn reference_target(
    line: &str,
    block: &[Span],
    span: &Span,
) -> Option<(ReferenceTarget, Range<usize>)> {
    if span.kind == SpanKind::Statement {
        return goto(line, span);
    }
    if !matches!(span.kind, SpanKind::Other) {
        return None;
    }
    let word = word_of(line, span)?;
    let has = |address: char, numbers: &[u32]| {
        let mut words = block.iter().filter(|it| it.kind.is_word());
        words.any(|it| {
            let other = word_of(line, it).filter(|other| other.address == address);
            other
                .and_then(|it| it.number())
                .is_some_and(|it| numbers.contains(&it))
        })
    };
    match word.address {
        'P' if has('M', &[98]) || has('G', &[66]) => program(line, span, &word),
        'P' if has('G', &[65]) => {
            let operation = block.iter().filter_map(|it| word_of(line, it));
            let operation = operation
                .filter(|it| it.address == 'H')
                .find_map(|it| it.number());
            match operation {
                Some(80..=86) => sequence(line, span, &word, ReferenceTarget::Block),
                Some(_) => None,
                None => program(line, span, &word),
            }
        }
        'P' if has('M', &[99]) => sequence(line, span, &word, ReferenceTarget::Caller),
        'P' | 'Q' if has('G', &[70, 71, 72, 73]) => {
            sequence(line, span, &word, ReferenceTarget::Block)
        }
        _ => None,
    }
}

/// The number of the program that P of a call names: its last four digits. `None` if it is not
/// a number.
fn called_program(value: &str) -> Option<u16> {
    let digits = value.len().saturating_sub(4);
    value.get(digits..)?.parse().ok()
}

fn program(
    line: &str,
    span: &Span,
    word: &ParsedWord<'_>,
) -> Option<(ReferenceTarget, Range<usize>)> {
    word.number()?;
    let number = called_program(&word.value)?;
    let digits = digits_at_end(line, &span.range);
    let from = digits.start.max(digits.end.saturating_sub(4));
    let from = if line.is_char_boundary(from) {
        from
    } else {
        digits.start
    };
    Some((ReferenceTarget::Program(number), from..digits.end))
}

/// The block that a word names by its sequence number, made by `target`, and the bytes of the
/// digits. A sign only determines where a search starts. A formula or variable gives
/// [`ReferenceTarget::Computed`], a number that no block can have gives `None`.
fn sequence(
    line: &str,
    span: &Span,
    word: &ParsedWord<'_>,
    target: fn(u16) -> ReferenceTarget,
) -> Option<(ReferenceTarget, Range<usize>)> {
    let digits = word.value.trim_start_matches(['+', '-']);
    let number = digits.bytes().all(|byte| byte.is_ascii_digit());
    match number.then(|| digits.parse().ok()) {
        Some(Some(number)) => Some((target(number), digits_at_end(line, &span.range))),
        // No block can have this number.
        Some(None) => None,
        None => Some((ReferenceTarget::Computed, span.range.clone())),
    }
}

/// The block that a GOTO in a statement names, and the bytes of its number; `None` without a
/// GOTO.
fn goto(line: &str, span: &Span) -> Option<(ReferenceTarget, Range<usize>)> {
    const GOTO: &str = "GOTO";
    let text = line.get(span.range.clone())?;
    let at = text.to_ascii_uppercase().find(GOTO)? + GOTO.len();
    let target = text[at..].trim_start();
    let from = span.range.start + text.len() - target.len();
    match target.bytes().all(|byte| byte.is_ascii_digit()) {
        true => Some((
            ReferenceTarget::Block(target.parse().ok()?),
            from..span.range.end,
        )),
        false => Some((ReferenceTarget::Computed, from..span.range.end)),
    }
}

/// Returns the bytes of the digits at the end of a word, including full-width digits.
pub(crate) fn digits_at_end(line: &str, word: &Range<usize>) -> Range<usize> {
    let text = line.get(word.clone()).unwrap_or("");
    let is_digit = |it: char| crate::words::to_half_width(it).is_ascii_digit();
    let rest = text.trim_end_matches(is_digit);
    word.start + rest.len()..word.end
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::words::spans;

    fn aims(line: &str) -> Vec<(ReferenceTarget, &str)> {
        let spans = spans(line);
        let found = spans
            .iter()
            .filter_map(|span| reference_target(line, &spans, span));
        found
            .map(|(target, digits)| (target, &line[digits]))
            .collect()
    }

    #[test]
    fn words_lead_to_blocks_and_programs() {
        assert_eq!(
            aims("G71 P30 Q0050 U0.5"),
            [
                (ReferenceTarget::Block(30), "30"),
                (ReferenceTarget::Block(50), "0050")
            ]
        );
        assert_eq!(aims("M98 P20003"), [(ReferenceTarget::Program(3), "0003")]);
        assert_eq!(aims("m98p7"), [(ReferenceTarget::Program(7), "7")]);
        assert_eq!(aims("M99 P30"), [(ReferenceTarget::Caller(30), "30")]);
        assert_eq!(aims("G65 H80 P-12"), [(ReferenceTarget::Block(12), "12")]);
        assert_eq!(
            aims("G65 H81 P#200 Q1"),
            [(ReferenceTarget::Computed, "P#200")]
        );
        assert_eq!(
            aims("G65 P9010 A1.0"),
            [(ReferenceTarget::Program(9010), "9010")]
        );
        assert_eq!(
            aims("IF [#1 GT 5] GOTO 20"),
            [(ReferenceTarget::Block(20), "20")]
        );
        assert_eq!(aims("GOTO#1"), [(ReferenceTarget::Computed, "#1")]);
        for nothing in [
            "G04 P300",
            "G75 X10 Q3000",
            "G65 H01 P#200 Q5",
            "M99",
            "M99 P99999",
        ] {
            assert_eq!(aims(nothing), [], "{nothing}");
        }
    }
}
