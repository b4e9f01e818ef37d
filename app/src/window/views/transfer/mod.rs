//! The transfer view: the PC's side of the serial port, after the maker's communication
//! software (manual V). It has the port settings, the files to send, the files of the control,
//! and the dialogs of a transfer.

mod buttons;
mod dialogs;
mod job;
mod lists;
mod naming;

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::PathBuf;

use crossbeam::channel::{Receiver, Sender, unbounded};
use egui::{
    CentralPanel, Color32, ComboBox, Id, Panel, Rect, RichText, ScrollArea, TextEdit, Ui, vec2,
};
use gsk_messages::{Language, Message, say};
use gsk_transfer::{BLOCK_BYTES, DirectoryEntry, FileName, Partition, RemotePath, TransferFile};
use web_time::Duration;

use crate::kernel::Console;
use crate::pc::worker::{News, Order, Stage, Worker};
use crate::pc::{Item, Remembered};
use crate::window::focus;
use dialogs::Dialog;
use job::Job;

/// Baud rates that controls and PCs support, bit/s (manual V-3.2).
const SPEEDS: [u32; 6] = [4800, 9600, 19_200, 38_400, 57_600, 115_200];
/// Width of the column of buttons, points.
const BUTTONS: f32 = 148.0;

const GOOD: Color32 = Color32::from_rgb(110, 230, 120);
const WAITS: Color32 = Color32::from_rgb(255, 196, 90);
const BAD: Color32 = Color32::from_rgb(255, 120, 96);

/// 传输方式: the direction of a transfer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Direction {
    /// 发送文件: to the control.
    #[default]
    Send,
    /// 接收文件: from the control.
    Receive,
}

/// The result of a file dialog.
enum Chosen {
    /// A file for the list, and its proposed name in the control.
    File(PathBuf, Option<FileName>),
    /// The content of a list file.
    List(Vec<Item>),
    /// The files to receive, and their folder on the PC.
    Into(Vec<RemotePath>, PathBuf),
    /// The folder for a new backup.
    BackUp(PathBuf),
    /// The folder of a backup to restore.
    Restore(PathBuf),
    /// The path for a file that the control has sent without a request.
    Keep(PathBuf, TransferFile),
}

/// The directory of the control that was received last.
#[derive(Default)]
struct Listing {
    partitions: Vec<(Partition, Vec<DirectoryEntry>)>,
    /// The checked files: index of the partition in [`Partition::ALL`], file name.
    ticked: BTreeSet<(usize, String)>,
}

/// The transfer view.
pub struct TransferView {
    console: Console,
    remembered: Remembered,
    /// The thread for the port. `None` before the view is drawn for the first time, and if the
    /// thread could not be started.
    worker: Option<Worker>,
    ports: Vec<String>,
    stage: Stage,
    direction: Direction,
    listing: Listing,
    /// Lengths of the files to send, bytes; `None`: the file does not exist.
    lengths: BTreeMap<PathBuf, Option<u64>>,
    job: Option<Job>,
    dialog: Option<Dialog>,
    /// Files that the control has sent without a request, until the operator decides about
    /// them.
    pushed: VecDeque<TransferFile>,
    /// The last message, and whether it is an error.
    said: Option<(Message, bool)>,
    chosen: (Sender<Chosen>, Receiver<Chosen>),
    /// Rectangle of the view; its dialogs are inside.
    room: Rect,
}

impl TransferView {
    /// Creates the view with the stored settings. It opens no port.
    pub fn new(console: Console, remembered: Remembered) -> Self {
        Self {
            console,
            remembered,
            worker: None,
            ports: Vec::new(),
            stage: Stage::default(),
            direction: Direction::default(),
            listing: Listing::default(),
            lengths: BTreeMap::new(),
            job: None,
            dialog: None,
            pushed: VecDeque::new(),
            said: None,
            chosen: unbounded(),
            room: Rect::ZERO,
        }
    }

    /// The settings to store for the next start.
    pub const fn remembered(&self) -> &Remembered {
        &self.remembered
    }

