//! The dialogs of the transfer view: 发送文件设置 (file to send), CNC文件重命名 (rename), and the
//! questions before something is lost.

use std::path::PathBuf;

use egui::{ComboBox, Context, Grid, Id, Rect, TextEdit, Ui};
use gsk_host::pc::SendListItem;
use gsk_host::pc::worker::PcWorkerCommand;
use gsk_messages::{Language, Message, say};
use gsk_transfer::{FileName, Partition, RemotePath, TransferFile};

use super::rename_fields::{FIELD_WIDTH, RenameFields, show_buttons, show_name_error, show_window};
use super::transfer_job::JobRequest;
use super::{ChosenPath, TransferView};
use crate::widgets::files::{self, FileChoice};

/// Extensions of the files that the file dialog offers for the list.
const EXTENSIONS: [&str; 7] = ["cnc", "nc", "txt", "tap", "par", "ofs", "wmp"];

/// The dialog of the transfer view that is open.
pub enum TransferDialog {
    /// The dialog for the settings of a file to send.
    File {
        /// Row of the list that the dialog changes; `None` adds a new row.
        row: Option<usize>,
        /// Name and partition that the operator has typed.
        item: SendListItem,
        /// Path that the operator has typed.
        path: String,
    },
    /// The dialog that renames a file of the control.
    Rename {
        /// Index of the file's partition in [`Partition::ALL`].
        partition: usize,
        /// Old and new name that the operator has typed.
        naming: RenameFields,
    },
    /// Confirm that these files of the control are to be deleted.
    Delete(Vec<RemotePath>),
    /// Confirm that the backup in this folder is to be restored to the control.
    Restore(PathBuf),
    /// Query whether to save a file that the control has sent without a request.
    SaveReceived(TransferFile),
}

impl TransferDialog {
    /// Creates the dialog for a new row of the list.
    pub fn new_file(path: PathBuf, name: Option<FileName>) -> Self {
        Self::File {
            row: None,
            path: path.display().to_string(),
            item: SendListItem {
                path,
                name: name.map(|it| it.to_string()).unwrap_or_default(),
                partition: 0,
            },
        }
    }

    /// Creates the dialog that changes row `at` of the list.
    pub fn change_row(at: usize, item: &SendListItem) -> Self {
        Self::File {
            row: Some(at),
            path: item.path.display().to_string(),
            item: item.clone(),
        }
    }

    /// Creates the dialog that renames a file, with the first checked file as the old name.
    pub fn rename(first: Option<&RemotePath>) -> Self {
        let old = first.map(|place| place.name.to_string());
        let partition = first.map(|place| place.partition).unwrap_or_default();
        Self::Rename {
            partition: partition_index(partition),
            naming: RenameFields::new(old.unwrap_or_default(), String::new()),
        }
    }

    /// Whether the dialog requires a connection with the control.
    pub const fn needs_connection(&self) -> bool {
        matches!(
            self,
            Self::Rename { .. } | Self::Delete(_) | Self::Restore(_)
        )
    }
}

fn partition_index(partition: Partition) -> usize {
    let mut all = Partition::ALL.into_iter();
    all.position(|it| it == partition).unwrap_or_default()
}

/// Draws a question and returns the index of the clicked answer; `None` while it is open.
fn show_question(
    context: &Context,
    bounds: Rect,
    language: Language,
    title: &Message,
    text: &Message,
    answers: &[Message; 2],
) -> Option<usize> {
    let mut clicked = None;
    show_window(context, bounds, title, language, |ui| {
        ui.label(text.text(language));
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            for (at, answer) in answers.iter().enumerate() {
                if ui.button(answer.text(language)).clicked() {
                    clicked = Some(at);
                }
            }
        });
    });
    clicked
}

fn show_partitions(ui: &mut Ui, id: &str, label: Id, selected: &mut usize) {
    let name = Partition::ALL.get(*selected).map_or("", |it| it.name());
    ComboBox::from_id_salt(id)
        .selected_text(name)
        .show_ui(ui, |ui| {
            for (at, partition) in Partition::ALL.into_iter().enumerate() {
                ui.selectable_value(selected, at, partition.name());
            }
        })
        .response
        .labelled_by(label);
}

