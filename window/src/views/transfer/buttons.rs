//! Draws the column of buttons: 通讯控制 (communication) and 文件选择 (files).

use egui::{Button, Ui, vec2};
use gsk_host::pc::SendListItem;
use gsk_host::pc::worker::{PcWorkerCommand, ToSend};
use gsk_messages::{Language, Message, say};
use gsk_transfer::RemotePath;

use super::{ChosenPath, ConnectionStage, TransferDialog, TransferDirection, TransferView};
use crate::views::text_files;
use crate::widgets::files::{self, FileChoice};

/// File extension of a saved list of files.
const LIST_EXTENSION: &str = "lst";

/// Draws a button as wide as the column. Returns true if it was clicked.
fn show_button(ui: &mut Ui, enabled: bool, label: &Message, language: Language) -> bool {
    let size = vec2(ui.available_width(), 24.0);
    let button = Button::new(label.text(language)).min_size(size);
    ui.add_enabled(enabled, button).clicked()
}

impl TransferView {
    pub(super) fn show_buttons(&mut self, ui: &mut Ui, language: Language) {
        let is_idle = self.job.is_none();
        ui.label(say::transfer_view_control().text(language));
        let is_closed = self.stage == ConnectionStage::Closed;
        let label = match is_closed {
            true => say::transfer_view_open_port(),
            false => say::transfer_view_close_port(),
        };
        let has_port_name = !self.settings.port.trim().is_empty();
        if show_button(
            ui,
            is_idle && (has_port_name || !is_closed),
            &label,
            language,
        ) {
            self.message = None;
            self.send_order(match is_closed {
                true => PcWorkerCommand::Open {
                    port: self.settings.port.trim().to_owned(),
                    baud: self.settings.baud,
                },
                false => PcWorkerCommand::Close,
            });
        }
        let connected = self.stage == ConnectionStage::Connected;
        let label = match connected {
            true => say::transfer_view_disconnect(),
            false => say::transfer_view_connect(),
        };
        if show_button(ui, is_idle && !is_closed, &label, language) {
            self.message = None;
            self.send_order(match connected {
                true => PcWorkerCommand::Disconnect,
                false => PcWorkerCommand::Connect,
            });
        }
        let can_transfer = is_idle && connected;
        let has_files = match self.direction {
            TransferDirection::Send => !self.settings.list.is_empty(),
            TransferDirection::Receive => !self.listing.checked.is_empty(),
        };
        if show_button(
            ui,
            can_transfer && has_files,
            &say::transfer_view_start(),
            language,
        ) {
            self.start_transfer(ui, language);
        }
        ui.add_space(10.0);
        ui.label(say::transfer_view_files().text(language));
        match self.direction {
            TransferDirection::Send => self.show_send_buttons(ui, language, can_transfer),
            TransferDirection::Receive => self.show_receive_buttons(ui, language, can_transfer),
        }
    }

    /// 开始传送: starts the transfer.
    fn start_transfer(&mut self, ui: &Ui, language: Language) {
        self.message = None;
        if self.direction == TransferDirection::Receive {
            let paths = self.listing.checked_paths();
            self.choose_folder(ui, language, |into| ChosenPath::ReceiveInto(paths, into));
            return;
        }
        let to_order = |item: &SendListItem| {
            Some(ToSend {
                path: item.path.clone(),
                location: RemotePath {
                    partition: item.partition(),
                    // The list accepts only valid names.
                    name: gsk_transfer::FileName::new(&item.name).ok()?,
                },
                overwrite: false,
            })
        };
        let files = self.settings.list.iter().filter_map(to_order).collect();
        self.send_order(PcWorkerCommand::Send(files));
    }

    fn show_send_buttons(&mut self, ui: &mut Ui, language: Language, can_transfer: bool) {
        if show_button(ui, true, &say::transfer_view_list_load(), language) {
            let sender = self.chosen_paths.0.clone();
            let context = ui.ctx().clone();
            text_files::open(
                &self.console,
                &context,
                language,
                LIST_EXTENSION,
                move |text| {
                    let items = text.lines().filter_map(SendListItem::from_line).collect();
                    // A closed view needs no list.
                    let _ = sender.send(ChosenPath::List(items));
                },
            );
        }
        let has_files = !self.settings.list.is_empty();
        if show_button(ui, has_files, &say::transfer_view_list_save(), language) {
            let text: String = self
                .settings
                .list
                .iter()
                .map(SendListItem::to_line)
                .collect();
            let (kind, context) = (("files.lst", LIST_EXTENSION), ui.ctx().clone());
            text_files::save(&self.console, &context, language, kind, move || text);
        }
        if show_button(ui, true, &say::transfer_view_add(), language) {
            self.choose_file(ui.ctx(), language);
        }
        let button_area = ui.scope(|ui| {
            let label = say::transfer_view_restore();
            if show_button(ui, can_transfer, &label, language) {
                self.choose_folder(ui, language, ChosenPath::Restore);
            }
        });
        let hint = say::transfer_view_restore_hint().text(language);
        button_area.response.on_hover_text(hint);
    }

    fn show_receive_buttons(&mut self, ui: &mut Ui, language: Language, can_transfer: bool) {
        if show_button(ui, can_transfer, &say::transfer_view_directory(), language) {
            self.message = None;
            self.send_order(PcWorkerCommand::List);
        }
        let paths = self.listing.checked_paths();
        let can_delete = can_transfer && !paths.is_empty();
        if show_button(ui, can_delete, &say::transfer_view_delete(), language) {
            self.dialog = Some(TransferDialog::Delete(paths.clone()));
        }
        if show_button(ui, can_transfer, &say::transfer_view_rename(), language) {
            self.dialog = Some(TransferDialog::rename(paths.first()));
        }
        let button_area = ui.scope(|ui| {
            if show_button(ui, can_transfer, &say::transfer_view_backup(), language) {
                self.choose_folder(ui, language, ChosenPath::BackUp);
            }
        });
        let hint = say::transfer_view_backup_hint().text(language);
        button_area.response.on_hover_text(hint);
    }

    fn choose_folder(
        &self,
        ui: &Ui,
        language: Language,
        to_result: impl FnOnce(std::path::PathBuf) -> ChosenPath + Send + 'static,
    ) {
        let sender = self.chosen_paths.0.clone();
        let choice = FileChoice::Folder;
        files::choose_file(
            ui.ctx(),
            language,
            &self.console.notice_sender,
            choice,
            move |path| {
                let _ = sender.send(to_result(path));
                None
            },
        );
    }
}
