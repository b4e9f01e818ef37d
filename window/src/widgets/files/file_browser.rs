//! The file dialog of this program in a separate window: folders, files, a field for the name.

use std::path::{Path, PathBuf};

use crossbeam::channel::{Receiver, bounded};
use egui::{
    Button, Context, Event, Key, Panel, Pos2, Rect, ScrollArea, TextEdit, Ui, Vec2,
    ViewportBuilder, ViewportId,
};
use gsk_host::platform;

use super::{ChoiceRequest, FileChoice, PendingChoices, run_in_thread};
use crate::focus;
use crate::input::keyboard;
use crate::layout::floating::WindowScreen;
use crate::placement::stop_key_clearance;
use gsk_messages::{Language, Message, say};

/// Size of the file dialog, points.
const DIALOG_SIZE: [f32; 2] = [640.0, 460.0];
const MIN_SIZE: [f32; 2] = [420.0, 260.0];

/// A file or folder that the dialog lists.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct FolderEntry {
    /// Whether the entry is a file. This field comes first so that folders sort before files.
    is_file: bool,
    name: String,
}

/// The entries of a folder, or why the folder cannot be read.
type FolderListing = Result<Vec<FolderEntry>, Message>;

/// The state of the file dialog while it is open.
struct OpenDialog {
    request: ChoiceRequest,
    folder: PathBuf,
    reading: Option<Receiver<FolderListing>>,
    listing: FolderListing,
    /// The text that was typed into the name field.
    typed_name: String,
    /// Whether files with other extensions are also shown.
    shows_all: bool,
    /// The existing file that the operator must confirm to overwrite; `None` without a
    /// question.
    overwrites: Option<PathBuf>,
    needs_focus: bool,
    /// Position and size with which the dialog's window opened; `None` before its first frame.
    geometry: Option<(Option<Pos2>, Vec2)>,
}

/// Keyboard input of the dialog's window that is meant for the panel.
#[derive(Debug, Default)]
pub struct BrowserInput {
    /// Whether the window of the file dialog has the focus.
    pub has_focus: bool,
    /// Events for feed hold, emergency stop and released keys, which reach the panel in any case.
    pub stop_events: Vec<Event>,
}

/// The file dialog of this program, for desktops without one.
#[derive(Default)]
pub struct FileBrowser {
    open: Option<OpenDialog>,
    /// The folder that was shown last; `None` before the first dialog.
    last_folder: Option<PathBuf>,
}

/// The result of one frame of the file dialog.
enum DialogResult {
    Open,
    Cancelled,
    Chosen(PathBuf),
}

impl FileBrowser {
    /// Draws the dialog if a file choice waits. Its window covers no key that stops the
    /// machine and, if it fits, leaves the LCD visible (WINDOW-25). Returns its input for the
    /// panel.
    pub fn show(
        &mut self,
        context: &Context,
        language: Language,
        lcd: Option<Rect>,
    ) -> BrowserInput {
        let mut panel_input = BrowserInput::default();
        if self.open.is_none()
            && let Some(request) = PendingChoices::of_context(context).take()
        {
            let folder = self.last_folder.clone().unwrap_or_else(first_folder);
            self.open = Some(OpenDialog::new(request, folder, context));
        }
        let Some(open) = &mut self.open else {
            return panel_input;
        };
        let result = show_in_window(context, language, open, lcd, &mut panel_input);
        if matches!(result, DialogResult::Open) {
            return panel_input;
        }
        let Some(open) = self.open.take() else {
            return panel_input;
        };
        self.last_folder = Some(open.folder);
        if let DialogResult::Chosen(path) = result {
            let ChoiceRequest {
                on_chosen, notices, ..
            } = open.request;
            run_in_thread(context, &notices, move || on_chosen(path));
        }
        panel_input
    }
}

