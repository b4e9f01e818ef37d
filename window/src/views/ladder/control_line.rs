//! Sends the ladder to a control through a serial port of the computer and reads it from there,
//! as GSKCC does (manual PLC-III 6).

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crossbeam::queue::ArrayQueue;
use egui::{Button, TextEdit, Ui};
use gsk_host::pc::{TransferSettings, port_names, read_ladder, send_ladder};
use gsk_messages::{Language, Message, say};

use super::LadderView;
use super::draft::LadderDraft;
use crate::views::transfer::BAUD_RATES;
use crate::widgets::field_menu::field_menu;
use crate::widgets::files::run_in_thread;

/// The port at which the other control is, and whether a transfer runs.
#[derive(Debug)]
pub struct ControlLine {
    port: String,
    baud: u32,
    is_busy: Arc<AtomicBool>,
    /// The ports of the computer when the menu was opened last.
    ports: Vec<String>,
    /// Queue for the ports of the computer, which a thread lists.
    found_ports: Arc<ArrayQueue<Vec<String>>>,
    /// Whether the menu was open in the last frame.
    is_menu_open: bool,
}

impl ControlLine {
    /// Starts with the port and the rate of the view *Transfer*.
    pub fn new(settings: &TransferSettings) -> Self {
        Self {
            port: settings.port.clone(),
            baud: settings.baud,
            is_busy: Arc::default(),
            ports: Vec::new(),
            found_ports: Arc::new(ArrayQueue::new(1)),
            is_menu_open: false,
        }
    }
}

impl LadderView {
    /// Draws the button of the serial port, whose menu has the port and the two commands, and
    /// while a transfer runs a sign of it.
    pub(super) fn show_line_button(&mut self, ui: &mut Ui, language: Language) {
        let was_open = self.line.is_menu_open;
        self.line.is_menu_open = false;
        field_menu(ui, say::ladder_line_menu().text(language), |ui| {
            if !was_open {
                self.find_ports(ui);
            }
            self.line.is_menu_open = true;
            self.show_line_menu(ui, language);
        });
        if self.line.is_busy.load(Ordering::Relaxed) {
            ui.spinner();
            ui.label(say::ladder_line_running(&self.line.port).text(language));
        }
    }

    /// Lists the ports of the computer in a thread.
    fn find_ports(&self, ui: &Ui) {
        let found = Arc::clone(&self.line.found_ports);
        run_in_thread(ui.ctx(), &self.console.notice_sender, move || {
            found.force_push(port_names());
            None
        });
    }

    fn show_line_menu(&mut self, ui: &mut Ui, language: Language) {
        if let Some(ports) = self.line.found_ports.pop() {
            if self.line.port.trim().is_empty()
                && let Some(first) = ports.first()
            {
                self.line.port.clone_from(first);
            }
            self.line.ports = ports;
        }
        ui.horizontal(|ui| {
            let name = say::transfer_view_port().text(language);
            ui.label(&name);
            let field = TextEdit::singleline(&mut self.line.port).desired_width(170.0);
            let response = ui.add(field);
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, &name));
        });
        let ControlLine {
            port, ports, baud, ..
        } = &mut self.line;
        for known in &*ports {
            ui.selectable_value(port, known.clone(), known);
        }
        if ports.is_empty() {
            ui.weak(say::ladder_line_no_ports().text(language));
        }
        ui.horizontal(|ui| {
            ui.label(say::transfer_view_speed().text(language));
            for speed in BAUD_RATES {
                ui.selectable_value(baud, speed, speed.to_string());
            }
        });
        ui.separator();
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
