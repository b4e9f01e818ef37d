//! Reads the structure of a text in one pass: programs, numbered blocks and references to them,
//! tools, cycles, loops, titles.

use std::collections::{BTreeMap, BTreeSet};

use crate::plain_block::parse_plain_block;
use crate::reference_target::{ReferenceTarget, digits_at_end, reference_target};
use crate::text::{TextDocument, TextRange};
use crate::words::{ParsedWord, Span, SpanKind, spans, word_of};

/// A program of the text, from its O word to the next.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramPart {
    /// Number of the program; `None` without an O word.
    pub number: Option<u16>,
    /// Range of the digits of the program's O word; `None` without an O word.
    pub name: Option<TextRange>,
    /// First line of the program, from 0.
    pub from: u32,
    /// The line after the last line of the program, from 0.
    pub to: u32,
}

/// A block with a sequence number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NumberedBlock {
    /// The sequence number of the block.
    pub number: u16,
    /// Range of the digits of the sequence number.
    pub digits: TextRange,
    /// Range of the whole N word.
    pub word: TextRange,
    /// Index in `parts` of the program that contains the block.
    pub part: usize,
}

/// A word that refers to a block or program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WordReference {
    /// The block or program to which the word refers.
    pub target: ReferenceTarget,
    /// Range of the digits that identify the target.
    pub digits: TextRange,
    /// Range of the whole word, or of the whole statement.
    pub word: TextRange,
    /// Index in `parts` of the program that contains the word.
    pub part: usize,
}

/// A T word of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ToolCall {
    /// Digits of the T word as written.
    pub value: String,
    /// Range of the T word.
    pub range: TextRange,
    /// Index in `parts` of the program that contains the T word.
    pub part: usize,
}

/// A comment alone on its line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Title {
    /// The text between the parentheses.
    pub text: String,
    /// Range of the comment with its parentheses.
    pub range: TextRange,
}

/// A cycle with a profile: G70 to G73 with P and Q.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProfileCycle {
    /// Number of the G code, 70 to 73.
    pub code: u8,
    /// Range of the G word of the cycle.
    pub range: TextRange,
    /// The sequence numbers P and Q, the first and last block of the profile.
    pub profile: (u16, u16),
    /// The finishing allowances U and W as written; `None` for one that is not programmed.
    pub allowances: (Option<String>, Option<String>),
    /// Index in `parts` of the program that contains the cycle.
    pub part: usize,
}

/// A loop of macro B, from DO to its END.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MacroLoop {
    /// Range of the DO statement that begins the loop.
    pub begin: TextRange,
    /// Range of the END statement that ends the loop.
    pub end: TextRange,
}

/// The programs, blocks, references and loops of a text, as an editor shows them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Structure {
    /// Programs in the order of the text.
    pub parts: Vec<ProgramPart>,
    /// Numbered blocks in the order of the text.
    pub blocks: Vec<NumberedBlock>,
    /// Words that refer to blocks or programs.
    pub references: Vec<WordReference>,
    /// T words in the order of the text.
    pub tools: Vec<ToolCall>,
    /// Comments alone on their line, in the order of the text.
    pub titles: Vec<Title>,
    /// Cycles with a profile (G70 to G73), in the order of the text.
    pub cycles: Vec<ProfileCycle>,
    /// Loops of macro B, from DO to END, in the order of the text.
    pub loops: Vec<MacroLoop>,
    /// First line with blocks, and the line after the last one, both from 0. The control
    /// ignores the text before the `%` at the start and after the `%` at the end.
    pub block_lines: (u32, u32),
    /// Indices into `blocks`, sorted by program and number.
    sorted_blocks: Vec<usize>,
    /// For each program of `parts`, the indices of the programs that call it.
    callers: Vec<Vec<usize>>,
}

/// Maximum number of blocks with the same number that are returned. The control uses the
/// first.
const MAX_BLOCKS_PER_NUMBER: usize = 20;

/// Reads the structure of a text line by line.
#[derive(Default)]
struct StructureReader {
    structure: Structure,
    /// DO statements whose END is not read yet, each with the number of its loop.
    open: Vec<(u16, TextRange)>,
    /// Whether any block has been read already.
    begun: bool,
}

