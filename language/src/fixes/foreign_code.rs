//! The quick fixes of alarms about words of other controls.

use gsk_core::alarm::{Alarm, number};
use gsk_core::dialect::{ForeignWordEdit, edit_for_g_code, edit_for_m_code};
use gsk_core::model::ModelRecord;
use gsk_messages::{Language, say};

use super::QuickFix;
use super::line_edit::EditedLine;
use crate::words::{ParsedWord, Span};

/// Returns the fixes of an alarm about the line `number` (from 1) with the text `text`: one for
/// each foreign word with a certain equivalent, or one for the whole block.
pub(crate) fn alarm_fixes(
    alarm: &Alarm,
    (number, text): (u32, &str),
    record: &ModelRecord,
    language: Language,
) -> Vec<QuickFix> {
    let line = EditedLine::new(number, text);
    match alarm.number {
        number::BAD_CHARACTER => decimal_point(alarm, &line, language).into_iter().collect(),
        number::BAD_ADDRESS | number::BAD_G | number::BAD_M => {
            match two_blocks(alarm, &line, language) {
                Some(fix) => vec![fix],
                None => foreign_words(&line, record, language),
            }
        }
        _ => Vec::new(),
    }
}

/// The fixes of the words of a line that the model does not have.
fn foreign_words(line: &EditedLine<'_>, record: &ModelRecord, language: Language) -> Vec<QuickFix> {
    let fix = |(span, word): (&Span, ParsedWord<'_>)| {
        let edit = word_edit(&word, record)?;
        let written = format!("{}{}", word.address, word.value);
        Some(match edit {
            WordEdit::Delete => QuickFix::new(
                &say::fix_delete_word(written),
                vec![line.delete(span)],
                language,
            ),
            WordEdit::Replace(text) => QuickFix::new(
                &say::fix_replace(&text),
                vec![line.replace(span, text)],
                language,
            ),
        })
    };
    line.words().filter_map(fix).collect()
}

/// The edit of a word.
enum WordEdit {
    Delete,
    Replace(String),
}

fn word_edit(word: &ParsedWord<'_>, record: &ModelRecord) -> Option<WordEdit> {
    let number = word.number();
    let edit = match (word.address, number) {
        // The lead of a thread, in mm as F.
        ('E', _) => return Some(WordEdit::Replace(format!("F{}", word.value))),
        ('G', Some(code)) if record.g_code(code.into()).is_none() => edit_for_g_code(code)?,
        ('M', Some(code)) => {
            let known = u8::try_from(code).is_ok_and(|it| record.m_function(it).is_some());
            edit_for_m_code(code).filter(|_| !known)?
        }
        _ => return None,
    };
    Some(match edit {
        ForeignWordEdit::Delete => WordEdit::Delete,
        ForeignWordEdit::Replace(text) => WordEdit::Replace(text.to_owned()),
    })
}

/// The fix of a cycle in one block: the two blocks that the advice of the alarm contains.
fn two_blocks(alarm: &Alarm, line: &EditedLine<'_>, language: Language) -> Option<QuickFix> {
    let detail = alarm.detail.as_ref()?;
    let (first, second) = (detail.find_value("first")?, detail.find_value("second")?);
    if !first.starts_with('G') || !second.starts_with('G') || !line.is_one_block() {
        return None;
    }
    let name = line.word('N').map(|(_, word)| format!("N{} ", word.value));
    let name = name.unwrap_or_default();
    let blocks = format!("{name}{first}\n{second}");
    Some(QuickFix::new(
        &say::fix_two_blocks(),
        vec![line.replace_all(blocks)],
        language,
    ))
}

/// The fix of a decimal comma.
fn decimal_point(alarm: &Alarm, line: &EditedLine<'_>, language: Language) -> Option<QuickFix> {
    let detail = alarm.detail.as_ref()?;
    let number = detail.find_value("number")?;
    let column: u32 = detail.find_value("column")?.parse().ok()?;
    let comma = line.span_at_column(column)?;
    Some(QuickFix::new(
        &say::fix_replace(number),
        vec![line.replace(comma, ".")],
        language,
    ))
}
