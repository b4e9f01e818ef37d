//! Formats a program: block numbers, blanks between words, upper case. The meaning does not
//! change. Where that is uncertain, the numbers remain.

use std::collections::BTreeMap;

use gsk_core::model::ModelId;
use gsk_messages::{Message, say};

use crate::reference_target::ReferenceTarget;
use crate::rename::check_targets_known;
use crate::structure::Structure;
use crate::text::{TextChange, TextDocument, TextRange};
use crate::words::{Span, SpanKind, spans};

/// Which blocks get sequence numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Numbering {
    /// Keeps all sequence numbers.
    #[default]
    Unchanged,
    /// Renumbers the blocks that have a sequence number.
    Present {
        /// First sequence number that the numbering gives.
        start: u16,
        /// Difference from one sequence number to the next.
        step: u16,
    },
    /// Gives every block a sequence number.
    All {
        /// First sequence number that the numbering gives.
        start: u16,
        /// Difference from one sequence number to the next.
        step: u16,
    },
}

/// The number of blanks that formatting writes between the words of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Spacing {
    /// Keeps all blanks between words.
    Unchanged,
    /// Writes one blank between words and none at the ends of a line.
    #[default]
    One,
    /// Removes all blanks between words.
    None,
}

/// The case of letters that formatting writes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Casing {
    /// Keeps the case of all letters.
    Unchanged,
    /// Converts letters to upper case.
    #[default]
    Upper,
}

/// The options for formatting a program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Style {
    /// Which blocks get sequence numbers.
    pub numbering: Numbering,
    /// The number of blanks that formatting writes between words.
    pub spacing: Spacing,
    /// The case of letters that formatting writes.
    pub casing: Casing,
}

/// The edits that format a program, or the reason why its numbers stay.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Formatted {
    /// The edits of the text, which do not overlap.
    pub edits: Vec<TextChange>,
    /// The reason why the sequence numbers remain unchanged although renumbering was requested;
    /// `None` otherwise.
    pub refused: Option<Message>,
}

/// Number of edits above which they are merged into one, because an editor applies each
/// separately.
const MAX_EDITS: usize = 1000;

/// Greatest sequence number that a block can have.
const MAX_SEQUENCE_NUMBER: u32 = 9999;

/// Returns the edits that format `lines` of a program. Sequence numbers change only if `lines`
/// covers the whole program. `outside` lists block numbers that P of M99 in programs of other
/// files refers to.
pub fn format(
    text: &TextDocument,
    structure: &Structure,
    style: Style,
    lines: core::ops::Range<u32>,
    (outside, model): (&[u16], ModelId),
) -> Formatted {
    let whole = lines.start == 0 && lines.end >= text.line_count();
    let numbers = match style.numbering {
        Numbering::Present { start, step } if whole => {
            renumber(text, structure, (start, step, false), (outside, model))
        }
        Numbering::All { start, step } if whole => {
            renumber(text, structure, (start, step, true), (outside, model))
        }
        _ => Ok(Numbers::default()),
    };
    let (numbers, refused) = match numbers {
        Ok(numbers) => (numbers, None),
        Err(reason) => (Numbers::default(), Some(reason)),
    };
    let (first, end) = structure.block_lines;
    let mut edits = Vec::new();
    for index in lines.start.max(first)..lines.end.min(end) {
        let line = text.line(index);
        let written = rewrite_line(index, line, style, &numbers);
        if written != line {
            edits.push(TextChange::replace(
                &TextRange::new(index, &(0..line.len())),
                written,
            ));
        }
    }
    Formatted {
        edits: merge_many_edits(text, edits),
        refused,
    }
}

/// Merges the edits, if they are more than the limit, into one that spans the first to the
/// last line.
fn merge_many_edits(text: &TextDocument, edits: Vec<TextChange>) -> Vec<TextChange> {
    let (Some(first), Some(last)) = (edits.first(), edits.last()) else {
        return edits;
    };
    if edits.len() <= MAX_EDITS {
        return edits;
    }
    let (from, to) = (first.from, last.to);
    let begin = text.offset(from);
    let mut written = String::new();
    let mut copied = begin;
    for edit in &edits {
        written.push_str(&text.as_str()[copied..text.offset(edit.from)]);
        written.push_str(&edit.text);
        copied = text.offset(edit.to);
    }
    vec![TextChange {
        from,
        to,
        text: written,
    }]
}