impl Structure {
    /// Reads the programs, blocks and references of a text.
    pub fn read(text: &TextDocument) -> Self {
        let mut reader = StructureReader::default();
        reader.structure.block_lines = (0, text.line_count());
        reader.structure.parts.push(ProgramPart {
            number: None,
            name: None,
            from: 0,
            to: text.line_count(),
        });
        for (index, line) in text.lines() {
            if reader.line(index, line).is_break() {
                break;
            }
        }
        reader.structure.sort();
        reader.structure
    }

    fn sort(&mut self) {
        let blocks = &self.blocks;
        let mut order: Vec<usize> = (0..blocks.len()).collect();
        order.sort_by_key(|at| blocks.get(*at).map(|it| (it.part, it.number, *at)));
        self.sorted_blocks = order;
        let mut by_number = BTreeMap::new();
        for (index, part) in self.parts.iter().enumerate() {
            if let Some(number) = part.number {
                by_number.entry(number).or_insert_with(Vec::new).push(index);
            }
        }
        let mut callers = vec![BTreeSet::new(); self.parts.len()];
        for reference in &self.references {
            let ReferenceTarget::Program(number) = reference.target else {
                continue;
            };
            for called in by_number.get(&number).into_iter().flatten() {
                if let Some(callers) = callers.get_mut(*called) {
                    callers.insert(reference.part);
                }
            }
        }
        let callers = callers.into_iter();
        self.callers = callers.map(|it| it.into_iter().collect()).collect();
    }

    /// Returns the index of the program that contains `line` (from 0).
    pub fn part_at_line(&self, line: u32) -> usize {
        let after = self.parts.partition_point(|part| part.from <= line);
        after.saturating_sub(1)
    }

    /// Returns the blocks of this text that a reference may name; the control uses one of
    /// them. P of M99 can refer to blocks of several callers. Empty for a reference to a
    /// program.
    pub fn referenced_blocks(&self, reference: &WordReference) -> Vec<&NumberedBlock> {
        match reference.target {
            ReferenceTarget::Block(number) => self.blocks_in_part(number, reference.part).collect(),
            ReferenceTarget::Caller(number) => {
                let searched = match self.callers(reference.part) {
                    [] => core::slice::from_ref(&reference.part),
                    callers => callers,
                };
                let found = searched.iter();
                found
                    .flat_map(|part| self.blocks_in_part(number, *part))
                    .collect()
            }
            ReferenceTarget::Program(_) | ReferenceTarget::Computed => Vec::new(),
        }
    }

    /// Returns the blocks with a number in the program `part`, up to a maximum count.
    pub fn blocks_in_part(&self, number: u16, part: usize) -> impl Iterator<Item = &NumberedBlock> {
        let key = |at: &usize| self.blocks.get(*at).map(|it| (it.part, it.number));
        let wanted = Some((part, number));
        let from = self.sorted_blocks.partition_point(|at| key(at) < wanted);
        let found = self.sorted_blocks.get(from..).unwrap_or(&[]).iter();
        found
            .take_while(move |at| key(at) == wanted)
            .take(MAX_BLOCKS_PER_NUMBER)
            .filter_map(|at| self.blocks.get(*at))
    }

    /// Returns the indices of the programs that call the program `part`.
    pub fn callers(&self, part: usize) -> &[usize] {
        self.callers.get(part).map_or(&[], Vec::as_slice)
    }
}

impl StructureReader {
    fn line(&mut self, index: u32, line: &str) -> core::ops::ControlFlow<()> {
        match parse_plain_block(line) {
            Some(number) => {
                self.begun = true;
                self.structure.blocks.extend(number.map(|(number, digits)| {
                    let part = self.structure.parts.len().saturating_sub(1);
                    NumberedBlock {
                        number,
                        word: TextRange::new(index, &(0..digits.end)),
                        digits: TextRange::new(index, &digits),
                        part,
                    }
                }));
                core::ops::ControlFlow::Continue(())
            }
            None => self.any_line(index, line),
        }
    }

