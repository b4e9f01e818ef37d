//! A ladder that is being edited: its text, the compiler's messages, undo and redo.

use std::sync::Arc;

use gsk_core::plc::{CompileError, Ladder};

/// Greatest number of undo steps.
const UNDO: usize = 200;

#[derive(Clone, Debug)]
pub struct Draft {
    text: String,
    /// The last ladder that compiled.
    ladder: Arc<Ladder>,
    errors: Vec<CompileError>,
    undo: Vec<String>,
    redo: Vec<String>,
    /// What was typed into by the last change. Further changes to the same are one undo step.
    last: Option<u32>,
    /// The text that was saved or begun with.
    saved: String,
}

impl Draft {
    /// Starts a draft with a ladder.
    pub fn new(ladder: &Arc<Ladder>) -> Self {
        Self {
            text: ladder.source().to_owned(),
            ladder: Arc::clone(ladder),
            errors: Vec::new(),
            undo: Vec::new(),
            redo: Vec::new(),
            last: None,
            saved: ladder.source().to_owned(),
        }
    }

    pub fn text(&self) -> &str {
        &self.text
    }

    /// The ladder of the last text that compiled.
    pub const fn ladder(&self) -> &Arc<Ladder> {
        &self.ladder
    }

    /// The compiler errors of the text; empty if it compiles.
    pub fn errors(&self) -> &[CompileError] {
        &self.errors
    }

    /// The compiler errors, or the warnings of a text that compiles.
    pub fn findings(&self) -> &[CompileError] {
        if self.errors.is_empty() {
            self.ladder.warnings()
        } else {
            &self.errors
        }
    }

    /// Whether the text differs from the saved one.
    pub fn is_changed(&self) -> bool {
        self.text != self.saved
    }

    /// Marks the current text as saved.
    pub fn saved(&mut self) {
        self.saved.clone_from(&self.text);
        self.last = None;
    }

    /// Replaces the text. Consecutive changes with the same `typing` are one undo step.
    pub fn set(&mut self, text: String, typing: Option<u32>) {
        if text == self.text {
            return;
        }
        let goes_on = typing.is_some() && typing == self.last;
        if !goes_on {
            if self.undo.len() == UNDO {
                self.undo.remove(0);
            }
            self.undo.push(self.text.clone());
        }
        self.redo.clear();
        self.last = typing;
        self.put(text);
    }

    /// Undoes a step.
    pub fn undo(&mut self) {
        if let Some(text) = self.undo.pop() {
            self.redo.push(self.text.clone());
            self.last = None;
            self.put(text);
        }
    }

    /// Redoes a step.
    pub fn redo(&mut self) {
        if let Some(text) = self.redo.pop() {
            self.undo.push(self.text.clone());
            self.last = None;
            self.put(text);
        }
    }

    /// Whether undo and redo are possible.
    pub const fn steps(&self) -> (bool, bool) {
        (!self.undo.is_empty(), !self.redo.is_empty())
    }

    fn put(&mut self, text: String) {
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
    fn steps_are_taken_back_and_again() {
        let ladder = Ladder::compile(&text("LD R1.0\nOUT R2.0")).unwrap();
        let mut draft = Draft::new(&Arc::new(ladder));
        assert!(!draft.is_changed());
        draft.set(text("LD R1.1\nOUT R2.0"), None);
        // Typing continues: one step.
        draft.set(text("LD R1.\nOUT R2.0"), Some(2));
        assert_eq!(draft.errors().len(), 1);
        assert_eq!(draft.ladder().source(), text("LD R1.1\nOUT R2.0"));
        draft.set(text("LD R1.7\nOUT R2.0"), Some(2));
        assert!(draft.errors().is_empty());
        draft.undo();
        assert_eq!(draft.text(), text("LD R1.1\nOUT R2.0"));
        draft.undo();
        assert_eq!(draft.steps(), (false, true));
        assert!(!draft.is_changed());
        draft.redo();
        draft.redo();
        assert_eq!(draft.text(), text("LD R1.7\nOUT R2.0"));
        draft.saved();
        assert!(!draft.is_changed());
        draft.undo();
        assert!(draft.is_changed());
    }
}
