//! Shows a halt, the last message of the program view, the findings of the check, and the
//! question about an unsaved text.

use egui::{Context, RichText, ScrollArea, Ui};
use gsk_messages::{Language, say};

use super::document::{TextOrigin, file_name};
use super::{EditorMessage, ProgramView, TextToLoad, bar, document};
use crate::focus;
use crate::theme;
use crate::widgets::status_message::not_stored_reason;

impl ProgramView {
    /// Draws a halt, the last message and the findings of the check.
    pub(super) fn show_findings(&mut self, ui: &mut Ui, language: Language) {
        self.breakpoints.show_halt(ui, language);
        let shown_message = self.message.as_ref().map(|message| match message {
            EditorMessage::Good(message) => (message.text(language), None),
            EditorMessage::Bad(message) => (message.text(language), Some(theme::CODE_ALARM_TEXT)),
            EditorMessage::NotStored(why) => (
                not_stored_reason(why, language).text(language),
                Some(theme::CODE_ALARM_TEXT),
            ),
        });
        if let Some((text, color)) = shown_message {
            let text = RichText::new(text);
            ui.label(color.map_or(text.clone(), |color| text.color(color)));
        }
        if !self.document.is_editable() {
            let limit = document::MAX_EDITABLE_BYTES / 1000;
            ui.label(say::program_large(limit).text(language));
        }
        let document = &self.document;
        if self
            .port
            .show_offer(ui, document.revision, &document.text, language)
        {
            self.port.open(&document.text);
        }
        let newest = self.last_check.as_ref();
        let Some(checked) = newest.filter(|it| it.revision == self.document.revision) else {
            ui.weak(say::program_checking().text(language));
            return;
        };
        let mut clicked_finding = None;
        ScrollArea::vertical()
            .auto_shrink([false, false])
            .show(ui, |ui| {
                if checked.is_incomplete() {
                    let words = say::program_given_up().text(language);
                    ui.label(RichText::new(words).color(theme::CODE_ALARM_TEXT));
                } else if checked.findings.is_empty() {
                    ui.label(checked.first_look.summary_line(language));
                }
                let name = say::program_findings_name().text(language);
                let count = checked.findings.len();
                let list = focus::FocusList::begin(ui, "findings", &name, count, None);
                for (at, finding) in checked.findings.iter().enumerate() {
                    let report = finding.report(language);
                    let sentence = RichText::new(report.sentence(Some(language)))
                        .color(theme::CODE_ALARM_TEXT);
                    let link = focus::link_row(ui, sentence);
                    if list.show_cursor(ui, at, &link) || list.entered_row() == Some(at) {
                        clicked_finding = finding.line.map(|line| (line, finding.columns.clone()));
                    }
                    let helps = [
                        report.cause.map(say::window_alarm_cause),
                        report.way_out.map(say::window_alarm_way_out),
                    ];
                    for help in helps.into_iter().flatten() {
                        ui.label(help.text(language));
                    }
                }
                for warning in &checked.warnings {
                    ui.label(warning.text(language));
                }
            });
        if let Some((line, columns)) = clicked_finding {
            let start = self
                .document
                .character_at_byte(self.document.line_start(line));
            self.selection_to_show = Some(start + columns.start..start + columns.end);
        }
    }

    /// Draws the pane that ports the text from another control. The ported text becomes a new
    /// program: the foreign file stays as it is.
    pub(super) fn show_port(&mut self, ui: &mut Ui, language: Language) {
        if let Some(text) = self.port.show(ui, language) {
            let notice = say::port_taken_over();
            self.text_to_load = Some(TextToLoad::NewProgram { text, notice });
        }
    }

    /// Draws the question what to do with an unsaved text before another one is loaded, and
    /// carries out the answer.
    pub(super) fn show_unsaved_question(&mut self, context: &Context, language: Language) {
        if self.text_to_load.is_none() || !self.document.is_unsaved() {
            return;
        }
        let name = match &self.document.origin {
            TextOrigin::File(path, _) => file_name(path),
            TextOrigin::New => say::program_new_name().text(language),
            TextOrigin::Memory(_) => self.document.name(self.breakpoints.naming()),
        };
        match bar::ask_to_save(context, &name, language) {
            Some(bar::UnsavedAnswer::Save) => {
                let document = &self.document;
                match document.origin {
                    TextOrigin::Memory(_) => self.document_store.store(document, context),
                    TextOrigin::File(..) | TextOrigin::New => {
                        self.document_store.save(document, language, context);
                    }
                }
            }
            Some(bar::UnsavedAnswer::Discard) => {
                if let Some(next) = self.text_to_load.take() {
                    self.load_text(next, context);
                }
            }
            Some(bar::UnsavedAnswer::Cancel) => self.text_to_load = None,
            None => {}
        }
    }
}
