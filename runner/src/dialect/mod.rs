//! Compares how two control models read the same program, and rewrites its codes for the other
//! model as far as it has a code with the same meaning.

mod conventions;

use gsk_core::model::{GCode, MCode, ModelRecord};
use gsk_messages::{Message, say};

/// A word that two models read differently, with its line.
#[derive(Clone, Debug, PartialEq)]
pub struct DialectFinding {
    /// Line of the program text, from 1.
    pub line: u32,
    /// The word as written in the program; for a difference outside G and M codes, the first
    /// word that shows the difference, or empty.
    pub code: String,
    /// How the target model reads the word.
    pub difference: CodeDifference,
}

pub use conventions::Difference;

/// The difference with which the target model reads a code or a convention of the source model.
#[derive(Clone, Debug, PartialEq)]
pub enum CodeDifference {
    /// A difference other than in G and M codes, and the number of blocks that have it.
    Convention(Difference, usize),
    /// The model that the program was written for has no such code.
    UnknownCode,
    /// The target model has the same function under another number.
    Renumbered {
        /// The meaning of the code in the source model.
        here: CodeMeaning,
        /// The number of the G or M code that has this function in the target model.
        number: u8,
    },
    /// The target model has no such function.
    Missing {
        /// The meaning of the code in the source model.
        here: CodeMeaning,
    },
    /// The code has another meaning in the target model.
    Differs {
        /// The meaning of the code in the source model.
        here: CodeMeaning,
        /// The meaning of the code in the target model.
        there: CodeMeaning,
        /// The number of the source function in the target model; `None` if the target has no
        /// such function.
        number: Option<u8>,
    },
}

/// The meaning of a G or M code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CodeMeaning {
    /// A G code, and whether the manual or a decision defines it.
    G(GCode, MeaningSource),
    /// An M code, and whether the manual or a decision defines it.
    M(MCode, MeaningSource),
}

/// Whether a code's meaning is in the manual or was decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeaningSource {
    /// The manual of the model defines the code.
    FromManual,
    /// The manual is silent. `docs/decisions.md` records the choice.
    Decided,
}

impl CodeMeaning {
    /// Returns the name of the code's function, as a message for the user.
    pub fn text(self) -> Message {
        let (text, known) = match self {
            Self::G(code, known) => (code.text(), known),
            Self::M(code, known) => (code.text(), known),
        };
        match known {
            MeaningSource::FromManual => text,
            MeaningSource::Decided => say::dialect_decided(text),
        }
    }
}

impl DialectFinding {
    /// The message that explains how the target model reads the word, without the line number.
    pub fn text(&self, from: &ModelRecord, to: &ModelRecord) -> Message {
        let code = &self.code;
        let letter = code.get(..1).unwrap_or_default();
        let written = |number: u8| format!("{letter}{number:02}");
        match &self.difference {
            CodeDifference::Convention(difference, blocks) => conventions::MetDifference {
                difference: difference.clone(),
                line: self.line,
                code: code.clone(),
                blocks: *blocks,
            }
            .text(from, to),
            CodeDifference::UnknownCode => say::dialect_foreign(code, from.name()),
            CodeDifference::Renumbered { here, number } => {
                say::dialect_renumbered(code, here.text(), written(*number), to.name())
            }
            CodeDifference::Missing { here } => say::dialect_missing(code, here.text(), to.name()),
            CodeDifference::Differs {
                here,
                there,
                number: None,
            } => say::dialect_differs(code, here.text(), to.name(), there.text()),
            CodeDifference::Differs {
                here,
                there,
                number: Some(number),
            } => say::dialect_differs_renumbered(
                code,
                here.text(),
                to.name(),
                there.text(),
                written(*number),
            ),
        }
    }

    /// Whether [`rewrite_program`] replaces the code.
    pub const fn is_rewritten(&self) -> bool {
        self.target_number().is_some()
    }