    fn any_line(&mut self, index: u32, line: &str) -> core::ops::ControlFlow<()> {
        let spans = spans(line);
        if let [only] = &spans[..]
            && only.kind == SpanKind::Comment
        {
            self.title(index, line, only);
        }
        let ends = |span: &Span| {
            let mark = line.get(span.range.clone()).unwrap_or("");
            span.kind == SpanKind::Mark && matches!(mark, ";" | "*" | "%")
        };
        for block in spans.split_inclusive(ends) {
            self.block(index, line, block);
            let percent = block
                .last()
                .is_some_and(|it| line.get(it.range.clone()) == Some("%"));
            self.begun |= block
                .iter()
                .any(|it| !matches!(it.kind, SpanKind::Comment | SpanKind::Mark));
            if percent && self.begun {
                self.structure.block_lines.1 = index + 1;
                return core::ops::ControlFlow::Break(());
            }
            if percent {
                // The start of a tape: the rest of its line is a leader.
                self.structure.block_lines.0 = index + 1;
                break;
            }
        }
        core::ops::ControlFlow::Continue(())
    }

    fn title(&mut self, index: u32, line: &str, span: &Span) {
        let comment = line.get(span.range.clone()).unwrap_or("");
        let text = comment.trim_matches(['(', ')', '（', '）']).trim();
        if !text.is_empty() {
            self.structure.titles.push(Title {
                text: text.to_owned(),
                range: TextRange::new(index, &span.range),
            });
        }
    }

    fn block(&mut self, index: u32, line: &str, block: &[Span]) {
        let mut code = None;
        for span in block {
            match span.kind {
                SpanKind::Name => self.name(index, line, block, span),
                SpanKind::Setting => self.tool(index, line, span),
                SpanKind::Code => {
                    let number = word_of(line, span).and_then(|word| word.number());
                    if let Some(number @ 70..=73) = number {
                        code = Some((number as u8, TextRange::new(index, &span.range)));
                    }
                }
                SpanKind::Statement => self.statement(index, line, span),
                _ => {}
            }
            if let Some((target, digits)) = reference_target(line, block, span) {
                let part = self.part();
                self.structure.references.push(WordReference {
                    target,
                    digits: TextRange::new(index, &digits),
                    word: TextRange::new(index, &span.range),
                    part,
                });
            }
        }
        if let Some((code, range)) = code {
            self.cycle(code, range, line, block);
        }
    }

    fn part(&self) -> usize {
        self.structure.parts.len().saturating_sub(1)
    }

    /// Stores an N or O word. The word counts only at the start of a block, after the skip
    /// mark.
    fn name(&mut self, index: u32, line: &str, block: &[Span], span: &Span) {
        let mut before = block.iter().take_while(|it| *it != span);
        let is_n = |it: &Span| word_of(line, it).is_some_and(|word| word.address == 'N');
        let at_begin = |it: &Span| match it.kind {
            SpanKind::Mark | SpanKind::Comment => true,
            SpanKind::Name => !is_n(it),
            _ => false,
        };
        if !before.all(at_begin) {
            return;
        }
        let Some(word) = word_of(line, span) else {
            return;
        };
        let number = word.number().and_then(|it| u16::try_from(it).ok());
        let Some(number) = number.filter(|it| *it <= 9999) else {
            return;
        };
        let digits = TextRange::new(index, &digits_at_end(line, &span.range));
        if word.address == 'N' {
            let part = self.part();
            self.structure.blocks.push(NumberedBlock {
                number,
                digits,
                word: TextRange::new(index, &span.range),
                part,
            });
            return;
        }
        let parts = &mut self.structure.parts;
        let first = parts.len() == 1 && parts[0].name.is_none();
        if !first {
            if let Some(before) = parts.last_mut() {
                before.to = index;
            }
            parts.push(ProgramPart {
                number: None,
                name: None,
                from: index,
                to: self.structure.block_lines.1,
            });
        }
        if let Some(part) = parts.last_mut() {
            part.number = Some(number);
            part.name = Some(digits);
        }
    }

    fn tool(&mut self, index: u32, line: &str, span: &Span) {
        let word = word_of(line, span).filter(|word| word.address == 'T');
        if let Some(ParsedWord { value, .. }) = word {
            let part = self.part();
            self.structure.tools.push(ToolCall {
                value: value.into_owned(),
                range: TextRange::new(index, &span.range),
                part,
            });
        }
    }

