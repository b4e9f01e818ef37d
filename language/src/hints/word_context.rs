//! The meaning of a word in its block: by the code that reads it, by its value and by the
//! modal codes in force.

use gsk_core::model::ModelId;
use gsk_messages::{Message, say};

use crate::codes::{BlockForm, ModalCodes, find_word};
use crate::text::TextDocument;
use crate::words::{ParsedWord, Span};

/// The meaning of a word in its block.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct WordContext {
    /// The code that reads the word, and the letter of the word: `G92 K`.
    pub name: String,
    /// The meaning of the word for the code, with its unit.
    pub meaning: Message,
    /// The parts of the value, and the modal codes on which the meaning depends.
    pub remarks: Vec<Message>,
}

/// Returns the meaning of a word in a block of the line `index`; `None` if the table of codes
/// does not describe it.
pub(crate) fn word_context(
    text: &TextDocument,
    index: u32,
    block: &[Span],
    word: &ParsedWord<'_>,
    model: ModelId,
) -> Option<WordContext> {
    let form = BlockForm::find(text, index, block, model)?;
    let name = format!("{} {}", form.name, word.address);
    if form.name == "M98" && word.address == 'L' {
        return Some(WordContext {
            name,
            meaning: say::hover_call_no_count(),
            remarks: Vec::new(),
        });
    }
    let found = find_word(form.form(), word.address)?;
    let mut remarks: Vec<Message> = value_parts(&form, word).into_iter().collect();
    if form.line != index {
        remarks.push(say::hover_code_in_force(&form.name, form.line + 1));
    }
    remarks.extend(unit_in_force(text, index, word.address, &form, model));
    Some(WordContext {
        name,
        meaning: (found.meaning)(),
        remarks,
    })
}

/// The parts of a value that has several: P of G76 and of M98.
fn value_parts(form: &BlockForm, word: &ParsedWord<'_>) -> Option<Message> {
    let number = word.number()?;
    match (form.name.as_str(), word.address) {
        ("G76", 'P') if form.index == 0 => {
            let (passes, run_out, angle) = (number / 10_000, number / 100 % 100, number % 100);
            let leads = format!("{}.{}", run_out / 10, run_out % 10);
            Some(say::hover_thread_data(passes, leads, angle))
        }
        ("M98", 'P') => {
            let count = (number / 10_000).max(1);
            let program = format!("{:04}", number % 10_000);
            Some(say::hover_call_count(program, count))
        }
        _ => None,
    }
}

/// The tool and the offset of a T word; `None` for a variable.
pub(crate) fn tool_parts(word: &ParsedWord<'_>) -> Option<Message> {
    let number = word.number()?;
    let (tool, offset) = (number / 100, number % 100);
    let two_digits = |number: u32| format!("{number:02}");
    Some(match offset {
        0 => say::hover_tool_no_offset(two_digits(tool)),
        _ => say::hover_tool_offset(two_digits(tool), two_digits(offset)),
    })
}

/// The modal code that sets the unit of a feed or a spindle speed, if a line above has it.
fn unit_in_force(
    text: &TextDocument,
    index: u32,
    address: char,
    form: &BlockForm,
    model: ModelId,
) -> Option<Message> {
    let is_lead = matches!(form.name.as_str(), "G32" | "G33" | "G34" | "G76" | "G92");
    let is_limit = form.name == "G50";
    if !matches!(address, 'F' | 'S') || is_lead || is_limit {
        return None;
    }
    // The codes of the block itself count, too.
    let modal = ModalCodes::above(text, 0, index.saturating_add(1), model);
    let (number, line) = match address {
        'F' => modal.feed?,
        _ => modal.speed?,
    };
    let code = format!("G{number:02}");
    (code != form.name).then(|| say::hover_code_in_force(code, line + 1))
}
