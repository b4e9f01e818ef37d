//! A ladder in the making: its text, what the compiler says, undo and redo.

use std::sync::Arc;

use gsk_core::plc::{CompileError, Ladder};

/// Steps that can be taken back.
const UNDO: usize = 200;

/// A ladder being edited.
#[derive(Clone, Debug)]
pub struct Draft {
    text: String,
    /// The last text that compiled.
    ladder: Arc<Ladder>,
    errors: Vec<CompileError>,
    undo: Vec<String>,
    redo: Vec<String>,
    /// What the last change was to: further ones to the same are one step.
    last: Option<u32>,
    /// The text that was saved or begun with.
    saved: String,
}

impl Draft {
    /// Begins with a ladder.
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

    /// The text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The last text that compiled.
    pub const fn ladder(&self) -> &Arc<Ladder> {
        &self.ladder
    }

    /// Why the text does not compile.
    pub fn errors(&self) -> &[CompileError] {
        &self.errors
    }

    /// What the compiler says: errors, or the warnings of a text that compiles.
    pub fn findings(&self) -> &[CompileError] {
        if self.errors.is_empty() {
            self.ladder.warnings()
        } else {
            &self.errors
        }
    }

    /// Whether there is something to be saved.
    pub fn is_changed(&self) -> bool {
        self.text != self.saved
    }

    /// It was saved.
    pub fn saved(&mut self) {
        self.saved.clone_from(&self.text);
        self.last = None;
    }

    /// Takes a new text. Changes of one `typing` in a row are one step for undo.
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

    /// Takes a step back.
    pub fn undo(&mut self) {
        if let Some(text) = self.undo.pop() {
            self.redo.push(self.text.clone());
            self.last = None;
            self.put(text);
        }
    }

    /// Takes a step again.
    pub fn redo(&mut self) {
        if let Some(text) = self.redo.pop() {
            self.undo.push(self.text.clone());
            self.last = None;
            self.put(text);
        }
    }

    /// Whether a step can be taken back, and taken again.
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
        // Typing goes on: one step.
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
