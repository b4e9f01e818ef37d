//! Finds the code that reads the words of a block, and the modal codes in force above a line.

use gsk_core::model::{GCode, ModelId};

use super::snippets::is_hole_cycle;
use super::word_table::{CodeForm, code_forms, form_index, function_form};
use crate::text::TextDocument;
use crate::words::{Span, SpanKind, spans, word_of};

/// Greatest number of lines above a block that are searched for the codes in force.
const MAX_LINES_ABOVE: u32 = 2000;

/// A code that reads the words of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CodeInForce {
    /// Meaning of the code on the model.
    pub code: GCode,
    /// Number of the code as written.
    pub number: u32,
    /// Index of the line with the code, from 0.
    pub line: u32,
}

/// Returns the G code that determines which words can follow in a block of the line `index`:
/// that of the block, else the motion in force. `None` if no code is found.
pub(crate) fn code_in_force(
    text: &TextDocument,
    index: u32,
    line: &str,
    block: &[Span],
    model: ModelId,
) -> Option<CodeInForce> {
    let own = codes_of(line, block, model).last();
    let own = own.map(|(code, number)| CodeInForce {
        code,
        number,
        line: index,
    });
    own.or_else(|| {
        let above = index.saturating_sub(MAX_LINES_ABOVE)..index;
        above.rev().find_map(|above| {
            let line = text.line(above);
            let spans = spans(line);
            let (code, number) = codes_of(line, &spans, model)
                .filter(|(code, _)| is_motion(*code))
                .last()?;
            Some(CodeInForce {
                code,
                number,
                line: above,
            })
        })
    })
}

/// The G codes of a block that the model has, each with its number.
fn codes_of(line: &str, block: &[Span], model: ModelId) -> impl Iterator<Item = (GCode, u32)> {
    let record = model.record();
    let codes = block.iter().filter(|it| it.kind == SpanKind::Code);
    let numbers = codes.filter_map(move |it| word_of(line, it)?.number());
    numbers.filter_map(|number| Some((record.g_code(number.into())?, number)))
}

/// The code that reads the words of a block, and the words that it reads.
#[derive(Clone, Debug)]
pub(crate) struct BlockForm {
    /// The code, such as `G71`.
    pub name: String,
    /// Index of the line with the code, from 0.
    pub line: u32,
    /// The blocks of the code; empty if the table does not describe them.
    pub forms: &'static [CodeForm],
    /// Index of the form of this block.
    pub index: usize,
}

impl BlockForm {
    /// Finds the code that reads the words of a block of the line `index`; `None` without one.
    pub(crate) fn find(
        text: &TextDocument,
        index: u32,
        block: &[Span],
        model: ModelId,
    ) -> Option<Self> {
        let line = text.line(index);
        if let Some((number, forms)) = function_of(line, block) {
            return Some(Self {
                name: format!("M{number:02}"),
                line: index,
                forms,
                index: 0,
            });
        }
        let found = code_in_force(text, index, line, block, model)?;
        let forms = match model.is_mill() {
            true => &[],
            false => code_forms(found.code),
        };
        let before = (forms.len() > 1)
            .then(|| form_above(text, index, found.code, model))
            .flatten();
        Some(Self {
            name: format!("G{:02}", found.number),
            line: found.line,
            forms,
            index: form_index(forms, letters_of(line, block), before),
        })
    }

    /// The words of the block; empty if the table does not describe them.
    pub(crate) fn form(&self) -> CodeForm {
        self.forms.get(self.index).copied().unwrap_or_default()
    }
}

/// The M code of a block that reads words, with its form.
fn function_of(line: &str, block: &[Span]) -> Option<(u32, &'static [CodeForm])> {
    let functions = block.iter().filter(|it| it.kind == SpanKind::Function);
    let mut numbers = functions.filter_map(|it| word_of(line, it)?.number());
    numbers.find_map(|number| Some((number, function_form(number)?)))
}

