//! The transfer view: the PC's side of the serial port, after the maker's communication
//! software (manual V). It has the port settings, the files to send, the files of the control,
//! and the dialogs of a transfer.

mod buttons;
mod dialogs;
mod lists;
mod rename_fields;
mod transfer_job;

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::PathBuf;

use crossbeam::channel::{Receiver, Sender, unbounded};
use egui::{CentralPanel, ComboBox, Id, Panel, Rect, RichText, ScrollArea, TextEdit, Ui, vec2};
use gsk_host::kernel::Console;
use gsk_host::pc::worker::{ConnectionStage, PcWorker, PcWorkerCommand, PcWorkerEvent};
use gsk_host::pc::{SendListItem, TransferSettings};
use gsk_messages::{Language, Message, say};
use gsk_transfer::{BLOCK_BYTES, DirectoryEntry, FileName, Partition, RemotePath, TransferFile};
use web_time::Duration;

use super::interface::{View, ViewFrame, ViewStart};
use crate::focus;
use crate::theme;
use dialogs::TransferDialog;
use transfer_job::TransferJob;

/// Baud rates that controls and PCs support, bit/s (manual V-3.2).
pub(super) const BAUD_RATES: [u32; 6] = [4800, 9600, 19_200, 38_400, 57_600, 115_200];
/// Width of the column of buttons, points.
const BUTTON_COLUMN_WIDTH: f32 = 148.0;

/// 传输方式: the direction of a transfer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum TransferDirection {
    /// 发送文件: files are sent to the control.
    #[default]
    Send,
    /// 接收文件: files are received from the control.
    Receive,
}

/// The path that the user has chosen in a file dialog, by its purpose.
enum ChosenPath {
    /// A file for the list, and its proposed name in the control.
    File(PathBuf, Option<FileName>),
    /// The rows of a list file that was loaded.
    List(Vec<SendListItem>),
    /// The files to receive, and their folder on the PC.
    ReceiveInto(Vec<RemotePath>, PathBuf),
    /// The folder in which a new backup is written.
    BackUp(PathBuf),
    /// The folder of the backup that is restored.
    Restore(PathBuf),
    /// The path for a file that the control has sent without a request.
    Save(PathBuf, TransferFile),
}

/// The directory of the control's files as last received.
#[derive(Default)]
struct ControlDirectory {
    partitions: Vec<(Partition, Vec<DirectoryEntry>)>,
    /// The checked files: index of the partition in [`Partition::ALL`], file name.
    checked: BTreeSet<(usize, String)>,
}

/// The view for file transfers with a control over a serial port.
pub struct TransferView {
    console: Console,
    settings: TransferSettings,
    /// The worker thread for the port; `None` before the view is drawn for the first time, or
    /// if the thread could not be started.
    worker: Option<PcWorker>,
    ports: Vec<String>,
    stage: ConnectionStage,
    direction: TransferDirection,
    listing: ControlDirectory,
    /// Lengths of the files to send, bytes; `None` if a file does not exist.
    lengths: BTreeMap<PathBuf, Option<u64>>,
    job: Option<TransferJob>,
    dialog: Option<TransferDialog>,
    /// Files that the control has sent without a request and about which the operator has not
    /// decided yet.
    received_files: VecDeque<TransferFile>,
    /// The last message, and whether it is an error; `None` without one.
    message: Option<(Message, bool)>,
    chosen_paths: (Sender<ChosenPath>, Receiver<ChosenPath>),
    /// Rectangle of the view, inside which its dialogs are drawn.
    bounds: Rect,
}

impl View for TransferView {
    fn create(start: ViewStart<'_>) -> Self {
        Self::new(start.console.clone(), start.settings.transfer.clone())
    }

    fn close(&mut self) {
        self.send_order(PcWorkerCommand::Close);
        self.dialog = None;
    }

    fn show(&mut self, ui: &mut Ui, frame: ViewFrame<'_>) {
        self.draw(ui, frame.language);
    }
}

impl TransferView {
    /// Creates the view with the stored settings; the port is closed.
    pub fn new(console: Console, settings: TransferSettings) -> Self {
        Self {
            console,
            settings,
            worker: None,
            ports: Vec::new(),
            stage: ConnectionStage::default(),
            direction: TransferDirection::default(),
            listing: ControlDirectory::default(),
            lengths: BTreeMap::new(),
            job: None,
            dialog: None,
            received_files: VecDeque::new(),
            message: None,
            chosen_paths: unbounded(),
            bounds: Rect::ZERO,
        }
    }

