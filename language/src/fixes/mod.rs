//! Quick fixes: the edits that remove the cause of a warning or an alarm, where one edit is
//! right.

mod foreign_code;
mod line_edit;
mod lint_fix;
#[cfg(test)]
mod tests;

pub(crate) use foreign_code::alarm_fixes;
pub(crate) use lint_fix::{caution_fix, mill_word_fix};

use gsk_messages::{Language, Message};

use crate::text::TextChange;

/// An edit that removes the cause of a finding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct QuickFix {
    /// The edit in words, for the menu of an editor.
    pub title: String,
    /// Changes of the text, which do not overlap.
    pub changes: Vec<TextChange>,
}

impl QuickFix {
    fn new(title: &Message, changes: Vec<TextChange>, language: Language) -> Self {
        Self {
            title: title.text(language),
            changes,
        }
    }
}