    /// The number of the same function in the target model; `None` if [`rewrite_program`]
    /// leaves the word unchanged.
    const fn target_number(&self) -> Option<u8> {
        match self.difference {
            CodeDifference::Renumbered { number, .. } => Some(number),
            CodeDifference::Differs { number, .. } => number,
            CodeDifference::UnknownCode
            | CodeDifference::Missing { .. }
            | CodeDifference::Convention(..) => None,
        }
    }
}

/// Lists where the model `to` reads a program of the model `from` differently, in the order of
/// the text.
pub fn compare_models(text: &str, from: &ModelRecord, to: &ModelRecord) -> Vec<DialectFinding> {
    let block_findings = |block: &DialectBlock<'_>| {
        let codes = block
            .words
            .iter()
            .filter_map(|word| find_code_difference(word, block, from, to));
        codes.collect::<Vec<_>>()
    };
    let blocks = parse_blocks(text);
    let conventions = conventions::find_differences(&blocks, from, to);
    let conventions = conventions.into_iter().map(|met| DialectFinding {
        line: met.line,
        code: met.code,
        difference: CodeDifference::Convention(met.difference, met.blocks),
    });
    let mut all: Vec<DialectFinding> = conventions
        .chain(blocks.iter().flat_map(block_findings))
        .collect();
    all.sort_by_key(|finding| finding.line);
    all
}

/// Replaces the G and M codes of a program for `from` by the codes of `to` with the same
/// meaning. All other text is unchanged.
pub fn rewrite_program(text: &str, from: &ModelRecord, to: &ModelRecord) -> String {
    let mut out = String::with_capacity(text.len());
    let mut copied = 0;
    for block in parse_blocks(text) {
        for word in &block.words {
            let Some(number) =
                find_code_difference(word, &block, from, to).and_then(|it| it.target_number())
            else {
                continue;
            };
            out.push_str(&text[copied..word.number_range.0]);
            out.push_str(&format!("{number:02}"));
            copied = word.number_range.1;
        }
    }
    out.push_str(&text[copied..]);
    out
}

/// A word of a block: its letter, and the byte range of its number in the text.
#[derive(Clone, Copy, Debug)]
struct DialectWord<'a> {
    letter: u8,
    number_range: (usize, usize),
    value: &'a str,
}

/// A block of a program: its line and its words.
#[derive(Debug)]
struct DialectBlock<'a> {
    line: u32,
    words: Vec<DialectWord<'a>>,
    /// Whether the block has a formula or a variable.
    has_formula: bool,
}

impl DialectBlock<'_> {
    /// Whether the block has a word or a formula.
    const fn has_content(&self) -> bool {
        !self.words.is_empty() || self.has_formula
    }

    /// Returns the words of the block with this letter.
    fn words_with_letter(&self, letter: u8) -> impl Iterator<Item = &DialectWord<'_>> {
        self.words.iter().filter(move |word| word.letter == letter)
    }

    /// Whether a G code of the block has a meaning in the model `record` that `is` accepts.
    fn has_meaning(&self, record: &ModelRecord, is: impl Fn(GCode) -> bool) -> bool {
        self.words_with_letter(b'G').any(|word| {
            let code = word.value.parse::<u8>().ok();
            let meaning = code.and_then(|code| record.g_code(code.into()));
            meaning.is_some_and(&is)
        })
    }

    fn has_word(&self, letter: u8) -> bool {
        self.words.iter().any(|word| word.letter == letter)
    }

    fn has_negative_word(&self, letter: u8) -> bool {
        let mut words = self.words.iter();
        words.any(|word| word.letter == letter && word.value.starts_with('-'))
    }
}

