//! A ladder that is being edited: its text, the compiler's messages, undo and redo.

use std::sync::Arc;

use gsk_core::plc::{CompileError, Ladder};

/// Maximum number of undo steps.
const MAX_UNDO_STEPS: usize = 200;

#[derive(Clone, Debug)]
pub struct LadderDraft {
    text: String,
    /// The ladder compiled from the last text without errors.
    ladder: Arc<Ladder>,
    errors: Vec<CompileError>,
    undo: Vec<String>,
    redo: Vec<String>,
    /// Number of the rung (0: the whole list) that was typed in by the last change; further
    /// changes with the same number belong to the same undo step. `None` after another change.
    last_typing: Option<u32>,
    /// The text that was saved last, or with which the draft began.
    saved_text: String,
}

impl LadderDraft {
    /// Starts a draft with the text of a ladder.
    pub fn new(ladder: &Arc<Ladder>) -> Self {
        Self {
            text: ladder.source().to_owned(),
            ladder: Arc::clone(ladder),
            errors: Vec::new(),
            undo: Vec::new(),
            redo: Vec::new(),
            last_typing: None,
            saved_text: ladder.source().to_owned(),
        }
    }

    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns the ladder compiled from the last text without errors.
    pub const fn ladder(&self) -> &Arc<Ladder> {
        &self.ladder
    }

    /// The compiler errors of the text; empty if it compiles.
    pub fn errors(&self) -> &[CompileError] {
        &self.errors
    }

    /// The compiler errors of the text, or its warnings if it compiles.
    pub fn findings(&self) -> &[CompileError] {
        if self.errors.is_empty() {
            self.ladder.warnings()
        } else {
            &self.errors
        }
    }

    /// Whether the text differs from the saved text.
    pub fn is_changed(&self) -> bool {
        self.text != self.saved_text
    }

    /// Marks the current text as saved.
    pub fn mark_saved(&mut self) {
        self.saved_text.clone_from(&self.text);
        self.last_typing = None;
    }

    /// Replaces the text. Consecutive changes with the same `typing`, the number of a rung or
    /// 0 for the whole list, are one undo step.
    pub fn set_text(&mut self, text: String, typing: Option<u32>) {
        if text == self.text {
            return;
        }
        let continues_typing = typing.is_some() && typing == self.last_typing;
        if !continues_typing {
            if self.undo.len() == MAX_UNDO_STEPS {
                self.undo.remove(0);
            }
            self.undo.push(self.text.clone());
        }
        self.redo.clear();
        self.last_typing = typing;
        self.compile(text);
    }

    /// Returns to the text before the last undo step.
    pub fn undo(&mut self) {
        if let Some(text) = self.undo.pop() {
            self.redo.push(self.text.clone());
            self.last_typing = None;
            self.compile(text);
        }
    }

    /// Repeats the step that was undone last.
    pub fn redo(&mut self) {
        if let Some(text) = self.redo.pop() {
            self.undo.push(self.text.clone());
            self.last_typing = None;
            self.compile(text);
        }
    }

    /// Returns whether undo is possible, and whether redo is possible.
    pub const fn can_undo_redo(&self) -> (bool, bool) {
        (!self.undo.is_empty(), !self.redo.is_empty())
    }

    fn compile(&mut self, text: String) {
        match Ladder::compile(&text) {
            Ok(ladder) => {
                self.ladder = Arc::new(ladder);
                self.errors.clear();
            }
            Err(errors) => self.errors = errors.errors,
        }
        self.text = text;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(rung: &str) -> String {
        format!("END1\n{rung}\nEND2\n")
    }

    #[test]
    fn steps_are_undone_and_redone() {
        let ladder = Ladder::compile(&text("LD R1.0\nOUT R2.0")).unwrap();
        let mut draft = LadderDraft::new(&Arc::new(ladder));
        assert!(!draft.is_changed());
        draft.set_text(text("LD R1.1\nOUT R2.0"), None);
        // Typing continues: one step.
        draft.set_text(text("LD R1.\nOUT R2.0"), Some(2));
        assert_eq!(draft.errors().len(), 1);
        assert_eq!(draft.ladder().source(), text("LD R1.1\nOUT R2.0"));
        draft.set_text(text("LD R1.7\nOUT R2.0"), Some(2));
        assert!(draft.errors().is_empty());
        draft.undo();
        assert_eq!(draft.text(), text("LD R1.1\nOUT R2.0"));
        draft.undo();
        assert_eq!(draft.can_undo_redo(), (false, true));
        assert!(!draft.is_changed());
        draft.redo();
        draft.redo();
        assert_eq!(draft.text(), text("LD R1.7\nOUT R2.0"));
        draft.mark_saved();
        assert!(!draft.is_changed());
        draft.undo();
        assert!(draft.is_changed());
    }
}