    /// Port, rate and list, to be stored for the next start.
    pub const fn settings(&self) -> &TransferSettings {
        &self.settings
    }

    fn send_order(&self, order: PcWorkerCommand) {
        if let Some(worker) = &self.worker {
            worker.send_command(order);
        }
    }

    /// Starts the worker thread when the view is drawn for the first time.
    fn start_worker(&mut self, ui: &Ui) {
        if self.worker.is_some() || self.message.as_ref().is_some_and(|(_, is_error)| *is_error) {
            return;
        }
        let context = ui.ctx().clone();
        let wake = move || context.request_repaint_after(Duration::from_millis(1));
        match PcWorker::start(wake) {
            Ok(worker) => {
                worker.send_command(PcWorkerCommand::FindPorts);
                self.worker = Some(worker);
                self.request_lengths();
            }
            Err(error) => self.message = Some((say::as_written(error), true)),
        }
    }

    /// Requests the lengths of the files to send from the worker thread.
    fn request_lengths(&self) {
        let paths = self.settings.list.iter().map(|item| item.path.clone());
        self.send_order(PcWorkerCommand::Measure(paths.collect()));
    }

    fn draw(&mut self, ui: &mut Ui, language: Language) {
        self.bounds = ui.max_rect();
        self.start_worker(ui);
        self.receive();
        Panel::top("transfer line")
            .frame(super::bar_frame())
            .show(ui, |ui| self.show_settings(ui, language));
        Panel::bottom("transfer said")
            .frame(super::bar_frame())
            .show(ui, |ui| self.show_message(ui, language));
        Panel::right("transfer buttons")
            .exact_size(BUTTON_COLUMN_WIDTH)
            .resizable(false)
            .frame(super::side_frame())
            .show(ui, |ui| {
                ScrollArea::vertical()
                    .id_salt("transfer buttons")
                    .auto_shrink([false, false])
                    .show(ui, |ui| {
                        self.show_buttons(ui, language);
                        focus::scroll_to_focus(ui);
                    });
            });
        CentralPanel::default()
            .frame(super::side_frame())
            .show(ui, |ui| {
                ScrollArea::both()
                    .id_salt("transfer files")
                    .auto_shrink([false, false])
                    .show(ui, |ui| {
                        match self.direction {
                            TransferDirection::Send => self.show_files_to_send(ui, language),
                            TransferDirection::Receive => self.show_control_files(ui, language),
                        }
                        focus::scroll_to_focus(ui);
                    });
            });
        self.show_dialogs(ui.ctx(), language);
    }

    /// Receives the events of the worker thread and the results of the file dialogs.
    fn receive(&mut self) {
        while let Some(news) = self.worker.as_ref().and_then(PcWorker::next_event) {
            self.handle_event(news);
        }
        while let Ok(result) = self.chosen_paths.1.try_recv() {
            match result {
                ChosenPath::File(path, name) => {
                    self.dialog = Some(TransferDialog::new_file(path, name));
                }
                ChosenPath::List(list) => {
                    self.settings.list = list;
                    self.request_lengths();
                }
                ChosenPath::ReceiveInto(places, into) => {
                    self.send_order(PcWorkerCommand::Receive {
                        locations: places,
                        into,
                    });
                }
                ChosenPath::BackUp(folder) => self.send_order(PcWorkerCommand::BackUp(folder)),
                ChosenPath::Restore(folder) => self.dialog = Some(TransferDialog::Restore(folder)),
                ChosenPath::Save(path, file) => {
                    self.send_order(PcWorkerCommand::StorePushed { path, file });
                }
            }
        }
        if self.dialog.is_none() && self.job.is_none() {
            self.dialog = self
                .received_files
                .pop_front()
                .map(TransferDialog::SaveReceived);
        }
    }

    fn handle_event(&mut self, news: PcWorkerEvent) {
        match news {
            PcWorkerEvent::Ports(ports) => {
                if self.settings.port.is_empty()
                    && let Some(first) = ports.first()
                {
                    self.settings.port.clone_from(first);
                }
                self.ports = ports;
            }
            PcWorkerEvent::Stage(stage) => {
                self.stage = stage;
                self.message = None;
                if stage != ConnectionStage::Connected {
                    self.listing = ControlDirectory::default();
                    self.dialog.take_if(|dialog| dialog.needs_connection());
                }
            }
            PcWorkerEvent::Lengths(lengths) => self.lengths.extend(lengths),
            PcWorkerEvent::Failed(message) => self.message = Some((message, true)),
            PcWorkerEvent::Succeeded(message) => self.message = Some((message, false)),
            PcWorkerEvent::Listed(partitions) => self.listing.update(partitions),
            PcWorkerEvent::Pushed(file) => self.received_files.push_back(file),
            PcWorkerEvent::Conflict(question) => {
                if let Some(job) = &mut self.job {
                    job.set_question(question);
                }
            }
            PcWorkerEvent::JobBegun(kind, names) => self.job = Some(TransferJob::new(kind, names)),
            other => {
                if let Some(job) = &mut self.job {
                    job.handle_event(other);
                }
            }
        }
    }

