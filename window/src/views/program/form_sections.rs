//! Puts the sections of forms into the program text, and opens the form of a section.

use egui::{Context, Ui};
use gsk_forms::{FormSection, find_sections, whole_program};
use gsk_messages::{Language, say};

use super::document::ProgramDocument;
use crate::views::form::FormRequest;

use super::{EditorMessage, ProgramView, TextToLoad, editor};

/// Words of the block that ends a program.
const PROGRAM_ENDS: [&str; 3] = ["M30", "M99", "%"];

impl ProgramView {
    /// The section of a form in which the cursor is; `None` if it is in none.
    pub(super) fn cursor_section(&mut self, context: &Context) -> Option<&FormSection> {
        let line = self.cursor_line(context)?;
        let (revision, text) = (self.document.revision, &self.document.text);
        self.sections.section_at(revision, text, line)
    }

    /// The line of the cursor, from 0; `None` without a cursor.
    fn cursor_line(&self, context: &Context) -> Option<usize> {
        let cursor = editor::cursor_range(context)?.start;
        let byte = self.document.byte_of_character(cursor);
        Some(self.document.line_at(byte))
    }

    /// Opens the form of the section at the cursor, or a form for a new section.
    pub(super) fn open_form(&mut self, context: &Context) {
        let section = self.cursor_section(context).cloned();
        let text = self.document.text.clone();
        match section {
            None => self.form.open_new(&text),
            Some(section) => {
                if let Err(error) = self.form.open_section(&text, &section) {
                    self.message = Some(EditorMessage::Bad(error.message()));
                }
            }
        }
    }

    /// Draws the open form and carries out its request.
    pub(super) fn show_form(&mut self, ui: &mut Ui, language: Language) {
        match self.form.show(ui, language) {
            Some(FormRequest::Insert(section)) => {
                let at = insert_position(&self.document, self.cursor_line(ui.ctx()));
                self.insert_section(at, &section);
                self.message = Some(EditorMessage::Good(say::form_inserted()));
            }
            Some(FormRequest::Replace { old, new }) => match self.document.text.find(&old) {
                Some(at) => {
                    self.document.text.replace_range(at..at + old.len(), "");
                    self.insert_section(at, &new);
                    self.message = Some(EditorMessage::Good(say::form_replaced()));
                }
                None => self.form.report(say::form_section_gone()),
            },
            Some(FormRequest::NewProgram(section)) => {
                let stored = self.last_check.as_ref();
                let stored = stored.map_or(&[][..], |checked| &checked.stored_programs);
                let number = (1..9_000).find(|number| !stored.contains(number));
                let text = whole_program(number.unwrap_or(1), &section);
                let notice = say::form_in_lathe();
                self.text_to_load = Some(TextToLoad::NewProgram { text, notice });
                self.form.close();
            }
            None => {}
        }
        self.show_unsaved_question(ui.ctx(), language);
    }

    /// Inserts a section at a byte of the text, shows it, and closes the form.
    fn insert_section(&mut self, at: usize, section: &str) {
        let text = &mut self.document.text;
        let needs_line_end = at > 0 && !text[..at].ends_with('\n');
        let begin = at + usize::from(needs_line_end);
        if needs_line_end {
            text.insert(at, '\n');
        }
        text.insert_str(begin, section);
        self.document.update_after_change();
        self.select_bytes(&(begin..begin + section.trim_end().len()));
        self.form.close();
    }
}

/// The byte at which a section is inserted: at an empty line with the cursor, else after the
/// line of the cursor or after the section of another form, and always before the end of the
/// program.
fn insert_position(document: &ProgramDocument, cursor_line: Option<usize>) -> usize {
    let count = document.line_count();
    let is_end = |line: usize| {
        let text = document.line(line).trim();
        text.is_empty() || PROGRAM_ENDS.iter().any(|word| text.contains(word))
    };
    // The first of the last lines that end the program or are empty.
    let end = (0..count).rev().take_while(|line| is_end(*line)).last();
    let end = end.unwrap_or(count);
    let sections = find_sections(&document.text);
    let line = cursor_line.map_or(end, |line| {
        match sections.iter().find(|it| it.lines.contains(&line)) {
            Some(section) => section.lines.end,
            None if document.line(line).trim().is_empty() => line,
            None => line + 1,
        }
    });
    let line = line.min(end);
    if line < count {
        document.line_start(line)
    } else {
        document.text.len()
    }
}