    /// Closes the port after the running job has ended.
    pub fn close(&mut self) {
        self.order(Order::Close);
        self.dialog = None;
    }

    fn order(&self, order: Order) {
        if let Some(worker) = &self.worker {
            worker.order(order);
        }
    }

    /// Starts the thread when the view is drawn for the first time.
    fn begin(&mut self, ui: &Ui) {
        if self.worker.is_some() || self.said.as_ref().is_some_and(|(_, wrong)| *wrong) {
            return;
        }
        let context = ui.ctx().clone();
        let wake = move || context.request_repaint_after(Duration::from_millis(1));
        match Worker::start(wake) {
            Ok(worker) => {
                worker.order(Order::FindPorts);
                self.worker = Some(worker);
                self.measure();
            }
            Err(error) => self.said = Some((say::as_written(error), true)),
        }
    }

    /// Requests the lengths of the files to send.
    fn measure(&self) {
        let paths = self.remembered.list.iter().map(|item| item.path.clone());
        self.order(Order::Measure(paths.collect()));
    }

    pub fn show(&mut self, ui: &mut Ui, language: Language) {
        self.room = ui.max_rect();
        self.begin(ui);
        self.hear();
        Panel::top("transfer line")
            .frame(super::bar_frame())
            .show(ui, |ui| self.line(ui, language));
        Panel::bottom("transfer said")
            .frame(super::bar_frame())
            .show(ui, |ui| self.words(ui, language));
        Panel::right("transfer buttons")
            .exact_size(BUTTONS)
            .resizable(false)
            .frame(super::side_frame())
            .show(ui, |ui| {
                ScrollArea::vertical()
                    .id_salt("transfer buttons")
                    .auto_shrink([false, false])
                    .show(ui, |ui| {
                        self.buttons(ui, language);
                        focus::follow(ui);
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
                            Direction::Send => self.sending(ui, language),
                            Direction::Receive => self.receiving(ui, language),
                        }
                        focus::follow(ui);
                    });
            });
        self.dialogs(ui.ctx(), language);
    }

    /// Receives the results of the thread and of the file dialogs.
    fn hear(&mut self) {
        while let Some(news) = self.worker.as_ref().and_then(Worker::news) {
            self.take(news);
        }
        while let Ok(chosen) = self.chosen.1.try_recv() {
            match chosen {
                Chosen::File(path, name) => self.dialog = Some(Dialog::of_file(path, name)),
                Chosen::List(list) => {
                    self.remembered.list = list;
                    self.measure();
                }
                Chosen::Into(places, into) => self.order(Order::Receive { places, into }),
                Chosen::BackUp(folder) => self.order(Order::BackUp(folder)),
                Chosen::Restore(folder) => self.dialog = Some(Dialog::Restore(folder)),
                Chosen::Keep(path, file) => self.order(Order::Keep { path, file }),
            }
        }
        if self.dialog.is_none() && self.job.is_none() {
            self.dialog = self.pushed.pop_front().map(Dialog::Keep);
        }
    }

    fn take(&mut self, news: News) {
        match news {
            News::Ports(ports) => {
                if self.remembered.port.is_empty()
                    && let Some(first) = ports.first()
                {
                    self.remembered.port.clone_from(first);
                }
                self.ports = ports;
            }
            News::Stage(stage) => {
                self.stage = stage;
                self.said = None;
                if stage != Stage::Connected {
                    self.listing = Listing::default();
                    self.dialog.take_if(|dialog| dialog.is_of_control());
                }
            }
            News::Lengths(lengths) => self.lengths.extend(lengths),
            News::Failed(said) => self.said = Some((said, true)),
            News::Said(said) => self.said = Some((said, false)),
            News::Listed(partitions) => self.listing.list(partitions),
            News::Pushed(file) => self.pushed.push_back(file),
            News::Asked(question) => {
                if let Some(job) = &mut self.job {
                    job.ask(question);
                }
            }
            News::Begun(kind, names) => self.job = Some(Job::new(kind, names)),
            other => {
                if let Some(job) = &mut self.job {
                    job.take(other);
                }
            }
        }
    }

    /// Draws 通讯设置 (port settings) and 文件传输 (direction).
    fn line(&mut self, ui: &mut Ui, language: Language) {
        ui.horizontal_wrapped(|ui| {
            let named = ui.label(say::transfer_view_port().text(language)).id;
            let closed = self.stage == Stage::Closed;
            ui.add_enabled_ui(closed, |ui| self.port(ui, language, named));
            let named = ui.label(say::transfer_view_speed().text(language)).id;
            ui.add_enabled_ui(closed, |ui| {
                let baud = &mut self.remembered.baud;
                ComboBox::from_id_salt("transfer speed")
                    .width(80.0)
                    .selected_text(baud.to_string())
                    .show_ui(ui, |ui| {
                        for speed in SPEEDS {
                            ui.selectable_value(baud, speed, speed.to_string());
                        }
                    })
                    .response
                    .labelled_by(named);
            });
        });
        ui.horizontal_wrapped(|ui| {
            ui.label(say::transfer_view_direction().text(language));
            for (direction, words) in [
                (Direction::Send, say::transfer_view_send()),
                (Direction::Receive, say::transfer_view_receive()),
            ] {
                ui.selectable_value(&mut self.direction, direction, words.text(language));
            }
            ui.separator();
            let words = say::transfer_view_block().text(language);
            ui.label(RichText::new(format!("{words} {BLOCK_BYTES}")).weak());
        });
    }

    fn port(&mut self, ui: &mut Ui, language: Language, named: Id) {
        let hint = say::transfer_view_port_hint().text(language);
        let port = &mut self.remembered.port;
        let line = TextEdit::singleline(port).desired_width(190.0);
        ui.add(line).labelled_by(named).on_hover_text(hint);
        let list = ComboBox::from_id_salt("transfer ports")
            .width(24.0)
            .selected_text("")
            .show_ui(ui, |ui| {
                for known in &self.ports {
                    ui.selectable_value(port, known.clone(), known);
                }
            });
        if list.response.labelled_by(named).clicked() {
            self.order(Order::FindPorts);
        }
    }

    /// Draws the last message, or what to do next.
    fn words(&self, ui: &mut Ui, language: Language) {
        let (said, ink) = match &self.said {
            Some((said, true)) => (said.clone(), BAD),
            Some((said, false)) => (said.clone(), ui.visuals().text_color()),
            None => match self.stage {
                Stage::Closed => (say::transfer_view_stage_closed(), WAITS),
                Stage::Open => (say::transfer_view_stage_open(), WAITS),
                Stage::Connected => (say::transfer_view_stage_connected(), GOOD),
            },
        };
        ui.set_min_height(ui.spacing().interact_size.y);
        ui.spacing_mut().item_spacing = vec2(8.0, 2.0);
        let text = RichText::new(said.text(language)).color(ink);
        ui.add(egui::Label::new(text).wrap());
    }
}

impl Listing {
    /// Replaces the directory. Files that still exist remain checked.
    fn list(&mut self, partitions: Vec<(Partition, Vec<DirectoryEntry>)>) {
        self.partitions = partitions;
        let there: BTreeSet<_> = self.keys().collect();
        self.ticked.retain(|key| there.contains(key));
    }

    fn keys(&self) -> impl Iterator<Item = (usize, String)> + '_ {
        let all = self.partitions.iter().enumerate();
        all.flat_map(|(at, (_, entries))| entries.iter().map(move |it| (at, it.name.to_string())))
    }

    /// The checked files.
    fn places(&self) -> Vec<RemotePath> {
        let mut places = Vec::new();
        for (at, (partition, entries)) in self.partitions.iter().enumerate() {
            for entry in entries {
                if self.ticked.contains(&(at, entry.name.to_string())) {
                    places.push(RemotePath {
                        partition: *partition,
                        name: entry.name.clone(),
                    });
                }
            }
        }
        places
    }
}