    fn cycle(&mut self, code: u8, range: TextRange, line: &str, block: &[Span]) {
        let words: Vec<ParsedWord<'_>> = (block.iter())
            .filter(|it| it.kind.is_word())
            .filter_map(|it| word_of(line, it))
            .collect();
        let value = |address| words.iter().find(|word| word.address == address);
        let number = |address| {
            value(address)?
                .number()
                .and_then(|it| u16::try_from(it).ok())
        };
        let (Some(p), Some(q)) = (number('P'), number('Q')) else {
            return;
        };
        let allowances = |address| value(address).map(|word| word.value.clone().into_owned());
        let part = self.part();
        self.structure.cycles.push(ProfileCycle {
            code,
            range,
            profile: (p, q),
            allowances: (allowances('U'), allowances('W')),
            part,
        });
    }

    fn statement(&mut self, index: u32, line: &str, span: &Span) {
        let text = line
            .get(span.range.clone())
            .unwrap_or("")
            .to_ascii_uppercase();
        let range = TextRange::new(index, &span.range);
        let digits = text.trim_end_matches(|it: char| it.is_ascii_digit());
        let Some(number) = text.get(digits.len()..).and_then(|it| it.parse().ok()) else {
            return;
        };
        let words = digits.trim_end();
        if words == "END" {
            let begin = self.open.iter().rposition(|(open, _)| *open == number);
            if let Some(begin) = begin {
                let (_, begin) = self.open.remove(begin);
                self.structure.loops.push(MacroLoop { begin, end: range });
            }
        } else if words == "DO" || words.starts_with("WHILE") && words.ends_with("DO") {
            self.open.push((number, range));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "%\nO0001 (shaft)\n(ROUGHING)\nN5 T0101 M3 S800\nG71 U2 R1\n\
                        G71 P10 Q20 U0.5 W0.1\nN10 G00 X20\n/N20 G01 Z-30;N30 X40\nM98 P2\n\
                        WHILE [#1 LT 3] DO 1\n#1=#1+1\nEND 1\nM30\nO0002\nN10 T0202\nM99 P30\n%\n\
                        N99 behind the end\n";

    proptest::proptest! {
        #![proptest_config(proptest::prelude::ProptestConfig {
            failure_persistence: None,
            ..proptest::prelude::ProptestConfig::default()
        })]

        #[test]
        fn a_plain_block_is_read_as_any_other(line in "[NGXZUFRKSDOIW]?[0-9]{0,5}([NGXZUFRKSTO .-][ 0-9.]{0,4}){0,4}") {
            let mut as_plain = StructureReader::default();
            let mut as_words = StructureReader::default();
            let _ = (as_plain.line(3, &line), as_words.any_line(3, &line));
            proptest::prop_assert_eq!(as_plain.structure, as_words.structure);
            proptest::prop_assert_eq!(as_plain.begun, as_words.begun);
        }
    }

    #[test]
    fn one_pass_finds_what_an_editor_shows() {
        let structure = Structure::read(&TextDocument::new(TEXT));
        let parts: Vec<_> = structure
            .parts
            .iter()
            .map(|it| (it.number, it.from, it.to))
            .collect();
        assert_eq!(parts, [(Some(1), 0, 13), (Some(2), 13, 19)]);
        assert_eq!(structure.block_lines, (1, 17));
        let blocks: Vec<_> = structure
            .blocks
            .iter()
            .map(|it| (it.number, it.part))
            .collect();
        assert_eq!(blocks, [(5, 0), (10, 0), (20, 0), (30, 0), (10, 1)]);
        assert_eq!(
            structure.blocks[3].digits,
            TextRange {
                line: 7,
                from: 15,
                to: 17
            }
        );
        let tools: Vec<_> = structure
            .tools
            .iter()
            .map(|it| (&*it.value, it.part))
            .collect();
        assert_eq!(tools, [("0101", 0), ("0202", 1)]);
        assert_eq!(structure.titles[0].text, "ROUGHING");
        let cycle = &structure.cycles[0];
        assert_eq!((cycle.code, cycle.profile), (71, (10, 20)));
        assert_eq!(cycle.allowances.1.as_deref(), Some("0.1"));
        assert_eq!(
            (structure.loops[0].begin.line, structure.loops[0].end.line),
            (9, 11)
        );
        // M99 P of a program that another one calls refers to the caller.
        let back = structure
            .references
            .iter()
            .find(|it| it.target == ReferenceTarget::Caller(30))
            .expect("M99");
        let definition: Vec<_> = structure
            .referenced_blocks(back)
            .iter()
            .map(|it| it.digits.line)
            .collect();
        assert_eq!(definition, [7]);
        assert_eq!(structure.callers(1), [0]);
    }
}
