//! The dialogs of the transfer view: 发送文件设置 (file to send), CNC文件重命名 (rename), and the
//! questions before something is lost.

use std::path::PathBuf;

use egui::{ComboBox, Context, Grid, Id, Rect, TextEdit, Ui};
use gsk_messages::{Language, Message, say};
use gsk_transfer::{FileName, Partition, RemotePath, TransferFile};

use super::job::Wish;
use super::naming::{FIELD, Naming, complaint, ended, window};
use super::{Chosen, TransferView};
use crate::pc::Item;
use crate::pc::worker::Order;
use crate::window::files::{self, Wanted};

/// Extensions of the files that the file dialog offers.
const ENDINGS: [&str; 7] = ["cnc", "nc", "txt", "tap", "par", "ofs", "wmp"];

/// The open dialog.
pub enum Dialog {
    /// Settings of a file to send.
    File {
        /// Row of the list to change; `None`: a new row.
        at: Option<usize>,
        /// Name and partition as they are typed.
        item: Item,
        /// Path as it is typed.
        path: String,
    },
    /// Rename a file of the control.
    Rename {
        /// Index of its partition in [`Partition::ALL`].
        partition: usize,
        /// Old and new name as they are typed.
        naming: Naming,
    },
    /// Confirm that these files of the control are deleted.
    Delete(Vec<RemotePath>),
    /// Confirm that a backup is restored to the control.
    Restore(PathBuf),
    /// Ask whether to save a file that the control has sent without a request.
    Keep(TransferFile),
}

impl Dialog {
    /// The dialog for a new file of the list.
    pub fn of_file(path: PathBuf, name: Option<FileName>) -> Self {
        Self::File {
            at: None,
            path: path.display().to_string(),
            item: Item {
                path,
                name: name.map(|it| it.to_string()).unwrap_or_default(),
                partition: 0,
            },
        }
    }

    /// The dialog for an existing row of the list.
    pub fn change(at: usize, item: &Item) -> Self {
        Self::File {
            at: Some(at),
            path: item.path.display().to_string(),
            item: item.clone(),
        }
    }

    /// The dialog to rename a file, with the first checked file as the old name.
    pub fn rename(first: Option<&RemotePath>) -> Self {
        let old = first.map(|place| place.name.to_string());
        let partition = first.map(|place| place.partition).unwrap_or_default();
        Self::Rename {
            partition: position(partition),
            naming: Naming::new(old.unwrap_or_default(), String::new()),
        }
    }

    /// Whether the dialog needs a connection.
    pub const fn is_of_control(&self) -> bool {
        matches!(
            self,
            Self::Rename { .. } | Self::Delete(_) | Self::Restore(_)
        )
    }
}

fn position(partition: Partition) -> usize {
    let mut all = Partition::ALL.into_iter();
    all.position(|it| it == partition).unwrap_or_default()
}

/// Draws a question and returns the index of the clicked answer.
fn ask(
    context: &Context,
    room: Rect,
    language: Language,
    title: &Message,
    said: &Message,
    answers: &[Message; 2],
) -> Option<usize> {
    let mut clicked = None;
    window(context, room, title, language, |ui| {
        ui.label(said.text(language));
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            for (at, words) in answers.iter().enumerate() {
                if ui.button(words.text(language)).clicked() {
                    clicked = Some(at);
                }
            }
        });
    });
    clicked
}

fn partitions(ui: &mut Ui, id: &str, named: Id, chosen: &mut usize) {
    let name = Partition::ALL.get(*chosen).map_or("", |it| it.name());
    ComboBox::from_id_salt(id)
        .selected_text(name)
        .show_ui(ui, |ui| {
            for (at, partition) in Partition::ALL.into_iter().enumerate() {
                ui.selectable_value(chosen, at, partition.name());
            }
        })
        .response
        .labelled_by(named);
}

impl TransferView {
    /// Draws the dialog of the job, or the open dialog.
    pub(super) fn dialogs(&mut self, context: &Context, language: Language) {
        if let Some(job) = &mut self.job {
            match job.show(context, self.room, language) {
                Some(Wish::Cancel) => {
                    if let Some(worker) = &self.worker {
                        worker.cancel();
                    }
                }
                Some(Wish::Answer(answer)) => self.order(Order::Answer(answer)),
                Some(Wish::Close) => self.job = None,
                None => {}
            }
            if let Some(said) = self.job.as_ref().and_then(super::job::Job::all_well) {
                self.said = Some((said, false));
                self.job = None;
            }
            return;
        }
        let Some(dialog) = self.dialog.take() else {
            return;
        };
        self.dialog = match dialog {
            Dialog::File { at, item, path } => self.file(context, language, at, item, path),
            Dialog::Rename { partition, naming } => {
                self.rename(context, language, partition, naming)
            }
            Dialog::Delete(places) => self.delete(context, language, places),
            Dialog::Restore(folder) => self.restore(context, language, folder),
            Dialog::Keep(file) => self.keep(context, language, file),
        };
    }