/// Returns the folder of the first dialog: the working directory, else the home folder.
fn first_folder() -> PathBuf {
    let working_folder = std::env::current_dir().ok();
    let working_folder = working_folder.filter(|folder| folder.parent().is_some());
    working_folder
        .or_else(platform::home_folder)
        .unwrap_or_else(|| PathBuf::from("/"))
}

/// Draws the dialog in a separate window, or inside the main window where the system has only
/// one.
fn show_in_window(
    context: &Context,
    language: Language,
    open: &mut OpenDialog,
    lcd: Option<Rect>,
    panel_input: &mut BrowserInput,
) -> DialogResult {
    let title = match open.request.choice {
        FileChoice::Open(..) => say::browser_open_title().text(language),
        FileChoice::Folder => say::browser_folder_title().text(language),
        FileChoice::Save(..) => say::browser_save_title().text(language),
    };
    if context.embed_viewports() {
        let mut is_open = true;
        let shown = egui::Window::new(title)
            .id(egui::Id::unique("files"))
            .open(&mut is_open)
            .fixed_size(DIALOG_SIZE)
            .constrain_to(stop_key_clearance::free_rect(
                context,
                Vec2::from(DIALOG_SIZE),
            ))
            .collapsible(false)
            .show(context, |ui| open.show(ui, language));
        let result = shown.and_then(|shown| shown.inner);
        return match result {
            Some(outcome) if is_open => outcome,
            _ => DialogResult::Cancelled,
        };
    }
    let (corner, size) = *open.geometry.get_or_insert_with(|| {
        let min_size = Vec2::from(MIN_SIZE);
        WindowScreen::of_main_window(context, lcd).place_window(
            None,
            Vec2::from(DIALOG_SIZE),
            min_size,
        )
    });
    let mut builder = ViewportBuilder::default()
        .with_title(format!("{title} - GSK980TD"))
        .with_app_id("gsk980td")
        .with_inner_size(size)
        .with_min_inner_size(Vec2::from(MIN_SIZE).min(size));
    if let Some(corner) = corner {
        builder = builder.with_position(corner);
    }
    let id = ViewportId::from_hash_of("files");
    context.show_viewport_immediate(id, builder, |ui, _| {
        let result = open.show(ui, language);
        ui.input(|input| {
            panel_input.has_focus = input.focused;
            let stops = input
                .events
                .iter()
                .filter(|event| keyboard::is_stop_or_release(event));
            panel_input.stop_events.extend(stops.cloned());
        });
        let closing = ui.input(|input| input.viewport().close_requested());
        match result {
            DialogResult::Open if closing => DialogResult::Cancelled,
            outcome => outcome,
        }
    })
}

impl OpenDialog {
    fn new(request: ChoiceRequest, folder: PathBuf, context: &Context) -> Self {
        let typed_name = match &request.choice {
            FileChoice::Open(..) | FileChoice::Folder => String::new(),
            FileChoice::Save(name, _) => name.clone(),
        };
        let mut open = Self {
            request,
            folder: PathBuf::new(),
            reading: None,
            listing: Ok(Vec::new()),
            typed_name,
            shows_all: false,
            overwrites: None,
            needs_focus: true,
            geometry: None,
        };
        open.enter_folder(folder, context);
        open
    }

    /// Reads a folder in a thread, because a slow disk must not delay the window, and shows
    /// it.
    fn enter_folder(&mut self, folder: PathBuf, context: &Context) {
        let (sender, reading) = bounded(1);
        self.reading = Some(reading);
        self.listing = Ok(Vec::new());
        self.folder.clone_from(&folder);
        let waker = context.clone();
        run_in_thread(context, &self.request.notices, move || {
            // A dialog that is closed by now reads nothing.
            let _ = sender.send(read_folder(&folder));
            waker.request_repaint();
            None
        });
    }