/// The sequence numbers that a renumbering writes: replaced digits, and numbers for blocks
/// without one.
#[derive(Default)]
struct Numbers {
    /// New digits of sequence numbers, by the line and first byte of the old digits.
    changed: BTreeMap<(u32, u32), String>,
    /// New numbers by line and first byte of the first word of the block.
    added: BTreeMap<(u32, u32), String>,
}

fn renumber(
    text: &TextDocument,
    structure: &Structure,
    (start, step, all): (u16, u16, bool),
    (outside, model): (&[u16], ModelId),
) -> Result<Numbers, Message> {
    check_targets_known(structure, outside, model)?;
    // A macro may read the number of its block.
    if text.as_str().contains("#4114") {
        return Err(say::numbers_are_read());
    }
    let mut numbers = Numbers::default();
    // New number of each numbered block, by the range of its digits.
    let mut anew: BTreeMap<&TextRange, u32> = BTreeMap::new();
    let width = number_width(text, structure);
    let mut blocks = structure.blocks.iter().peekable();
    for lines in &structure.parts {
        let mut next = u32::from(start);
        for index in lines.from.max(structure.block_lines.0)..lines.to.min(structure.block_lines.1)
        {
            let line = text.line(index);
            for block in blocks_of(line, &spans(line)) {
                let Some(word) = first_word(block) else {
                    continue;
                };
                let (from, to) = (block[0].range.start, block[block.len() - 1].range.end);
                let here = |range: &TextRange| {
                    let at = range.from as usize;
                    range.line == index && from <= at && at < to
                };
                let own = blocks.next_if(|it| here(&it.digits));
                // An N elsewhere in its block is its number, too. O, or `:` of other controls,
                // names a program.
                let named = block.iter().any(|it| it.kind == SpanKind::Name)
                    || line[word..].starts_with(':');
                match own {
                    Some(own) => {
                        anew.insert(&own.digits, next);
                        let key = (index, own.digits.from);
                        numbers.changed.insert(key, pad_number(next, width));
                    }
                    None if all && !named => {
                        let key = (index, word as u32);
                        numbers.added.insert(key, pad_number(next, width));
                    }
                    None => continue,
                }
                if next > MAX_SEQUENCE_NUMBER {
                    return Err(say::numbers_beyond(MAX_SEQUENCE_NUMBER, index + 1));
                }
                next += u32::from(step.max(1));
            }
        }
    }
    for reference in &structure.references {
        if matches!(reference.target, ReferenceTarget::Program(_)) {
            continue;
        }
        let line = reference.digits.line + 1;
        let callers = structure.callers(reference.part).len();
        // P of M99 where no program of the text calls this one: the caller is unknown.
        if matches!(reference.target, ReferenceTarget::Caller(_)) && callers != 1 {
            return Err(say::lead_to_several(line));
        }
        let number = match structure.referenced_blocks(reference)[..] {
            [block] => anew.get(&block.digits).copied(),
            [] => return Err(say::lead_to_nothing(line)),
            _ => return Err(say::lead_to_several(line)),
        };
        if let Some(number) = number {
            let key = (reference.digits.line, reference.digits.from);
            numbers.changed.insert(key, pad_number(number, width));
        }
    }
    Ok(numbers)
}

/// The number of digits to which sequence numbers are padded: that of the first number in the
/// text if it has leading zeros, else 0 for no padding.
fn number_width(text: &TextDocument, structure: &Structure) -> usize {
    let first = structure.blocks.first().map(|block| &block.digits);
    let digits = first.and_then(|it| text.line(it.line).get(it.from as usize..it.to as usize));
    match digits {
        Some(digits) if digits.starts_with('0') => digits.len(),
        _ => 0,
    }
}

fn pad_number(number: u32, width: usize) -> String {
    format!("{number:0width$}")
}

/// Returns the spans of a line, split into its blocks.
fn blocks_of<'a>(line: &'a str, spans: &'a [Span]) -> impl Iterator<Item = &'a [Span]> {
    let ends = |it: &Span| is_mark(line, it, &[";", "*", "%"]);
    spans
        .split_inclusive(ends)
        .filter(|block| !block.is_empty())
}

