//! Reads the structure of a text in one pass: programs, numbered blocks and references to them,
//! tools, cycles, loops, titles.

use std::collections::{BTreeMap, BTreeSet};

use crate::leads::{Aim, aim_of, digits_at_end};
use crate::plain_block::plain;
use crate::text::{Place, Text};
use crate::words::{Kind, Span, Word, spans, word_of};

/// A program of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Its number, if it has an O word.
    pub number: Option<u16>,
    /// The digits of the O word.
    pub name: Option<Place>,
    /// Its first line.
    pub from: u32,
    /// The line after its last one.
    pub to: u32,
}

/// A block with a sequence number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Numbered {
    /// The sequence number.
    pub number: u16,
    /// The digits of the number.
    pub digits: Place,
    /// The whole N word.
    pub word: Place,
    /// Index of the program that contains it.
    pub part: usize,
}

/// A word that refers to a block or program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lead {
    /// The target.
    pub aim: Aim,
    /// The digits that name the target.
    pub digits: Place,
    /// The whole word, or the whole statement.
    pub word: Place,
    /// Index of the program that contains it.
    pub part: usize,
}

/// A T word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ToolWord {
    /// Its digits as written.
    pub value: String,
    /// The word.
    pub place: Place,
    /// Index of the program that contains it.
    pub part: usize,
}

/// A comment alone on its line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Title {
    /// The text between the parentheses.
    pub text: String,
    /// The comment.
    pub place: Place,
}

/// A cycle with a profile: G70 to G73 with P and Q.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cycle {
    /// Number of the G code, 70 to 73.
    pub code: u8,
    /// The G word.
    pub place: Place,
    /// The sequence numbers P and Q, the first and last block of the profile.
    pub profile: (u16, u16),
    /// The finishing allowances U and W as written.
    pub leaves: (Option<String>, Option<String>),
    /// Index of the program that contains it.
    pub part: usize,
}

/// A loop of macro B, from DO to its END.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Loop {
    /// The statement with DO.
    pub begin: Place,
    /// The statement END.
    pub end: Place,
}

/// The programs, blocks and words of a text that an editor shows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Structure {
    /// Programs in the order of the text.
    pub parts: Vec<Part>,
    /// Numbered blocks in the order of the text.
    pub blocks: Vec<Numbered>,
    /// Words that refer to blocks or programs.
    pub leads: Vec<Lead>,
    /// T words.
    pub tools: Vec<ToolWord>,
    /// Comments alone on their line.
    pub titles: Vec<Title>,
    /// Cycles with a profile.
    pub cycles: Vec<Cycle>,
    /// Loops of macro B.
    pub loops: Vec<Loop>,
    /// First line with blocks, and the line after the last one. The control ignores the text
    /// before the `%` at the start and after the `%` at the end.
    pub read: (u32, u32),
    /// Indices of the numbered blocks, sorted by program and number.
    order: Vec<usize>,
    /// For each program, the indices of the programs that call it.
    callers: Vec<Vec<usize>>,
}

/// Greatest number of blocks with one number that are read. The control uses the first.
const MOST_OF_A_NUMBER: usize = 20;

/// State of the pass over the lines.
#[derive(Default)]
struct Walk {
    structure: Structure,
    /// DO statements still without END, with the number of the loop.
    open: Vec<(u16, Place)>,
    /// Whether a block has been read.
    begun: bool,
}

impl Structure {
    /// Reads the structure of a text.
    pub fn read(text: &Text) -> Self {
        let mut walk = Walk::default();
        walk.structure.read = (0, text.line_count());
        walk.structure.parts.push(Part {
            number: None,
            name: None,
            from: 0,
            to: text.line_count(),
        });
        for (index, line) in text.lines() {
            if walk.line(index, line).is_break() {
                break;
            }
        }
        walk.structure.sort();
        walk.structure
    }

    fn sort(&mut self) {
        let blocks = &self.blocks;
        let mut order: Vec<usize> = (0..blocks.len()).collect();
        order.sort_by_key(|at| blocks.get(*at).map(|it| (it.part, it.number, *at)));
        self.order = order;
        let mut by_number = BTreeMap::new();
        for (index, part) in self.parts.iter().enumerate() {
            if let Some(number) = part.number {
                by_number.entry(number).or_insert_with(Vec::new).push(index);
            }
        }
        let mut callers = vec![BTreeSet::new(); self.parts.len()];
        for lead in &self.leads {
            let Aim::Program(number) = lead.aim else {
                continue;
            };
            for called in by_number.get(&number).into_iter().flatten() {
                if let Some(callers) = callers.get_mut(*called) {
                    callers.insert(lead.part);
                }
            }
        }
        let callers = callers.into_iter();
        self.callers = callers.map(|it| it.into_iter().collect()).collect();
    }

