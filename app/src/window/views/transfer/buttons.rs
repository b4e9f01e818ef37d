//! Draws the column of buttons: 通讯控制 (communication) and 文件选择 (files).

use egui::{Button, Ui, vec2};
use gsk_messages::{Language, Message, say};
use gsk_transfer::RemotePath;

use super::{Chosen, Dialog, Direction, Stage, TransferView};
use crate::pc::Item;
use crate::pc::worker::{Order, ToSend};
use crate::window::files::{self, Wanted};
use crate::window::views::aside;

/// Extension of a saved list of files.
const LIST: &str = "lst";

/// Draws a button as wide as the column. Returns whether it was clicked.
fn button(ui: &mut Ui, enabled: bool, words: &Message, language: Language) -> bool {
    let size = vec2(ui.available_width(), 24.0);
    let button = Button::new(words.text(language)).min_size(size);
    ui.add_enabled(enabled, button).clicked()
}

impl TransferView {
    pub(super) fn buttons(&mut self, ui: &mut Ui, language: Language) {
        let free = self.job.is_none();
        ui.label(say::transfer_view_control().text(language));
        let closed = self.stage == Stage::Closed;
        let words = match closed {
            true => say::transfer_view_open_port(),
            false => say::transfer_view_close_port(),
        };
        let named = !self.remembered.port.trim().is_empty();
        if button(ui, free && (named || !closed), &words, language) {
            self.said = None;
            self.order(match closed {
                true => Order::Open {
                    port: self.remembered.port.trim().to_owned(),
                    baud: self.remembered.baud,
                },
                false => Order::Close,
            });
        }
        let connected = self.stage == Stage::Connected;
        let words = match connected {
            true => say::transfer_view_disconnect(),
            false => say::transfer_view_connect(),
        };
        if button(ui, free && !closed, &words, language) {
            self.said = None;
            self.order(match connected {
                true => Order::Disconnect,
                false => Order::Connect,
            });
        }
        let able = free && connected;
        let chosen = match self.direction {
            Direction::Send => !self.remembered.list.is_empty(),
            Direction::Receive => !self.listing.ticked.is_empty(),
        };
        if button(ui, able && chosen, &say::transfer_view_start(), language) {
            self.start(ui, language);
        }
        ui.add_space(10.0);
        ui.label(say::transfer_view_files().text(language));
        match self.direction {
            Direction::Send => self.send_buttons(ui, language, able),
            Direction::Receive => self.receive_buttons(ui, language, able),
        }
    }

    /// 开始传送: starts the transfer.
    fn start(&mut self, ui: &Ui, language: Language) {
        self.said = None;
        if self.direction == Direction::Receive {
            let places = self.listing.places();
            self.choose_folder(ui, language, |into| Chosen::Into(places, into));
            return;
        }
        let to_send = |item: &Item| {
            Some(ToSend {
                path: item.path.clone(),
                place: RemotePath {
                    partition: item.partition(),
                    // The list accepts only valid names.
                    name: gsk_transfer::FileName::new(&item.name).ok()?,
                },
                overwrite: false,
            })
        };
        let files = self.remembered.list.iter().filter_map(to_send).collect();
        self.order(Order::Send(files));
    }

    fn send_buttons(&mut self, ui: &mut Ui, language: Language, able: bool) {
        if button(ui, true, &say::transfer_view_list_load(), language) {
            let deliver = self.chosen.0.clone();
            let context = ui.ctx().clone();
            aside::open(&self.console, &context, language, LIST, move |text| {
                let items = text.lines().filter_map(Item::of_line).collect();
                // A closed view needs no list.
                let _ = deliver.send(Chosen::List(items));
            });
        }
        let any = !self.remembered.list.is_empty();
        if button(ui, any, &say::transfer_view_list_save(), language) {
            let text: String = self.remembered.list.iter().map(Item::line).collect();
            let (kind, context) = (("files.lst", LIST), ui.ctx().clone());
            aside::save(&self.console, &context, language, kind, move || text);
        }
        if button(ui, true, &say::transfer_view_add(), language) {
            self.choose_file(ui.ctx(), language);
        }
        let shown = ui.scope(|ui| {
            let words = say::transfer_view_restore();
            if button(ui, able, &words, language) {
                self.choose_folder(ui, language, Chosen::Restore);
            }
        });
        let hint = say::transfer_view_restore_hint().text(language);
        shown.response.on_hover_text(hint);
    }

    fn receive_buttons(&mut self, ui: &mut Ui, language: Language, able: bool) {
        if button(ui, able, &say::transfer_view_directory(), language) {
            self.said = None;
            self.order(Order::List);
        }
        let places = self.listing.places();
        let any = able && !places.is_empty();
        if button(ui, any, &say::transfer_view_delete(), language) {
            self.dialog = Some(Dialog::Delete(places.clone()));
        }
        if button(ui, able, &say::transfer_view_rename(), language) {
            self.dialog = Some(Dialog::rename(places.first()));
        }
        let shown = ui.scope(|ui| {
            if button(ui, able, &say::transfer_view_backup(), language) {
                self.choose_folder(ui, language, Chosen::BackUp);
            }
        });
        let hint = say::transfer_view_backup_hint().text(language);
        shown.response.on_hover_text(hint);
    }

    fn choose_folder(
        &self,
        ui: &Ui,
        language: Language,
        chosen: impl FnOnce(std::path::PathBuf) -> Chosen + Send + 'static,
    ) {
        let deliver = self.chosen.0.clone();
        let wanted = Wanted::Folder;
        files::choose(ui.ctx(), language, &self.console.say, wanted, move |path| {
            let _ = deliver.send(chosen(path));
            None
        });
    }
}