/// The index of the form of a code in the next line above that has a code; `None` if that is
/// another code.
fn form_above(text: &TextDocument, index: u32, code: GCode, model: ModelId) -> Option<usize> {
    let above = (index.saturating_sub(MAX_LINES_ABOVE)..index).rev();
    let (line, spans) = above
        .map(|above| (text.line(above), spans(text.line(above))))
        .find(|(line, spans)| codes_of(line, spans, model).next().is_some())?;
    let is_same = codes_of(line, &spans, model).any(|(above, _)| above == code);
    is_same.then(|| form_index(code_forms(code), letters_of(line, &spans), None))
}

fn letters_of(line: &str, block: &[Span]) -> impl Iterator<Item = char> {
    // A letter alone is a word that is being typed.
    block
        .iter()
        .filter(|it| it.kind.is_word() || it.kind == SpanKind::Foreign)
        .filter_map(|it| line.get(it.range.clone())?.chars().next())
        .map(|letter| letter.to_ascii_uppercase())
}

/// The modal codes in force at a line, with the index of the line (from 0) that sets each;
/// `None` for those that no line above sets.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct ModalCodes {
    /// The code of group 01: motion, G90, G92 or G94.
    pub motion: Option<(u32, u32)>,
    /// Group 03: G98 or G99.
    pub feed: Option<(u32, u32)>,
    /// Group 02: G96 or G97.
    pub speed: Option<(u32, u32)>,
    /// Digits of the last T word.
    pub tool: Option<(String, u32)>,
}

impl ModalCodes {
    /// Searches the lines above `index` for the modal codes in force there, at most back to
    /// the line `first`. Calls and jumps are not followed.
    pub(crate) fn above(text: &TextDocument, first: u32, index: u32, model: ModelId) -> Self {
        let mut found = Self::default();
        let least = index.saturating_sub(MAX_LINES_ABOVE).max(first);
        for above in (least..index).rev() {
            let mut line = Self::default();
            line.read_line(text, above, model);
            found = Self {
                motion: found.motion.or(line.motion),
                feed: found.feed.or(line.feed),
                speed: found.speed.or(line.speed),
                tool: found.tool.or(line.tool),
            };
            if found.is_complete() {
                break;
            }
        }
        found
    }

    /// Updates the codes by those of a line.
    pub(crate) fn read_line(&mut self, text: &TextDocument, index: u32, model: ModelId) {
        let line = text.line(index);
        // Most lines of a long program have coordinates only.
        if !line.contains(['G', 'g', 'T', 't', 'Ｇ', 'Ｔ', 'ｇ', 'ｔ']) {
            return;
        }
        let spans = spans(line);
        for (code, number) in codes_of(line, &spans, model) {
            match code {
                GCode::FeedPerMinute | GCode::FeedPerRevolution => {
                    self.feed = Some((number, index));
                }
                GCode::SurfaceSpeed | GCode::SpindleSpeed => self.speed = Some((number, index)),
                code if is_motion(code) => self.motion = Some((number, index)),
                _ => {}
            }
        }
        let settings = spans.iter().filter(|it| it.kind == SpanKind::Setting);
        let mut words = settings.filter_map(|it| word_of(line, it));
        if let Some(tool) = words.rfind(|word| word.address == 'T') {
            self.tool = Some((tool.value.into_owned(), index));
        }
    }

    const fn is_complete(&self) -> bool {
        self.motion.is_some() && self.feed.is_some() && self.speed.is_some() && self.tool.is_some()
    }
}

/// Whether a G code belongs to group 01, so that it remains in force in the next blocks.
pub(crate) const fn is_motion(code: GCode) -> bool {
    matches!(
        code,
        GCode::Rapid
            | GCode::StraightRapid
            | GCode::Line
            | GCode::ArcClockwise
            | GCode::ArcCounterclockwise
            | GCode::PlaneArcClockwise
            | GCode::PlaneArcCounterclockwise
            | GCode::Thread
            | GCode::VariableThread
            | GCode::TurningCycle
            | GCode::ThreadCycle
            | GCode::FacingCycle
    ) || is_hole_cycle(code)
}