impl TransferView {
    /// Draws the dialog of the running job, or the open dialog.
    pub(super) fn show_dialogs(&mut self, context: &Context, language: Language) {
        if let Some(job) = &mut self.job {
            match job.show(context, self.bounds, language) {
                Some(JobRequest::Cancel) => {
                    if let Some(worker) = &self.worker {
                        worker.cancel();
                    }
                }
                Some(JobRequest::Answer(answer)) => {
                    self.send_order(PcWorkerCommand::Answer(answer));
                }
                Some(JobRequest::Close) => self.job = None,
                None => {}
            }
            if let Some(message) = self
                .job
                .as_ref()
                .and_then(super::transfer_job::TransferJob::success_message)
            {
                self.message = Some((message, false));
                self.job = None;
            }
            return;
        }
        let Some(dialog) = self.dialog.take() else {
            return;
        };
        self.dialog = match dialog {
            TransferDialog::File {
                row: at,
                item,
                path,
            } => self.show_file_dialog(context, language, at, item, path),
            TransferDialog::Rename { partition, naming } => {
                self.show_rename_dialog(context, language, partition, naming)
            }
            TransferDialog::Delete(places) => self.show_delete_dialog(context, language, places),
            TransferDialog::Restore(folder) => self.show_restore_dialog(context, language, folder),
            TransferDialog::SaveReceived(file) => self.show_save_dialog(context, language, file),
        };
    }

    /// Draws 发送文件设置. Returns the dialog while it stays open. `None` once it is closed.
    fn show_file_dialog(
        &mut self,
        context: &Context,
        language: Language,
        row: Option<usize>,
        mut item: SendListItem,
        mut path: String,
    ) -> Option<TransferDialog> {
        let room = self.bounds;
        let mut accepted = None;
        let mut browse = false;
        show_window(
            context,
            room,
            &say::transfer_view_add_title(),
            language,
            |ui| {
                Grid::new("transfer file").num_columns(2).show(ui, |ui| {
                    ui.label(say::transfer_view_path().text(language));
                    ui.horizontal(|ui| {
                        let line =
                            TextEdit::singleline(&mut path).desired_width(FIELD_WIDTH - 80.0);
                        ui.add(line);
                        let label = say::transfer_view_browse().text(language);
                        browse = row.is_none() && ui.button(label).clicked();
                    });
                    ui.end_row();
                    ui.label(say::transfer_view_name().text(language));
                    let line = TextEdit::singleline(&mut item.name).desired_width(FIELD_WIDTH);
                    ui.add(line.hint_text("O0001.CNC"));
                    ui.end_row();
                    let label = ui.label(say::transfer_view_partition().text(language)).id;
                    show_partitions(ui, "file-partition", label, &mut item.partition);
                    ui.end_row();
                });
                show_name_error(ui, language, &item.name);
                let is_valid = FileName::new(&item.name).is_ok() && !path.trim().is_empty();
                accepted = show_buttons(ui, language, is_valid);
            },
        );
        if browse {
            self.choose_file(context, language);
            return None;
        }
        match accepted {
            None => Some(TransferDialog::File { row, item, path }),
            Some(false) => None,
            Some(true) => {
                item.path = PathBuf::from(path.trim());
                match row.and_then(|at| self.settings.list.get_mut(at)) {
                    Some(row) => *row = item,
                    None => self.settings.list.push(item),
                }
                self.request_lengths();
                None
            }
        }
    }

    /// Shows a dialog in which the operator chooses a file for the list.
    pub(super) fn choose_file(&self, context: &Context, language: Language) {
        let sender = self.chosen_paths.0.clone();
        let name = say::window_part_programs().text(language);
        let choice = FileChoice::Open(name, EXTENSIONS.to_vec());
        files::choose_file(
            context,
            language,
            &self.console.notice_sender,
            choice,
            move |path| {
                let name = gsk_host::pc::folder::control_name(&path);
                // A closed view needs no file.
                let _ = sender.send(ChosenPath::File(path, name));
                None
            },
        );
    }

