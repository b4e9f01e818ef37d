//! The file menu of the ladder: open, export, the standard ladder; and the button that prints.

use std::sync::Arc;

use egui::Ui;
use gsk_core::plc::Ladder;
use gsk_core::setup::standard_ladder;
use gsk_host::kernel::monitor::MachineView;
use gsk_host::message_format::describe_io_error;
use gsk_host::platform;
use gsk_messages::{Language, Message, say};
use gsk_runner::ladder::print_ladder;

use super::LadderView;
use crate::views::text_files;
use crate::widgets::files::run_in_thread;

/// Name of the printed page in the folder for temporary files.
const PRINTED_FILE: &str = "gsk980td-ladder.html";

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
        let words = say::ladder_replace_by_standard().text(language);
        if ui.button(words).clicked() {
            if let Some(draft) = &mut self.draft {
                draft.set_text(standard_ladder().source().to_owned(), None);
            }
            ui.close();
        }
    }
    /// Draws the button that opens the ladder in a browser, which previews and prints it.
    pub(super) fn show_print_button(&self, ui: &mut Ui, language: Language, machine: &MachineView) {
        let print = ui.button(say::ladder_print().text(language));
        let hint = say::ladder_print_hint().text(language);
        if print.on_hover_text(hint).clicked() {
            let ladder = self.drawn_ladder(machine);
            run_in_thread(ui.ctx(), &self.console.notice_sender, move || {
                Some(open_printed(&ladder, language))
            });
        }
    }
}

/// Writes the page of a ladder and opens it. Returns what the message line shows.
fn open_printed(ladder: &Ladder, language: Language) -> Message {
    let page = print_ladder(ladder, "ladder.il", language);
    match platform::open_page_file(PRINTED_FILE, page.as_bytes()) {
        Ok(path) => say::ladder_print_opened(path.display()),
        Err(error) => say::sheet_not_opened(PRINTED_FILE, describe_io_error(&error)),
    }
}
