//! The file menu of the ladder: open, export, print, the standard ladder.

use std::sync::Arc;

use egui::Ui;
use gsk_core::setup::standard_ladder;
use gsk_messages::{Language, say};
use gsk_runner::ladder::print_ladder;

use super::LadderView;
use crate::views::text_files;

impl LadderView {
    pub(super) fn show_file_menu(&mut self, ui: &mut Ui, language: Language) {
        let words = say::ladder_open_list().text(language);
        if ui.button(words).clicked() {
            let opened = Arc::clone(&self.opened_lists);
            let context = ui.ctx().clone();
            text_files::open(&self.console, &context, language, "IL", move |text| {
                opened.force_push(text);
            });
            ui.close();
        }
        if ui
            .button(say::ladder_export_list().text(language))
            .clicked()
        {
            if let Some(draft) = &self.draft {
                let text = draft.text().to_owned();
                let context = ui.ctx().clone();
                text_files::save(
                    &self.console,
                    &context,
                    language,
                    ("ladder.il", "IL"),
                    move || text,
                );
            }
            ui.close();
        }
        let print = ui.button(say::ladder_print().text(language));
        let hint = say::ladder_print_hint().text(language);
        if print.on_hover_text(hint).clicked() {
            if let Some(draft) = &self.draft {
                let ladder = Arc::clone(draft.ladder());
                let context = ui.ctx().clone();
                text_files::save(
                    &self.console,
                    &context,
                    language,
                    ("ladder.html", "HTML"),
                    move || print_ladder(&ladder, "ladder.il", language),
                );
            }
            ui.close();
        }
        let words = say::ladder_replace_by_standard().text(language);
        if ui.button(words).clicked() {
            if let Some(draft) = &mut self.draft {
                draft.set_text(standard_ladder().source().to_owned(), None);
            }
            ui.close();
        }
    }
}