    fn show(&mut self, ui: &mut Ui, language: Language) -> DialogResult {
        if let Some(listing) = self.reading.as_ref().and_then(|it| it.try_recv().ok()) {
            self.listing = listing;
            self.reading = None;
        }
        let mut result = DialogResult::Open;
        Panel::top("files: folder").show(ui, |ui| self.show_folder_bar(ui, language));
        Panel::bottom("files: name").show(ui, |ui| {
            result = self.show_name_bar(ui, language);
        });
        egui::CentralPanel::default().show(ui, |ui| {
            if let DialogResult::Open = result {
                result = self.show_entries(ui, language);
            }
        });
        if ui.input(|input| input.key_pressed(Key::Escape)) {
            return DialogResult::Cancelled;
        }
        result
    }

    fn show_folder_bar(&mut self, ui: &mut Ui, language: Language) {
        let mut target = None;
        ui.horizontal(|ui| {
            let up = self.folder.parent().map(Path::to_owned);
            let label = say::browser_up().text(language);
            if ui.add_enabled(up.is_some(), Button::new(label)).clicked() {
                target = up;
            }
            if ui.button(say::browser_home().text(language)).clicked() {
                target = platform::home_folder();
            }
            ui.add(egui::Label::new(self.folder.display().to_string()).truncate());
        });
        if let Some(to) = target {
            self.enter_folder(to, ui.ctx());
        }
    }

    fn show_entries(&mut self, ui: &mut Ui, language: Language) -> DialogResult {
        let endings = match &self.request.choice {
            FileChoice::Open(_, endings) => endings.clone(),
            FileChoice::Folder => Vec::new(),
            FileChoice::Save(_, ending) => vec![*ending],
        };
        let entries = match &self.listing {
            Ok(entries) => entries,
            Err(error) => {
                ui.label(error.text(language));
                return DialogResult::Open;
            }
        };
        let shown: Vec<FolderEntry> = entries
            .iter()
            .filter(|entry| {
                !entry.is_file || self.shows_all || has_extension(&entry.name, &endings)
            })
            .cloned()
            .collect();
        if shown.is_empty() && self.reading.is_none() {
            ui.weak(say::browser_no_files().text(language));
        }
        let height = ui.spacing().interact_size.y;
        let name = say::browser_list_name().text(language);
        let list = focus::FocusList::begin(ui, "entries", &name, shown.len(), None);
        let entry_at = |at: usize| shown.get(at).cloned();
        // Moving the cursor takes over the file name. Enter chooses the file or enters the
        // folder.
        let moved = list
            .moved_row()
            .and_then(entry_at)
            .filter(|entry| entry.is_file);
        let entered = list
            .entered_row()
            .and_then(entry_at)
            .map(|entry| (entry, true));
        let mut clicked = entered.or(moved.map(|entry| (entry, false)));
        ScrollArea::vertical()
            .auto_shrink([false, false])
            .show_rows(ui, height, shown.len(), |ui, rows| {
                list.scroll_to_cursor(ui, rows.start, height);
                let rows = shown.iter().enumerate().skip(rows.start).take(rows.len());
                for (at, entry) in rows {
                    let sign = if entry.is_file { "  " } else { "▸ " };
                    let selected = entry.is_file && entry.name == self.typed_name;
                    let label = format!("{sign}{}", entry.name);
                    let row = focus::selectable_row(ui, selected, label);
                    if list.show_cursor(ui, at, &row) {
                        clicked = Some((entry.clone(), row.double_clicked()));
                    }
                }
            });
        let Some((entry, is_final)) = clicked else {
            return DialogResult::Open;
        };
        let path = self.folder.join(&entry.name);
        if !entry.is_file {
            self.enter_folder(path, ui.ctx());
            return DialogResult::Open;
        }
        self.overwrites = None;
        self.typed_name = entry.name;
        match is_final {
            true => self.choose_typed(ui.ctx()),
            false => DialogResult::Open,
        }
    }

