//! Sends the ladder to a control through a serial port of the computer and reads it from there,
//! as GSKCC does (manual PLC-III 6).

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use egui::{Button, TextEdit, Ui};
use gsk_host::pc::{TransferSettings, read_ladder, send_ladder};
use gsk_messages::{Language, Message, say};

use super::LadderView;
use super::draft::LadderDraft;
use crate::widgets::files::run_in_thread;

/// The port at which the other control is, and whether a transfer runs.
#[derive(Debug)]
pub struct ControlLine {
    port: String,
    baud: u32,
    is_busy: Arc<AtomicBool>,
}

impl ControlLine {
    /// Starts with the port and the rate of the view *Transfer*.
    pub fn new(settings: &TransferSettings) -> Self {
        Self {
            port: settings.port.clone(),
            baud: settings.baud,
            is_busy: Arc::default(),
        }
    }
}

impl LadderView {
    /// Draws the menu with the port and the two commands.
    pub(super) fn show_line_menu(&mut self, ui: &mut Ui, language: Language) {
        ui.horizontal(|ui| {
            let name = say::transfer_view_port().text(language);
            ui.label(&name);
            let field = TextEdit::singleline(&mut self.line.port).desired_width(170.0);
            let response = ui.add(field);
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, &name));
            ui.label(format!("{} bit/s", self.line.baud));
        });
        let is_ready =
            !self.line.port.trim().is_empty() && !self.line.is_busy.load(Ordering::Relaxed);
        let compiles = self
            .draft
            .as_ref()
            .is_some_and(|draft| draft.errors().is_empty());
        let send = Button::new(say::ladder_line_send().text(language));
        let send = ui.add_enabled(is_ready && compiles, send);
        let hint = say::ladder_line_send_hint().text(language);
        if send.on_hover_text(hint).clicked() {
            self.send_through_line(ui);
            ui.close();
        }
        let read = Button::new(say::ladder_line_read().text(language));
        let hint = say::ladder_line_read_hint().text(language);
        if ui.add_enabled(is_ready, read).on_hover_text(hint).clicked() {
            self.read_through_line(ui);
            ui.close();
        }
    }

    fn send_through_line(&self, ui: &Ui) {
        let list = self.draft.as_ref().map_or("", LadderDraft::text).to_owned();
        self.run_at_line(ui, move |port, baud| match send_ladder(port, baud, &list) {
            Ok(()) => say::ladder_line_sent(port, list.len()),
            Err(error) => error.message(),
        });
    }

    fn read_through_line(&self, ui: &Ui) {
        let lists = Arc::clone(&self.opened_lists);
        self.run_at_line(ui, move |port, baud| match read_ladder(port, baud) {
            Ok(list) => {
                let message = say::ladder_line_received(port, list.len());
                lists.force_push(list);
                message
            }
            Err(error) => error.message(),
        });
    }

    /// Runs a transfer in a thread; the message line of the window shows its result.
    fn run_at_line(&self, ui: &Ui, transfer: impl FnOnce(&str, u32) -> Message + Send + 'static) {
        let is_busy = Arc::clone(&self.line.is_busy);
        let (port, baud) = (self.line.port.trim().to_owned(), self.line.baud);
        is_busy.store(true, Ordering::Relaxed);
        run_in_thread(ui.ctx(), &self.console.notice_sender, move || {
            let message = transfer(&port, baud);
            is_busy.store(false, Ordering::Relaxed);
            Some(message)
        });
    }
}