/// Returns the blocks of a text that have words or formulas. Comments are skipped.
fn parse_blocks(text: &str) -> Vec<DialectBlock<'_>> {
    let bytes = text.as_bytes();
    let mut blocks = Vec::new();
    let mut block = DialectBlock {
        line: 1,
        words: Vec::new(),
        has_formula: false,
    };
    let mut line = 1;
    let (mut at, mut comment) = (0, false);
    while let Some(&byte) = bytes.get(at) {
        let ends = byte == b'\n' || (byte == b';' && !comment);
        if ends {
            line += u32::from(byte == b'\n');
            comment = false;
            let next = DialectBlock {
                line,
                words: Vec::new(),
                has_formula: false,
            };
            let done = core::mem::replace(&mut block, next);
            blocks.extend(Some(done).filter(DialectBlock::has_content));
        }
        match byte {
            b'(' => comment = true,
            b')' => comment = false,
            b'#' | b'=' | b'[' if !comment => block.has_formula = true,
            _ if !comment && byte.is_ascii_alphabetic() => {
                let word = parse_word(text, at);
                at = word.number_range.1.max(at + 1);
                if !word.value.is_empty() {
                    block.words.push(word);
                }
                continue;
            }
            _ => {}
        }
        at += 1;
    }
    blocks.extend(Some(block).filter(DialectBlock::has_content));
    blocks
}

/// Parses the word whose letter is at byte `at`. The value is empty if no number follows the
/// letter, as in keywords of macros.
fn parse_word(text: &str, at: usize) -> DialectWord<'_> {
    let bytes = text.as_bytes();
    let is = |at: usize, what: fn(u8) -> bool| bytes.get(at).copied().is_some_and(what);
    let mut begin = at + 1;
    while is(begin, |byte| byte == b' ' || byte == b'\t') {
        begin += 1;
    }
    let mut end = begin;
    if is(end, |byte| matches!(byte, b'+' | b'-')) {
        end += 1;
    }
    while is(end, |byte| byte.is_ascii_digit() || byte == b'.') {
        end += 1;
    }
    let digits = &text[begin..end];
    let value = match digits.bytes().any(|byte| byte.is_ascii_digit()) {
        true => digits,
        false => "",
    };
    DialectWord {
        letter: bytes[at].to_ascii_uppercase(),
        number_range: (begin, begin + value.len()),
        value,
    }
}

/// The difference at a G or M word; `None` if both models read it alike, and for other words.
fn find_code_difference(
    word: &DialectWord<'_>,
    block: &DialectBlock<'_>,
    from: &ModelRecord,
    to: &ModelRecord,
) -> Option<DialectFinding> {
    if !matches!(word.letter, b'G' | b'M') {
        return None;
    }
    let finding = |outcome| {
        Some(DialectFinding {
            line: block.line,
            code: format!("{}{}", char::from(word.letter), word.value),
            difference: outcome,
        })
    };
    let Ok(number) = word.value.parse::<u8>() else {
        return finding(CodeDifference::UnknownCode);
    };
    let means = match word.letter {
        b'G' => find_g_meaning,
        _ => find_m_meaning,
    };
    let Some(here) = means(from, number) else {
        return finding(CodeDifference::UnknownCode);
    };
    let there = means(to, number);
    let same =
        |there| is_same_action(here, there, block) && has_same_word_meaning(here, block, from, to);
    if there.is_some_and(same) {
        return None;
    }
    let other = (0..=u8::MAX).find(|number| means(to, *number).is_some_and(same));
    finding(match (there, other) {
        (None, None) => CodeDifference::Missing { here },
        (None, Some(number)) => CodeDifference::Renumbered { here, number },
        (Some(there), number) => CodeDifference::Differs {
            here,
            there,
            number,
        },
    })
}

/// Whether the words next to a code mean the same in both models: S next to the code that sets
/// coordinates, threads per inch and run-outs next to a thread.
fn has_same_word_meaning(
    here: CodeMeaning,
    block: &DialectBlock<'_>,
    from: &ModelRecord,
    to: &ModelRecord,
) -> bool {
    let (one, other) = (&from.conventions, &to.conventions);
    match here {
        CodeMeaning::G(GCode::Coordinates, _) if block.has_word(b'S') => {
            one.limits_speed_by_coordinates == other.limits_speed_by_coordinates
        }
        CodeMeaning::G(GCode::Thread, _) if one.x != other.x => {
            !b"IJKQ".iter().any(|letter| block.has_word(*letter))
        }
        _ => true,
    }
}