fn is_mark(line: &str, span: &Span, marks: &[&str]) -> bool {
    let text = line.get(span.range.clone()).unwrap_or("");
    span.kind == SpanKind::Mark && marks.contains(&text)
}

/// The first byte, in its line, of the first word of a block, after its skip mark. `None` if
/// the block has no words.
fn first_word(block: &[Span]) -> Option<usize> {
    let mut spans = block.iter();
    let word = spans.find(|it| !matches!(it.kind, SpanKind::Comment | SpanKind::Mark))?;
    Some(word.range.start)
}

/// Returns the line `index` in the given style and with its new sequence numbers.
fn rewrite_line(index: u32, line: &str, style: Style, numbers: &Numbers) -> String {
    let mut out = String::with_capacity(line.len() + 8);
    let mut before: Option<(&Span, usize)> = None;
    let spans = spans(line);
    for span in &spans {
        let from = before.map_or(0, |(_, end)| end);
        let gap = line.get(from..span.range.start).unwrap_or("");
        let added = numbers.added.get(&(index, span.range.start as u32));
        // An invalid character may belong to the word beside it, but not to a number.
        let foreign = |it: &Span| it.kind == SpanKind::Foreign;
        let stays = style.spacing == Spacing::Unchanged || (added.is_none() && foreign(span));
        out.push_str(match before {
            _ if stays => gap,
            None => "",
            Some((before, _)) if foreign(before) => gap,
            Some((before, _)) => separator(line, before, span, style.spacing),
        });
        if let Some(number) = added {
            let blank = if style.spacing == Spacing::None {
                ""
            } else {
                " "
            };
            out.push_str(&format!("N{number}{blank}"));
        }
        write_span(index, line, span, style, numbers, &mut out);
        before = Some((span, span.range.end));
    }
    let rest = line.get(before.map_or(0, |(_, end)| end)..).unwrap_or("");
    if style.spacing == Spacing::Unchanged {
        out.push_str(rest);
    }
    out
}

/// Returns the blanks to write between two spans.
fn separator(line: &str, before: &Span, span: &Span, spacing: Spacing) -> &'static str {
    if is_mark(line, span, &[";", "*", "%"]) || is_mark(line, before, &["/"]) {
        return "";
    }
    match spacing {
        Spacing::None if before.kind != SpanKind::Statement && span.kind != SpanKind::Statement => {
            ""
        }
        _ => " ",
    }
}

/// Appends a span to `out` in the given style and with its new sequence number.
fn write_span(
    index: u32,
    line: &str,
    span: &Span,
    style: Style,
    numbers: &Numbers,
    out: &mut String,
) {
    let text = line.get(span.range.clone()).unwrap_or("");
    if matches!(
        span.kind,
        SpanKind::Comment | SpanKind::Mark | SpanKind::Foreign
    ) {
        out.push_str(text);
        return;
    }
    let begin = out.len();
    // Digits that change are at the end of the span.
    let from = (index, span.range.start as u32)..(index, span.range.end as u32);
    match numbers.changed.range(from).next() {
        Some(((_, at), number)) => {
            let kept = (*at as usize).saturating_sub(span.range.start);
            out.push_str(text.get(..kept).unwrap_or(text));
            out.push_str(number);
        }
        None => out.push_str(text),
    }
    if style.casing == Casing::Upper {
        let upper = out.split_off(begin).to_ascii_uppercase();
        out.push_str(&upper);
    }
    if style.spacing != Spacing::Unchanged && span.kind.is_word() {
        let word = out.split_off(begin);
        let letter = word.chars().next().map_or(0, char::len_utf8);
        let (letter, value) = word.split_at(letter);
        out.push_str(letter);
        out.push_str(value.trim_start_matches([' ', '\t']));
    }
}