    /// Draws CNC文件重命名. Returns the dialog while it stays open. `None` once it is closed.
    fn show_rename_dialog(
        &self,
        context: &Context,
        language: Language,
        mut partition: usize,
        mut naming: RenameFields,
    ) -> Option<TransferDialog> {
        let room = self.bounds;
        let directory = self.listing.partitions.get(partition);
        let entries = directory.map_or([].as_slice(), |(_, entries)| entries);
        let mut accepted = None;
        show_window(
            context,
            room,
            &say::transfer_view_rename_title(),
            language,
            |ui| {
                naming.show_fields(ui, language, true);
                ui.horizontal(|ui| {
                    let label = ui.label(say::transfer_view_partition().text(language)).id;
                    show_partitions(ui, "rename-partition", label, &mut partition);
                    let words = say::transfer_view_directory().text(language);
                    if ui.button(words).clicked() {
                        self.send_order(PcWorkerCommand::List);
                    }
                });
                naming.show_entries(ui, entries, true);
                accepted = show_buttons(ui, language, naming.is_valid());
            },
        );
        match accepted {
            None => return Some(TransferDialog::Rename { partition, naming }),
            Some(false) => {}
            Some(true) => {
                let selected = Partition::ALL.get(partition).copied().unwrap_or_default();
                if let (Ok(old), Ok(new)) = (
                    FileName::new(&naming.old_name),
                    FileName::new(&naming.new_name),
                ) {
                    let from = RemotePath {
                        partition: selected,
                        name: old,
                    };
                    self.send_order(PcWorkerCommand::Rename { from, to: new });
                }
            }
        }
        None
    }

    fn show_delete_dialog(
        &self,
        context: &Context,
        language: Language,
        paths: Vec<RemotePath>,
    ) -> Option<TransferDialog> {
        let title = say::transfer_view_delete_ask(paths.len());
        let names: Vec<String> = paths.iter().map(|place| place.name.to_string()).collect();
        let text = say::transfer_view_delete_gone(names.join(", "));
        let answers = [say::transfer_view_delete(), say::window_cancel()];
        match show_question(context, self.bounds, language, &title, &text, &answers) {
            None => return Some(TransferDialog::Delete(paths)),
            Some(0) => self.send_order(PcWorkerCommand::Delete(paths)),
            Some(_) => {}
        }
        None
    }

    fn show_restore_dialog(
        &self,
        context: &Context,
        language: Language,
        folder: PathBuf,
    ) -> Option<TransferDialog> {
        let title = say::transfer_view_restore();
        let text = say::transfer_view_restore_ask(folder.display());
        let answers = [say::transfer_view_send(), say::window_cancel()];
        match show_question(context, self.bounds, language, &title, &text, &answers) {
            None => return Some(TransferDialog::Restore(folder)),
            Some(0) => self.send_order(PcWorkerCommand::Restore(folder)),
            Some(_) => {}
        }
        None
    }

    /// Draws 接收到CNC上传的文件,保存在硬盘上吗? (save the received file?). Returns the dialog while it stays
    /// open, and `None` once it is closed.
    fn show_save_dialog(
        &self,
        context: &Context,
        language: Language,
        file: TransferFile,
    ) -> Option<TransferDialog> {
        let title = say::transfer_view_keep();
        let name = file.remote_path.name.clone();
        let text = say::transfer_view_keep_what(&name, file.bytes.len());
        let answers = [say::transfer_view_yes(), say::transfer_view_no()];
        match show_question(context, self.bounds, language, &title, &text, &answers) {
            None => return Some(TransferDialog::SaveReceived(file)),
            Some(0) => {
                let sender = self.chosen_paths.0.clone();
                let choice = FileChoice::Save(name.to_string(), "cnc");
                files::choose_file(
                    context,
                    language,
                    &self.console.notice_sender,
                    choice,
                    move |path| {
                        let _ = sender.send(ChosenPath::Save(path, file));
                        None
                    },
                );
            }
            Some(_) => {}
        }
        None
    }
}