    /// Returns the index of the program that contains a line.
    pub fn part_of(&self, line: u32) -> usize {
        let after = self.parts.partition_point(|part| part.from <= line);
        after.saturating_sub(1)
    }

    /// Returns the blocks that a reference names in this text. The control uses one of them. P
    /// of M99 can refer to blocks of several callers.
    pub fn aimed_at(&self, lead: &Lead) -> Vec<&Numbered> {
        match lead.aim {
            Aim::Block(number) => self.in_part(number, lead.part).collect(),
            Aim::Caller(number) => {
                let searched = match self.callers(lead.part) {
                    [] => core::slice::from_ref(&lead.part),
                    callers => callers,
                };
                let found = searched.iter();
                found.flat_map(|part| self.in_part(number, *part)).collect()
            }
            Aim::Program(_) | Aim::Computed => Vec::new(),
        }
    }

    /// Returns the first blocks with a number in a program.
    pub fn in_part(&self, number: u16, part: usize) -> impl Iterator<Item = &Numbered> {
        let key = |at: &usize| self.blocks.get(*at).map(|it| (it.part, it.number));
        let wanted = Some((part, number));
        let from = self.order.partition_point(|at| key(at) < wanted);
        let found = self.order.get(from..).unwrap_or(&[]).iter();
        found
            .take_while(move |at| key(at) == wanted)
            .take(MOST_OF_A_NUMBER)
            .filter_map(|at| self.blocks.get(*at))
    }

    /// Returns the indices of the programs that call a program.
    pub fn callers(&self, part: usize) -> &[usize] {
        self.callers.get(part).map_or(&[], Vec::as_slice)
    }
}