impl Style {
    /// Whether this style changes nothing in any program.
    pub fn is_unchanged(&self) -> bool {
        self.numbering == Numbering::Unchanged
            && self.spacing == Spacing::Unchanged
            && self.casing == Casing::Unchanged
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_messages::Id;

    fn formatted(text: &str, style: Style) -> (String, Option<Id>) {
        let mut text = TextDocument::new(text);
        let structure = Structure::read(&text);
        let lines = 0..text.line_count();
        let done = format(&text, &structure, style, lines, (&[], ModelId::Gsk980td));
        text.apply_all(&done.edits);
        (text.as_str().to_owned(), done.refused.map(|it| it.id()))
    }

    fn numbered(text: &str, all: bool) -> (String, Option<Id>) {
        let (start, step) = (10, 10);
        let numbering = match all {
            true => Numbering::All { start, step },
            false => Numbering::Present { start, step },
        };
        formatted(
            text,
            Style {
                numbering,
                ..Style::default()
            },
        )
    }

    #[test]
    fn words_have_a_blank_between_them_and_capital_letters() {
        let text = "%\no0001(Welle)\nn10g1x - 5 Z#200 ;  (no  change)\n / N20  G0 X1. ?z\n\
                    if[#1 gt 5]goto 10\n%\nrest  of x\n";
        let wanted = "%\nO0001 (Welle)\nN10 G1 X- 5 Z#200; (no  change)\n/N20 G0 X1. ?z\n\
                      IF[#1 GT 5]GOTO 10\n%\nrest  of x\n";
        assert_eq!(formatted(text, Style::default()), (wanted.to_owned(), None));
        let none = Style {
            spacing: Spacing::None,
            ..Style::default()
        };
        let (written, _) = formatted("N10 G01 X5 (a b) F100 ;\nX1 0\n", none);
        assert_eq!(written, "N10G01X5(a b)F100;\nX1 0\n");
        let as_is = Style {
            spacing: Spacing::Unchanged,
            casing: Casing::Unchanged,
            ..none
        };
        assert_eq!(formatted(text, as_is).0, text);
        assert!(as_is.is_unchanged());
    }

    #[test]
    fn numbers_change_with_all_that_lead_to_them() {
        let text = "O0001\nN3 T0101\nG71 U1 R1\nG71 P7 Q9\nN7 G00 X20;N8 G01 Z-3\nN9 X30\n\
                    G65 H80 P-3\nM98 P2\nM30\nO0002\nN1 G0 U1\nM99 P9\n";
        let wanted = "O0001\nN10 T0101\nG71 U1 R1\nG71 P20 Q40\nN20 G00 X20; N30 G01 Z-3\nN40 X30\n\
                      G65 H80 P-10\nM98 P2\nM30\nO0002\nN10 G0 U1\nM99 P40\n";
        assert_eq!(numbered(text, false), (wanted.to_owned(), None));
        let text = "O0001 (a)\n/G0 X1\n(b)\nN0005 X2;\n;\nG1 X3 F9; Z1\n#1=2\n";
        let wanted = "O0001 (a)\n/N0010 G0 X1\n(b)\nN0020 X2;\n;\nN0030 G1 X3 F9; N0040 Z1\n\
                      N0050 #1=2\n";
        assert_eq!(numbered(text, true), (wanted.to_owned(), None));
    }

    #[test]
    fn numbers_stay_where_they_may_mean_something_else() {
        for (text, why) in [
            ("N1 G71 P5 Q6\nN5 X1\nN5 X2\nN6 X3\n", Id::LeadToSeveral),
            ("N1 G71 P5 Q6\nN5 X1\n", Id::LeadToNothing),
            ("N1 X1\nGOTO #1\n", Id::LeadComputed),
            ("N1 X1\nG65 H80 P#200\n", Id::LeadComputed),
            ("N1 X1\nM99 P1\n", Id::LeadToSeveral),
            ("N1 X1\n#1=#4114\n", Id::NumbersAreRead),
        ] {
            assert_eq!(numbered(text, false), (text.to_owned(), Some(why)));
        }
        let long = "N1 X1\n".repeat(1200);
        assert_eq!(numbered(&long, false), (long, Some(Id::NumbersBeyond)));
    }

    #[test]
    fn many_changes_are_one() {
        let text = "g0x1\nG00 X2\n".repeat(2000);
        let read = TextDocument::new(text.as_str());
        let structure = Structure::read(&read);
        let style = Style::default();
        let lines = 0..read.line_count();
        let done = format(&read, &structure, style, lines, (&[], ModelId::Gsk980td));
        assert_eq!(done.edits.len(), 1);
        assert_eq!(formatted(&text, style).0, "G0 X1\nG00 X2\n".repeat(2000));
    }
}
