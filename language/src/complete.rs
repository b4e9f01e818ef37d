//! Proposes completions at the cursor: codes of the model, letters of the code in force, and
//! existing blocks, programs and tools.

use std::collections::BTreeSet;

use crate::ReadingContext;
use crate::codes::{code_in_force, letters, snippet};
use crate::hover::{code_topic, escape_markdown, value_range};
use crate::meaning::{code_meaning, letter_meaning};
use crate::reference_target::{ReferenceTarget, reference_target};
use crate::structure::Structure;
use crate::text::{Position, TextDocument, TextRange};
use crate::words::{Span, SpanKind, block_at, spans};

/// The kind of text that a completion inserts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompletionKind {
    /// The completion inserts a G or M code.
    Code,
    /// The completion inserts the letter of a word.
    Letter,
    /// The completion inserts the number of an existing block or program.
    Target,
    /// The completion inserts a tool that the program calls elsewhere.
    Tool,
    /// The completion inserts a statement of macro B.
    Statement,
    /// The completion inserts the blocks of a cycle, with fields to fill in.
    Snippet,
}

/// A proposal to complete the word at the cursor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CompletionProposal {
    /// The text that the list of proposals shows.
    pub label: String,
    /// The kind of text that the proposal inserts.
    pub kind: CompletionKind,
    /// The meaning of the inserted text in one line.
    pub detail: String,
    /// A longer explanation in Markdown; may be empty.
    pub about: String,
    /// The text that replaces `range`. Fields of a snippet have the form `${1:…}` that editors
    /// use.
    pub insert: String,
    /// The range of the text that the proposal replaces.
    pub range: TextRange,
}

/// Returns the proposals at a position. `programs` contains the numbers of programs that can
/// be called.
pub fn complete(
    text: &TextDocument,
    structure: &Structure,
    at: Position,
    context: ReadingContext,
    programs: &BTreeSet<u16>,
) -> Vec<CompletionProposal> {
    let line = text.line(at.line);
    let spans = spans(line);
    let byte = line.floor_char_boundary((at.byte as usize).min(line.len()));
    let in_comment = |it: &Span| {
        let open = !line[it.range.clone()].ends_with([')', '）']);
        it.kind == SpanKind::Comment && it.range.start < byte && (byte < it.range.end || open)
    };
    if spans.iter().any(in_comment) {
        return Vec::new();
    }
    let before = &line[..byte];
    let digits = before.len()
        - before
            .trim_end_matches(|it: char| it.is_ascii_digit())
            .len();
    let head = &before[..byte - digits];
    let typed = head.chars().next_back().filter(char::is_ascii_alphabetic);
    let from = byte - digits - usize::from(typed.is_some());
    let mut site = CompletionSite {
        line,
        block: block_at(&spans, line, from),
        range: TextRange::new(at.line, &(from..byte)),
        context,
        found: Vec::new(),
    };
    match typed.map(|it| it.to_ascii_uppercase()) {
        Some(address @ ('G' | 'M')) => site.propose_codes(address),
        Some('T') => site.propose_tools(structure),
        Some(address @ ('P' | 'Q')) => site.propose_targets(structure, at, address, programs),
        Some(address) => {
            if digits == 0 {
                site.propose_letter(address);
            }
            if context.macro_b {
                site.propose_statements(address);
            }
        }
        None if digits > 0 => {}
        None => {
            let code = code_in_force(text, at.line, line, &site.block, context.model);
            let is_mill = context.model.is_mill();
            let none = || if is_mill { "XYZF" } else { "XZUWF" }.chars().collect();
            let letters: Vec<char> = code.map_or_else(none, |it| letters(it.code, is_mill));
            let others = "GMST".chars().filter(|it| !letters.contains(it));
            for address in letters.iter().copied().chain(others) {
                site.propose_letter(address);
            }
        }
    }
    site.found
}

/// Collects the proposals for a position: its line, its block and the range to replace.
struct CompletionSite<'a> {
    line: &'a str,
    block: Vec<Span>,
    range: TextRange,
    context: ReadingContext,
    found: Vec<CompletionProposal>,
}