    /// Draws 通讯设置 (port settings) and 文件传输 (direction).
    fn show_settings(&mut self, ui: &mut Ui, language: Language) {
        ui.horizontal_wrapped(|ui| {
            let label = ui.label(say::transfer_view_port().text(language)).id;
            let is_closed = self.stage == ConnectionStage::Closed;
            ui.add_enabled_ui(is_closed, |ui| self.show_port(ui, language, label));
            let label = ui.label(say::transfer_view_speed().text(language)).id;
            ui.add_enabled_ui(is_closed, |ui| {
                let baud = &mut self.settings.baud;
                ComboBox::from_id_salt("transfer speed")
                    .width(80.0)
                    .selected_text(baud.to_string())
                    .show_ui(ui, |ui| {
                        for speed in BAUD_RATES {
                            ui.selectable_value(baud, speed, speed.to_string());
                        }
                    })
                    .response
                    .labelled_by(label);
            });
        });
        ui.horizontal_wrapped(|ui| {
            ui.label(say::transfer_view_direction().text(language));
            for (direction, text) in [
                (TransferDirection::Send, say::transfer_view_send()),
                (TransferDirection::Receive, say::transfer_view_receive()),
            ] {
                ui.selectable_value(&mut self.direction, direction, text.text(language));
            }
            ui.separator();
            let text = say::transfer_view_block().text(language);
            ui.label(RichText::new(format!("{text} {BLOCK_BYTES}")).weak());
        });
    }

    fn show_port(&mut self, ui: &mut Ui, language: Language, label: Id) {
        let hint = say::transfer_view_port_hint().text(language);
        let port = &mut self.settings.port;
        let line = TextEdit::singleline(port).desired_width(190.0);
        ui.add(line).labelled_by(label).on_hover_text(hint);
        let list = ComboBox::from_id_salt("transfer ports")
            .width(24.0)
            .selected_text("")
            .show_ui(ui, |ui| {
                for known in &self.ports {
                    ui.selectable_value(port, known.clone(), known);
                }
            });
        if list.response.labelled_by(label).clicked() {
            self.send_order(PcWorkerCommand::FindPorts);
        }
    }

    /// Draws the last message, or a hint about the next action.
    fn show_message(&self, ui: &mut Ui, language: Language) {
        let (message, ink) = match &self.message {
            Some((message, true)) => (message.clone(), theme::ALARM_TEXT),
            Some((message, false)) => (message.clone(), ui.visuals().text_color()),
            None => match self.stage {
                ConnectionStage::Closed => (say::transfer_view_stage_closed(), theme::WARNING),
                ConnectionStage::Open => (say::transfer_view_stage_open(), theme::WARNING),
                ConnectionStage::Connected => {
                    (say::transfer_view_stage_connected(), theme::SUCCESS)
                }
            },
        };
        ui.set_min_height(ui.spacing().interact_size.y);
        ui.spacing_mut().item_spacing = vec2(8.0, 2.0);
        let text = RichText::new(message.text(language)).color(ink);
        ui.add(egui::Label::new(text).wrap());
    }
}

impl ControlDirectory {
    /// Replaces the directory of the control. Files that still exist remain checked.
    fn update(&mut self, partitions: Vec<(Partition, Vec<DirectoryEntry>)>) {
        self.partitions = partitions;
        let existing: BTreeSet<_> = self.keys().collect();
        self.checked.retain(|key| existing.contains(key));
    }

    fn keys(&self) -> impl Iterator<Item = (usize, String)> + '_ {
        let all = self.partitions.iter().enumerate();
        all.flat_map(|(at, (_, entries))| entries.iter().map(move |it| (at, it.name.to_string())))
    }

    /// The files of the control that are checked, each with its partition.
    fn checked_paths(&self) -> Vec<RemotePath> {
        let mut paths = Vec::new();
        for (at, (partition, entries)) in self.partitions.iter().enumerate() {
            for entry in entries {
                if self.checked.contains(&(at, entry.name.to_string())) {
                    paths.push(RemotePath {
                        partition: *partition,
                        name: entry.name.clone(),
                    });
                }
            }
        }
        paths
    }
}