fn find_g_meaning(record: &ModelRecord, number: u8) -> Option<CodeMeaning> {
    let code = record.g_code(number.into())?;
    Some(CodeMeaning::G(
        code,
        meaning_source(&record.g_decided, number),
    ))
}

fn find_m_meaning(record: &ModelRecord, number: u8) -> Option<CodeMeaning> {
    let function = record.m_function(number)?;
    Some(CodeMeaning::M(
        function.meaning,
        meaning_source(&record.m_decided, number),
    ))
}

fn meaning_source(decided: &[u8], number: u8) -> MeaningSource {
    match decided.contains(&number) {
        true => MeaningSource::Decided,
        false => MeaningSource::FromManual,
    }
}

/// Whether two codes do the same in a block with these words. G00 rapids with and without a
/// straight path count as the same: both end at the same point.
fn is_same_action(here: CodeMeaning, there: CodeMeaning, block: &DialectBlock<'_>) -> bool {
    let (here, there) = match (here, there) {
        (CodeMeaning::G(here, _), CodeMeaning::G(there, _)) => (here, there),
        (CodeMeaning::M(here, _), CodeMeaning::M(there, _)) => return here == there,
        _ => return false,
    };
    let both = |one: GCode, other: GCode| {
        (here == one || here == other) && (there == one || there == other)
    };
    let arc = |short: GCode, long: GCode, diameter: GCode| {
        both(short, long) && !block.has_negative_word(b'R')
            || (both(short, diameter) || both(long, diameter))
                && !block.has_word(b'I')
                && !block.has_negative_word(b'R')
    };
    here == there
        || both(GCode::Rapid, GCode::StraightRapid)
        || both(GCode::Dwell, GCode::DwellSecondsFirst)
            && !(block.has_word(b'P') && (block.has_word(b'X') || block.has_word(b'U')))
        || arc(
            GCode::ArcClockwise,
            GCode::LongArcClockwise,
            GCode::DiameterArcClockwise,
        )
        || arc(
            GCode::ArcCounterclockwise,
            GCode::LongArcCounterclockwise,
            GCode::DiameterArcCounterclockwise,
        )
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::model::ModelId;

    fn list(text: &str, from: ModelId, to: ModelId) -> Vec<String> {
        let (from, to) = (from.record(), to.record());
        let findings = compare_models(text, from, to);
        let lines = findings.iter().map(|it| {
            let text = it.text(from, to).text(gsk_messages::Language::En);
            format!("{}: {text}", it.line)
        });
        lines.collect()
    }

    const TURNED: &str = "O0001;\nG50 X100 Z50 (SET; G92);\nG00 X20 Z2;\nG92 X19 Z-20 F1.5;\nG98 G01 Z-5 F100;\nM30;\n";

    #[test]
    fn what_means_something_else_is_listed_with_its_line() {
        assert_eq!(
            list(TURNED, ModelId::Gsk980td, ModelId::Hx31),
            [
                "2: G50, coordinate system set, no motion, is G92 in Huaxing 31/32",
                "4: G92 is thread cycle here, in Huaxing 31/32 coordinate system set, no motion (decided, not in its manual)",
            ]
        );
    }

    /// A mill measures X as a distance, whatever the codes are: 002, coordinates of the lathe
    /// 000 table 3-5.
    #[test]
    fn what_lies_in_no_code_is_listed_too() {
        let (td, mdi) = (ModelId::Gsk980td, ModelId::Gsk980mdi);
        let text = "G00 X20 Z2\nG01 X30 Z-20 F100\nM30\n";
        assert_eq!(
            list(text, td, mdi),
            [
                "1: X20: X is a diameter in GSK980TD and a distance in GSK980MDi: the path along X, its length and its feed change (2 blocks)"
            ]
        );
        assert_eq!(list(text, mdi, td).len(), 1);
        let kinds = |text, from, to| -> Vec<Difference> {
            let (from, to): (ModelId, ModelId) = (from, to);
            let all = compare_models(text, from.record(), to.record());
            let otherwise = all.into_iter().filter_map(|it| match it.difference {
                CodeDifference::Convention(difference, _) => Some(difference),
                _ => None,
            });
            otherwise.collect()
        };
        assert_eq!(
            kinds("G00 Z1\nG01 W-2\nT0101\nG03 Z5 R5\n", td, mdi),
            [
                Difference::Increments('W'),
                Difference::FirstFeed,
                Difference::Tool,
                Difference::Plane,
            ]
        );
        assert_eq!(kinds("G04 X1\nG01 Z1 F100\n", td, mdi), []);
        assert_eq!(
            kinds("G00 Y1\n#1=2\nM98 P5 L2\n", mdi, td),
            [
                Difference::Address('Y'),
                Difference::Macros,
                Difference::CallCount
            ]
        );
        let hx31 = ModelId::Hx31;
        assert_eq!(
            kinds("G01 Z20000 F12000\n", hx31, td),
            [
                Difference::Range('Z', "-9999.999~9999.999".to_owned()),
                Difference::Feed(12_000.0),
            ]
        );
        assert_eq!(
            kinds("S6000\n", td, hx31),
            [Difference::Range('S', "0~5000".to_owned())]
        );
        // S next to G50 is a speed limit on lathes that have this convention.
        assert!(!list("G50 S2000\n", td, mdi).is_empty());
        assert_eq!(list("G50 S2000\n", td, ModelId::Ncb08), [""; 0]);
    }

    #[test]
    fn a_code_is_rewritten_where_another_number_says_the_same() {
        let (td, mdi) = (ModelId::Gsk980td.record(), ModelId::Gsk980mdi.record());
        let text = "G50 X1 Z2;\nG98G01X5F100 (G50 STAYS);\nG90 X3;\n";
        assert_eq!(
            rewrite_program(text, td, mdi),
            "G92 X1 Z2;\nG94G01X5F100 (G50 STAYS);\nG90 X3;\n"
        );
    }

    #[test]
    fn the_same_program_for_the_same_model_is_the_same() {
        for id in ModelId::ALL {
            let every: String = (0..100)
                .map(|code| format!("G{code:02} M{code:02};\n"))
                .collect();
            let record = id.record();
            let findings = compare_models(&every, record, record);
            assert!(
                findings
                    .iter()
                    .all(|it| it.difference == CodeDifference::UnknownCode)
            );
            assert_eq!(rewrite_program(&every, record, record), every);
        }
    }

    #[test]
    fn arcs_differ_where_their_words_do() {
        let (td, nc, hx) = (ModelId::Gsk980td, ModelId::Ncb08, ModelId::Hx31);
        assert!(list("G02 X1 Z2 R5;", nc, td).is_empty());
        assert_eq!(list("G02 X1 Z2 R-5;", nc, td).len(), 1);
        assert!(list("G02 X1 Z2 K5;", td, hx).is_empty());
        assert_eq!(list("G02 X1 Z2 I1 K5;", td, hx).len(), 1);
        assert!(list("G04 X1;", td, nc).is_empty());
        assert_eq!(list("G04 X1 P5000;", td, nc).len(), 1);
    }

    #[test]
    fn strange_text_is_read_to_its_end() {
        for text in [
            "",
            "(",
            "G",
            "G-",
            "G99999999999 M",
            "中文 G92 (车",
            "G92.5",
            "#1=GT[2]",
        ] {
            let (td, hx) = (ModelId::Gsk980td.record(), ModelId::Hx31.record());
            compare_models(text, td, hx);
            rewrite_program(text, td, hx);
        }
    }
}