impl CompletionSite<'_> {
    fn push(&mut self, label: String, kind: CompletionKind, detail: String, about: String) {
        self.found.push(CompletionProposal {
            insert: label.clone(),
            label,
            kind,
            detail,
            about,
            range: self.range.clone(),
        });
    }

    /// Proposes the G or M codes (`address`) of the control model.
    fn propose_codes(&mut self, address: char) {
        let record = self.context.model.record();
        let numbers: Vec<u8> = match address {
            'G' => record.g.keys().copied().collect(),
            _ => record.m.keys().copied().collect(),
        };
        for number in numbers {
            let Some(meaning) = code_meaning(address, number.into(), self.context.model) else {
                continue;
            };
            let detail = meaning.text(self.context.language);
            let topic = code_topic(self.context.model, address, number.into());
            let about = topic.map_or("", |topic| topic.rule(self.context.language));
            let (label, about) = (format!("{address}{number:02}"), escape_markdown(about));
            self.push(
                label.clone(),
                CompletionKind::Code,
                detail.clone(),
                about.clone(),
            );
            let code = record.g_code(number.into()).filter(|_| address == 'G');
            let is_mill = self.context.model.is_mill();
            if let Some(snippet) = code.and_then(|it| snippet(it, is_mill)) {
                self.push(format!("{label} …"), CompletionKind::Snippet, detail, about);
                if let Some(last) = self.found.last_mut() {
                    snippet.clone_into(&mut last.insert);
                }
            }
        }
    }

    fn propose_letter(&mut self, address: char) {
        if let Some(meaning) = letter_meaning(address, self.context.model) {
            let language = self.context.language;
            let about = if self.context.model.is_mill() {
                String::new()
            } else {
                value_range(address, language)
            };
            let meaning = meaning.text(language);
            self.push(address.to_string(), CompletionKind::Letter, meaning, about);
        } else if matches!(address, 'G' | 'M') {
            let label = address.to_string();
            self.push(label, CompletionKind::Letter, String::new(), String::new());
        }
    }

    fn propose_tools(&mut self, structure: &Structure) {
        self.propose_letter('T');
        let values: BTreeSet<&str> = structure.tools.iter().map(|it| it.value.as_str()).collect();
        for value in values {
            let detail = letter_meaning('T', self.context.model)
                .map_or(String::new(), |it| it.text(self.context.language));
            self.push(
                format!("T{value}"),
                CompletionKind::Tool,
                detail,
                String::new(),
            );
        }
    }

    /// Proposes the numbers of existing blocks or programs for P and Q.
    fn propose_targets(
        &mut self,
        structure: &Structure,
        at: Position,
        address: char,
        programs: &BTreeSet<u16>,
    ) {
        self.propose_letter(address);
        // The block determines the target of the word with any number, so try it with 1.
        let mut with_number = String::from(self.line.get(..self.range.from as usize).unwrap_or(""));
        let from = with_number.len();
        with_number.push(address);
        with_number.push('1');
        let own = Span {
            range: from..with_number.len(),
            kind: SpanKind::Other,
        };
        let rest = self.line.get(self.range.to as usize..).unwrap_or("");
        with_number.push_str(rest);
        let grown = with_number.len() as i64 - self.line.len() as i64;
        let mut block: Vec<Span> = Vec::new();
        for span in &self.block {
            let moved = |at: usize| (at as i64 + grown) as usize;
            match () {
                () if span.range.end <= self.range.from as usize => block.push(span.clone()),
                () if span.range.start >= self.range.to as usize => block.push(Span {
                    range: moved(span.range.start)..moved(span.range.end),
                    kind: span.kind,
                }),
                () => {}
            }
        }
        block.push(own.clone());
        let part = structure.part_at_line(at.line);
        match reference_target(&with_number, &block, &own) {
            Some((ReferenceTarget::Program(_), _)) => {
                let here = structure.parts.iter().filter_map(|it| it.number);
                let mut numbers: BTreeSet<u16> = here.chain(programs.iter().copied()).collect();
                let naming = self.context.model.record().program_naming();
                let own = structure.parts.get(part).and_then(|it| it.number);
                numbers.retain(|number| Some(*number) != own);
                for number in numbers {
                    let label = format!("P{number:04}");
                    self.push(
                        label,
                        CompletionKind::Target,
                        naming.name(number),
                        String::new(),
                    );
                }
            }
            Some((ReferenceTarget::Block(_), _)) => {
                let blocks = structure.blocks.iter().filter(|it| it.part == part);
                let numbers: BTreeSet<u16> = blocks.map(|it| it.number).collect();
                for number in numbers {
                    let label = format!("{address}{number}");
                    self.push(
                        label,
                        CompletionKind::Target,
                        format!("N{number}"),
                        String::new(),
                    );
                }
            }
            _ => {}
        }
    }

    /// Proposes the statements of macro B that begin with the letter `first`.
    fn propose_statements(&mut self, first: char) {
        const STATEMENTS: [&str; 4] = [
            "IF [${1:#1 GT 0}] GOTO ${2:10}",
            "WHILE [${1:#1 LT 10}] DO ${2:1}\n${0}\nEND ${2:1}",
            "GOTO ${1:10}",
            "END ${1:1}",
        ];
        for text in STATEMENTS.into_iter().filter(|it| it.starts_with(first)) {
            let label = text.split(' ').next().unwrap_or(text).to_owned();
            self.push(
                label,
                CompletionKind::Statement,
                String::new(),
                String::new(),
            );
            if let Some(last) = self.found.last_mut() {
                text.clone_into(&mut last.insert);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CONTEXT;
    use gsk_core::model::ModelId;

    fn labels(text: &str, line: u32, byte: u32, context: ReadingContext) -> Vec<String> {
        let text = TextDocument::new(text);
        let structure = Structure::read(&text);
        let programs = BTreeSet::from([31]);
        let at = Position { line, byte };
        let found = complete(&text, &structure, at, context, &programs);
        found.into_iter().map(|it| it.label).collect()
    }

    #[test]
    fn codes_are_those_of_the_model() {
        let found = labels("N10 G", 0, 5, CONTEXT);
        assert!(found.contains(&"G71".to_owned()) && found.contains(&"G71 …".to_owned()));
        assert!(!found.contains(&"G81".to_owned()));
        let huaxing = ReadingContext {
            model: ModelId::Hx31,
            ..CONTEXT
        };
        assert!(labels("N10 G8", 0, 6, huaxing).contains(&"G81".to_owned()));
        assert!(labels("M", 0, 1, CONTEXT).contains(&"M30".to_owned()));
        assert!(labels("(G", 0, 2, CONTEXT).is_empty(), "in a comment");
        assert!(labels("(a) G", 0, 5, CONTEXT).contains(&"G00".to_owned()));
    }

    #[test]
    fn words_and_cycles_of_a_mill_are_its_own() {
        let mill = ReadingContext {
            model: ModelId::Gsk980mdi,
            macro_b: true,
            ..CONTEXT
        };
        let codes = labels("G8", 0, 2, mill);
        assert!(codes.contains(&"G83".to_owned()) && codes.contains(&"G83 …".to_owned()));
        assert!(!codes.contains(&"G71".to_owned()));
        assert_eq!(labels("G83 ", 0, 4, mill)[..4], ["X", "Y", "Z", "R"]);
        assert_eq!(labels("G83 X1\nX2 ", 1, 3, mill)[..4], ["X", "Y", "Z", "R"]);
        assert_eq!(labels("G02 ", 0, 4, mill)[3..7], ["I", "J", "K", "R"]);
        assert_eq!(labels("W", 0, 1, mill), ["W", "WHILE"]);
    }

    #[test]
    fn words_are_those_of_the_code_in_force() {
        assert_eq!(labels("G04 ", 0, 4, CONTEXT)[..3], ["P", "X", "U"]);
        assert_eq!(labels("G90 X20 Z-5 F100\nX19 ", 1, 4, CONTEXT)[4], "R");
        assert_eq!(labels("G01 X", 0, 5, CONTEXT), ["X"]);
        assert!(labels("G01 X20", 0, 7, CONTEXT).is_empty());
    }

    #[test]
    fn targets_and_tools_are_those_that_are_there() {
        let text = "O0001\nT0101\nG71 P\nN10 G0 X1\nM98 P\nT\nG71 P10 Q\nG4 P\nO0002\nM99\n";
        assert_eq!(labels(text, 2, 5, CONTEXT), ["P", "P10"]);
        assert_eq!(labels(text, 4, 5, CONTEXT), ["P", "P0002", "P0031"]);
        assert_eq!(labels(text, 5, 1, CONTEXT), ["T", "T0101"]);
        assert_eq!(labels(text, 6, 9, CONTEXT), ["Q", "Q10"]);
        assert_eq!(labels(text, 7, 4, CONTEXT), ["P"]);
    }

    #[test]
    fn a_snippet_replaces_the_typed_text() {
        let text = TextDocument::new("g7");
        let at = Position { line: 0, byte: 2 };
        let found = complete(
            &text,
            &Structure::read(&text),
            at,
            CONTEXT,
            &BTreeSet::new(),
        );
        let cycle = found.iter().find(|it| it.label == "G71 …").expect("G71");
        assert_eq!((cycle.range.from, cycle.range.to), (0, 2));
        assert!(
            cycle
                .insert
                .starts_with("G71 U${1:2.0} R${2:1.0}\nG71 P${3:10}")
        );
    }
}