impl Walk {
    fn line(&mut self, index: u32, line: &str) -> core::ops::ControlFlow<()> {
        match plain(line) {
            Some(number) => {
                self.begun = true;
                self.structure.blocks.extend(number.map(|(number, digits)| {
                    let part = self.structure.parts.len().saturating_sub(1);
                    Numbered {
                        number,
                        word: Place::new(index, &(0..digits.end)),
                        digits: Place::new(index, &digits),
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
            && only.kind == Kind::Comment
        {
            self.title(index, line, only);
        }
        let ends = |span: &Span| {
            let mark = line.get(span.range.clone()).unwrap_or("");
            span.kind == Kind::Mark && matches!(mark, ";" | "*" | "%")
        };
        for block in spans.split_inclusive(ends) {
            self.block(index, line, block);
            let percent = block
                .last()
                .is_some_and(|it| line.get(it.range.clone()) == Some("%"));
            self.begun |= block
                .iter()
                .any(|it| !matches!(it.kind, Kind::Comment | Kind::Mark));
            if percent && self.begun {
                self.structure.read.1 = index + 1;
                return core::ops::ControlFlow::Break(());
            }
            if percent {
                // The start of a tape: the rest of its line is a leader.
                self.structure.read.0 = index + 1;
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
                place: Place::new(index, &span.range),
            });
        }
    }

    fn block(&mut self, index: u32, line: &str, block: &[Span]) {
        let mut code = None;
        for span in block {
            match span.kind {
                Kind::Name => self.name(index, line, block, span),
                Kind::Setting => self.tool(index, line, span),
                Kind::Code => {
                    let number = word_of(line, span).and_then(|word| word.number());
                    if let Some(number @ 70..=73) = number {
                        code = Some((number as u8, Place::new(index, &span.range)));
                    }
                }
                Kind::Statement => self.statement(index, line, span),
                _ => {}
            }
            if let Some((aim, digits)) = aim_of(line, block, span) {
                let part = self.part();
                self.structure.leads.push(Lead {
                    aim,
                    digits: Place::new(index, &digits),
                    word: Place::new(index, &span.range),
                    part,
                });
            }
        }
        if let Some((code, place)) = code {
            self.cycle(code, place, line, block);
        }
    }

    fn part(&self) -> usize {
        self.structure.parts.len().saturating_sub(1)
    }

    /// N and O count only at the start of a block, after the skip mark.
    fn name(&mut self, index: u32, line: &str, block: &[Span], span: &Span) {
        let mut before = block.iter().take_while(|it| *it != span);
        let is_n = |it: &Span| word_of(line, it).is_some_and(|word| word.address == 'N');
        let at_begin = |it: &Span| match it.kind {
            Kind::Mark | Kind::Comment => true,
            Kind::Name => !is_n(it),
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
        let digits = Place::new(index, &digits_at_end(line, &span.range));
        if word.address == 'N' {
            let part = self.part();
            self.structure.blocks.push(Numbered {
                number,
                digits,
                word: Place::new(index, &span.range),
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
            parts.push(Part {
                number: None,
                name: None,
                from: index,
                to: self.structure.read.1,
            });
        }
        if let Some(part) = parts.last_mut() {
            part.number = Some(number);
            part.name = Some(digits);
        }
    }

    fn tool(&mut self, index: u32, line: &str, span: &Span) {
        let word = word_of(line, span).filter(|word| word.address == 'T');
        if let Some(Word { value, .. }) = word {
            let part = self.part();
            self.structure.tools.push(ToolWord {
                value: value.into_owned(),
                place: Place::new(index, &span.range),
                part,
            });
        }
    }

    fn cycle(&mut self, code: u8, place: Place, line: &str, block: &[Span]) {
        let words: Vec<Word<'_>> = (block.iter())
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
        let leaves = |address| value(address).map(|word| word.value.clone().into_owned());
        let part = self.part();
        self.structure.cycles.push(Cycle {
            code,
            place,
            profile: (p, q),
            leaves: (leaves('U'), leaves('W')),
            part,
        });
    }

    fn statement(&mut self, index: u32, line: &str, span: &Span) {
        let text = line
            .get(span.range.clone())
            .unwrap_or("")
            .to_ascii_uppercase();
        let place = Place::new(index, &span.range);
        let digits = text.trim_end_matches(|it: char| it.is_ascii_digit());
        let Some(number) = text.get(digits.len()..).and_then(|it| it.parse().ok()) else {
            return;
        };
        let words = digits.trim_end();
        if words == "END" {
            let begin = self.open.iter().rposition(|(open, _)| *open == number);
            if let Some(begin) = begin {
                let (_, begin) = self.open.remove(begin);
                self.structure.loops.push(Loop { begin, end: place });
            }
        } else if words == "DO" || words.starts_with("WHILE") && words.ends_with("DO") {
            self.open.push((number, place));
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
            let mut as_plain = Walk::default();
            let mut taken_apart = Walk::default();
            let _ = (as_plain.line(3, &line), taken_apart.any_line(3, &line));
            proptest::prop_assert_eq!(as_plain.structure, taken_apart.structure);
            proptest::prop_assert_eq!(as_plain.begun, taken_apart.begun);
        }
    }

    #[test]
    fn one_pass_finds_what_an_editor_shows() {
        let structure = Structure::read(&Text::new(TEXT));
        let parts: Vec<_> = structure
            .parts
            .iter()
            .map(|it| (it.number, it.from, it.to))
            .collect();
        assert_eq!(parts, [(Some(1), 0, 13), (Some(2), 13, 19)]);
        assert_eq!(structure.read, (1, 17));
        let blocks: Vec<_> = structure
            .blocks
            .iter()
            .map(|it| (it.number, it.part))
            .collect();
        assert_eq!(blocks, [(5, 0), (10, 0), (20, 0), (30, 0), (10, 1)]);
        assert_eq!(
            structure.blocks[3].digits,
            Place {
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
        assert_eq!(cycle.leaves.1.as_deref(), Some("0.1"));
        assert_eq!(
            (structure.loops[0].begin.line, structure.loops[0].end.line),
            (9, 11)
        );
        // M99 P of a program that another one calls refers to the caller.
        let back = structure
            .leads
            .iter()
            .find(|it| it.aim == Aim::Caller(30))
            .expect("M99");
        let led: Vec<_> = structure
            .aimed_at(back)
            .iter()
            .map(|it| it.digits.line)
            .collect();
        assert_eq!(led, [7]);
        assert_eq!(structure.callers(1), [0]);
    }
}