    /// Draws 发送文件设置. Returns the dialog while it stays open.
    fn file(
        &mut self,
        context: &Context,
        language: Language,
        at: Option<usize>,
        mut item: Item,
        mut path: String,
    ) -> Option<Dialog> {
        let room = self.room;
        let mut done = None;
        let mut browse = false;
        window(
            context,
            room,
            &say::transfer_view_add_title(),
            language,
            |ui| {
                Grid::new("transfer file").num_columns(2).show(ui, |ui| {
                    ui.label(say::transfer_view_path().text(language));
                    ui.horizontal(|ui| {
                        let line = TextEdit::singleline(&mut path).desired_width(FIELD - 80.0);
                        ui.add(line);
                        let words = say::transfer_view_browse().text(language);
                        browse = at.is_none() && ui.button(words).clicked();
                    });
                    ui.end_row();
                    ui.label(say::transfer_view_name().text(language));
                    let line = TextEdit::singleline(&mut item.name).desired_width(FIELD);
                    ui.add(line.hint_text("O0001.CNC"));
                    ui.end_row();
                    let named = ui.label(say::transfer_view_partition().text(language)).id;
                    partitions(ui, "file-partition", named, &mut item.partition);
                    ui.end_row();
                });
                complaint(ui, language, &item.name);
                let good = FileName::new(&item.name).is_ok() && !path.trim().is_empty();
                done = ended(ui, language, good);
            },
        );
        if browse {
            self.choose_file(context, language);
            return None;
        }
        match done {
            None => Some(Dialog::File { at, item, path }),
            Some(false) => None,
            Some(true) => {
                item.path = PathBuf::from(path.trim());
                match at.and_then(|at| self.remembered.list.get_mut(at)) {
                    Some(row) => *row = item,
                    None => self.remembered.list.push(item),
                }
                self.measure();
                None
            }
        }
    }

    /// Lets the operator choose a file for the list.
    pub(super) fn choose_file(&self, context: &Context, language: Language) {
        let deliver = self.chosen.0.clone();
        let name = say::window_part_programs().text(language);
        let wanted = Wanted::Open(name, ENDINGS.to_vec());
        files::choose(context, language, &self.console.say, wanted, move |path| {
            let name = crate::pc::folder::named(&path);
            // A closed view needs no file.
            let _ = deliver.send(Chosen::File(path, name));
            None
        });
    }

    /// Draws CNC文件重命名. Returns the dialog while it stays open.
    fn rename(
        &self,
        context: &Context,
        language: Language,
        mut partition: usize,
        mut naming: Naming,
    ) -> Option<Dialog> {
        let room = self.room;
        let listed = self.listing.partitions.get(partition);
        let entries = listed.map_or([].as_slice(), |(_, entries)| entries);
        let mut done = None;
        window(
            context,
            room,
            &say::transfer_view_rename_title(),
            language,
            |ui| {
                naming.fields(ui, language, true);
                ui.horizontal(|ui| {
                    let named = ui.label(say::transfer_view_partition().text(language)).id;
                    partitions(ui, "rename-partition", named, &mut partition);
                    let words = say::transfer_view_directory().text(language);
                    if ui.button(words).clicked() {
                        self.order(Order::List);
                    }
                });
                naming.entries(ui, entries, true);
                done = ended(ui, language, naming.is_good());
            },
        );
        match done {
            None => return Some(Dialog::Rename { partition, naming }),
            Some(false) => {}
            Some(true) => {
                let place = Partition::ALL.get(partition).copied().unwrap_or_default();
                if let (Ok(old), Ok(to)) = (FileName::new(&naming.old), FileName::new(&naming.new))
                {
                    let from = RemotePath {
                        partition: place,
                        name: old,
                    };
                    self.order(Order::Rename { from, to });
                }
            }
        }
        None
    }

    fn delete(
        &self,
        context: &Context,
        language: Language,
        places: Vec<RemotePath>,
    ) -> Option<Dialog> {
        let title = say::transfer_view_delete_ask(places.len());
        let names: Vec<String> = places.iter().map(|place| place.name.to_string()).collect();
        let said = say::transfer_view_delete_gone(names.join(", "));
        let answers = [say::transfer_view_delete(), say::window_cancel()];
        match ask(context, self.room, language, &title, &said, &answers) {
            None => return Some(Dialog::Delete(places)),
            Some(0) => self.order(Order::Delete(places)),
            Some(_) => {}
        }
        None
    }

    fn restore(&self, context: &Context, language: Language, folder: PathBuf) -> Option<Dialog> {
        let title = say::transfer_view_restore();
        let said = say::transfer_view_restore_ask(folder.display());
        let answers = [say::transfer_view_send(), say::window_cancel()];
        match ask(context, self.room, language, &title, &said, &answers) {
            None => return Some(Dialog::Restore(folder)),
            Some(0) => self.order(Order::Restore(folder)),
            Some(_) => {}
        }
        None
    }

    /// Draws 接收到CNC上传的文件,保存在硬盘上吗? (save the received file?). Returns the dialog while it stays
    /// open.
    fn keep(&self, context: &Context, language: Language, file: TransferFile) -> Option<Dialog> {
        let title = say::transfer_view_keep();
        let name = file.remote_path.name.clone();
        let said = say::transfer_view_keep_what(&name, file.bytes.len());
        let answers = [say::transfer_view_yes(), say::transfer_view_no()];
        match ask(context, self.room, language, &title, &said, &answers) {
            None => return Some(Dialog::Keep(file)),
            Some(0) => {
                let deliver = self.chosen.0.clone();
                let wanted = Wanted::Save(name.to_string(), "cnc");
                files::choose(context, language, &self.console.say, wanted, move |path| {
                    let _ = deliver.send(Chosen::Keep(path, file));
                    None
                });
            }
            Some(_) => {}
        }
        None
    }
}