    fn show_name_bar(&mut self, ui: &mut Ui, language: Language) -> DialogResult {
        let mut result = DialogResult::Open;
        if self.overwrites.is_some() {
            let words = say::browser_file_exists().text(language);
            ui.colored_label(ui.visuals().warn_fg_color, words);
        }
        ui.horizontal(|ui| {
            ui.label(say::browser_file_name().text(language));
            let line = TextEdit::singleline(&mut self.typed_name);
            let line = ui.add(line.desired_width(ui.available_width() - 230.0));
            if core::mem::take(&mut self.needs_focus) {
                line.request_focus();
            }
            if line.changed() {
                self.overwrites = None;
            }
            let entered = line.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            let label = match (&self.request.choice, &self.overwrites) {
                (FileChoice::Open(..), _) => say::window_open().text(language),
                (FileChoice::Folder, _) => say::browser_take_folder().text(language),
                (FileChoice::Save(..), None) => say::window_save().text(language),
                (FileChoice::Save(..), Some(_)) => say::browser_replace().text(language),
            };
            let has_choice =
                !self.typed_name.is_empty() || self.request.choice == FileChoice::Folder;
            let button = ui.add_enabled(has_choice, Button::new(label));
            if button.clicked() || entered && has_choice {
                result = self.choose_typed(ui.ctx());
            }
            if ui.button(say::window_cancel().text(language)).clicked() {
                result = DialogResult::Cancelled;
            }
            ui.checkbox(&mut self.shows_all, say::window_all_files().text(language));
        });
        result
    }

    /// Returns the file whose name was typed as chosen. Enters a folder of this name instead.
    fn choose_typed(&mut self, context: &Context) -> DialogResult {
        if self.request.choice == FileChoice::Folder && self.typed_name.is_empty() {
            return DialogResult::Chosen(self.folder.clone());
        }
        let mut path = self.folder.join(self.typed_name.trim());
        if path.is_dir() {
            self.typed_name.clear();
            self.enter_folder(path, context);
            return DialogResult::Open;
        }
        if let FileChoice::Save(_, ending) = &self.request.choice {
            if path.extension().is_none() {
                path.set_extension(ending);
            }
            if path.exists() && self.overwrites.as_ref() != Some(&path) {
                self.overwrites = Some(path);
                return DialogResult::Open;
            }
        }
        DialogResult::Chosen(path)
    }
}

/// Whether a file name has one of these extensions, in upper or lower case.
fn has_extension(name: &str, endings: &[&str]) -> bool {
    let ending = Path::new(name).extension();
    ending.is_some_and(|ending| {
        endings
            .iter()
            .any(|wanted| ending.eq_ignore_ascii_case(wanted))
    })
}

/// Reads the content of a folder, folders first, without names that begin with a dot.
fn read_folder(folder: &Path) -> FolderListing {
    let to_message =
        |error: std::io::Error| say::subject_reason(folder.display(), say::as_written(error));
    let mut entries = Vec::new();
    for path in platform::list(folder).map_err(to_message)? {
        let Some(name) = path.file_name().and_then(|name| name.to_str()) else {
            continue;
        };
        if !name.starts_with('.') {
            entries.push(FolderEntry {
                is_file: !platform::path_facts(&path).is_ok_and(|facts| facts.is_folder),
                name: name.to_owned(),
            });
        }
    }
    entries.sort();
    Ok(entries)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_come_first_and_extensions_ignore_case() {
        let folder = gsk_tests::test_folder("browser");
        std::fs::create_dir_all(folder.join("zz")).expect("made");
        for name in ["b.nc", "a.txt", ".hidden"] {
            std::fs::write(folder.join(name), "").expect("written");
        }
        let names: Vec<_> = read_folder(&folder)
            .expect("read")
            .into_iter()
            .map(|entry| entry.name)
            .collect();
        assert_eq!(names, ["zz", "a.txt", "b.nc"]);
        assert!(has_extension("A.CNC", &["cnc"]) && !has_extension("cnc", &["cnc"]));
        assert!(read_folder(&folder.join("none")).is_err());
    }
}
