//! The file dialog of this program in a separate window: folders, files, a field for the name.

use std::path::{Path, PathBuf};

use crossbeam::channel::{Receiver, bounded};
use egui::{
    Button, Context, Event, Key, Panel, Pos2, Rect, ScrollArea, TextEdit, Ui, Vec2,
    ViewportBuilder, ViewportId,
};

use super::{Ask, Asked, Wanted, beside};
use crate::platform;
use crate::window::layout::floating::Screen;
use crate::window::{clear, focus, keyboard};
use gsk_messages::{Language, Message, say};

/// Size of the dialog, points.
const SIZE: [f32; 2] = [640.0, 460.0];
const LEAST: [f32; 2] = [420.0, 260.0];

/// An entry of a folder.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Entry {
    /// First field: folders sort before files.
    is_file: bool,
    name: String,
}

/// The content of a folder, or why it cannot be read.
type Listing = Result<Vec<Entry>, Message>;

/// The dialog while it is open.
struct Open {
    ask: Ask,
    folder: PathBuf,
    reading: Option<Receiver<Listing>>,
    listing: Listing,
    /// The content of the name field.
    typed: String,
    /// Whether files with other extensions are shown, too.
    all: bool,
    /// A file that would be overwritten.
    overwrites: Option<PathBuf>,
    focus: bool,
    /// Position and size with which its window opened.
    placed: Option<(Option<Pos2>, Vec2)>,
}

/// Input of the dialog's window that belongs to the panel.
#[derive(Debug, Default)]
pub struct Typed {
    /// Whether the dialog's window has the focus.
    pub focused: bool,
    /// Feed hold, emergency stop and key releases.
    pub stops: Vec<Event>,
}

/// The file dialog.
#[derive(Default)]
pub struct Browser {
    open: Option<Open>,
    /// The folder that was shown last.
    last: Option<PathBuf>,
}

/// The result of the dialog in one frame.
enum Outcome {
    Stays,
    GivenUp,
    Chosen(PathBuf),
}

impl Browser {
    /// Draws the dialog, if a file is to be chosen. Its window covers no key that stops the
    /// machine and, if it fits, leaves the LCD visible (WINDOW-25).
    pub fn show(&mut self, context: &Context, language: Language, lcd: Option<Rect>) -> Typed {
        let mut typed = Typed::default();
        if self.open.is_none()
            && let Some(ask) = Asked::of(context).take()
        {
            let folder = self.last.clone().unwrap_or_else(first_folder);
            self.open = Some(Open::new(ask, folder, context));
        }
        let Some(open) = &mut self.open else {
            return typed;
        };
        let outcome = in_window(context, language, open, lcd, &mut typed);
        if matches!(outcome, Outcome::Stays) {
            return typed;
        }
        let Some(open) = self.open.take() else {
            return typed;
        };
        self.last = Some(open.folder);
        if let Outcome::Chosen(path) = outcome {
            let Ask { then, say, .. } = open.ask;
            beside(context, &say, move || then(path));
        }
        typed
    }
}

/// The folder of the first dialog: the working directory, else the home folder.
fn first_folder() -> PathBuf {
    let called = std::env::current_dir().ok();
    let called = called.filter(|folder| folder.parent().is_some());
    called
        .or_else(platform::home_folder)
        .unwrap_or_else(|| PathBuf::from("/"))
}

/// Draws the dialog in a separate window, or inside the main window where the system has only
/// one.
fn in_window(
    context: &Context,
    language: Language,
    open: &mut Open,
    lcd: Option<Rect>,
    typed: &mut Typed,
) -> Outcome {
    let title = match open.ask.wanted {
        Wanted::Open(..) => say::browser_open_title().text(language),
        Wanted::Folder => say::browser_folder_title().text(language),
        Wanted::Save(..) => say::browser_save_title().text(language),
    };
    if context.embed_viewports() {
        let mut stays = true;
        let shown = egui::Window::new(title)
            .id(egui::Id::unique("files"))
            .open(&mut stays)
            .fixed_size(SIZE)
            .constrain_to(clear::free(context, Vec2::from(SIZE)))
            .collapsible(false)
            .show(context, |ui| open.show(ui, language));
        let outcome = shown.and_then(|shown| shown.inner);
        return match outcome {
            Some(outcome) if stays => outcome,
            _ => Outcome::GivenUp,
        };
    }
    let (corner, size) = *open.placed.get_or_insert_with(|| {
        let least = Vec2::from(LEAST);
        Screen::of(context, lcd).open(None, Vec2::from(SIZE), least)
    });
    let mut builder = ViewportBuilder::default()
        .with_title(format!("{title} - GSK980TD"))
        .with_app_id("gsk980td")
        .with_inner_size(size)
        .with_min_inner_size(Vec2::from(LEAST).min(size));
    if let Some(corner) = corner {
        builder = builder.with_position(corner);
    }
    let id = ViewportId::from_hash_of("files");
    context.show_viewport_immediate(id, builder, |ui, _| {
        let outcome = open.show(ui, language);
        ui.input(|input| {
            typed.focused = input.focused;
            let stops = input.events.iter().filter(|event| keyboard::stops(event));
            typed.stops.extend(stops.cloned());
        });
        let closing = ui.input(|input| input.viewport().close_requested());
        match outcome {
            Outcome::Stays if closing => Outcome::GivenUp,
            outcome => outcome,
        }
    })
}

impl Open {
    fn new(ask: Ask, folder: PathBuf, context: &Context) -> Self {
        let typed = match &ask.wanted {
            Wanted::Open(..) | Wanted::Folder => String::new(),
            Wanted::Save(name, _) => name.clone(),
        };
        let mut open = Self {
            ask,
            folder: PathBuf::new(),
            reading: None,
            listing: Ok(Vec::new()),
            typed,
            all: false,
            overwrites: None,
            focus: true,
            placed: None,
        };
        open.go(folder, context);
        open
    }

    /// Reads a folder in a thread: a slow disk does not delay the window.
    fn go(&mut self, folder: PathBuf, context: &Context) {
        let (deliver, reading) = bounded(1);
        self.reading = Some(reading);
        self.listing = Ok(Vec::new());
        self.folder.clone_from(&folder);
        let waker = context.clone();
        beside(context, &self.ask.say, move || {
            // A dialog that is closed by now reads nothing.
            let _ = deliver.send(listing(&folder));
            waker.request_repaint();
            None
        });
    }

    fn show(&mut self, ui: &mut Ui, language: Language) -> Outcome {
        if let Some(read) = self.reading.as_ref().and_then(|it| it.try_recv().ok()) {
            self.listing = read;
            self.reading = None;
        }
        let mut outcome = Outcome::Stays;
        Panel::top("files: folder").show(ui, |ui| self.folder_bar(ui, language));
        Panel::bottom("files: name").show(ui, |ui| {
            outcome = self.name_bar(ui, language);
        });
        egui::CentralPanel::default().show(ui, |ui| {
            if let Outcome::Stays = outcome {
                outcome = self.entries(ui, language);
            }
        });
        if ui.input(|input| input.key_pressed(Key::Escape)) {
            return Outcome::GivenUp;
        }
        outcome
    }

    fn folder_bar(&mut self, ui: &mut Ui, language: Language) {
        let mut to = None;
        ui.horizontal(|ui| {
            let up = self.folder.parent().map(Path::to_owned);
            let words = say::browser_up().text(language);
            if ui.add_enabled(up.is_some(), Button::new(words)).clicked() {
                to = up;
            }
            if ui.button(say::browser_home().text(language)).clicked() {
                to = platform::home_folder();
            }
            ui.add(egui::Label::new(self.folder.display().to_string()).truncate());
        });
        if let Some(to) = to {
            self.go(to, ui.ctx());
        }
    }

    fn entries(&mut self, ui: &mut Ui, language: Language) -> Outcome {
        let endings = match &self.ask.wanted {
            Wanted::Open(_, endings) => endings.clone(),
            Wanted::Folder => Vec::new(),
            Wanted::Save(_, ending) => vec![*ending],
        };
        let entries = match &self.listing {
            Ok(entries) => entries,
            Err(said) => {
                ui.label(said.text(language));
                return Outcome::Stays;
            }
        };
        let shown: Vec<Entry> = entries
            .iter()
            .filter(|entry| !entry.is_file || self.all || ends_so(&entry.name, &endings))
            .cloned()
            .collect();
        if shown.is_empty() && self.reading.is_none() {
            ui.weak(say::browser_no_files().text(language));
        }
        let height = ui.spacing().interact_size.y;
        let name = say::browser_list_name().text(language);
        let list = focus::List::begin(ui, "entries", &name, shown.len(), None);
        let of = |at: usize| shown.get(at).cloned();
        // Moving the cursor takes over the file name. Enter chooses the file or enters the
        // folder.
        let moved = list.moved().and_then(of).filter(|entry| entry.is_file);
        let entered = list.entered().and_then(of).map(|entry| (entry, true));
        let mut clicked = entered.or(moved.map(|entry| (entry, false)));
        ScrollArea::vertical()
            .auto_shrink([false, false])
            .show_rows(ui, height, shown.len(), |ui, rows| {
                list.follow(ui, rows.start, height);
                let rows = shown.iter().enumerate().skip(rows.start).take(rows.len());
                for (at, entry) in rows {
                    let sign = if entry.is_file { "  " } else { "▸ " };
                    let selected = entry.is_file && entry.name == self.typed;
                    let words = format!("{sign}{}", entry.name);
                    let row = focus::row(ui, selected, words);
                    if list.row(ui, at, &row) {
                        clicked = Some((entry.clone(), row.double_clicked()));
                    }
                }
            });
        let Some((entry, twice)) = clicked else {
            return Outcome::Stays;
        };
        let path = self.folder.join(&entry.name);
        if !entry.is_file {
            self.go(path, ui.ctx());
            return Outcome::Stays;
        }
        self.overwrites = None;
        self.typed = entry.name;
        match twice {
            true => self.choose(ui.ctx()),
            false => Outcome::Stays,
        }
    }

    fn name_bar(&mut self, ui: &mut Ui, language: Language) -> Outcome {
        let mut outcome = Outcome::Stays;
        if self.overwrites.is_some() {
            let words = say::browser_file_exists().text(language);
            ui.colored_label(ui.visuals().warn_fg_color, words);
        }
        ui.horizontal(|ui| {
            ui.label(say::browser_file_name().text(language));
            let line = TextEdit::singleline(&mut self.typed);
            let line = ui.add(line.desired_width(ui.available_width() - 230.0));
            if core::mem::take(&mut self.focus) {
                line.request_focus();
            }
            if line.changed() {
                self.overwrites = None;
            }
            let entered = line.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            let words = match (&self.ask.wanted, &self.overwrites) {
                (Wanted::Open(..), _) => say::window_open().text(language),
                (Wanted::Folder, _) => say::browser_take_folder().text(language),
                (Wanted::Save(..), None) => say::window_save().text(language),
                (Wanted::Save(..), Some(_)) => say::browser_replace().text(language),
            };
            let meant = !self.typed.is_empty() || self.ask.wanted == Wanted::Folder;
            let button = ui.add_enabled(meant, Button::new(words));
            if button.clicked() || entered && meant {
                outcome = self.choose(ui.ctx());
            }
            if ui.button(say::window_cancel().text(language)).clicked() {
                outcome = Outcome::GivenUp;
            }
            ui.checkbox(&mut self.all, say::window_all_files().text(language));
        });
        outcome
    }

    /// Chooses the file in the name field. A folder is entered instead.
    fn choose(&mut self, context: &Context) -> Outcome {
        if self.ask.wanted == Wanted::Folder && self.typed.is_empty() {
            return Outcome::Chosen(self.folder.clone());
        }
        let mut path = self.folder.join(self.typed.trim());
        if path.is_dir() {
            self.typed.clear();
            self.go(path, context);
            return Outcome::Stays;
        }
        if let Wanted::Save(_, ending) = &self.ask.wanted {
            if path.extension().is_none() {
                path.set_extension(ending);
            }
            if path.exists() && self.overwrites.as_ref() != Some(&path) {
                self.overwrites = Some(path);
                return Outcome::Stays;
            }
        }
        Outcome::Chosen(path)
    }
}

/// Whether a name has one of these extensions, in either case.
fn ends_so(name: &str, endings: &[&str]) -> bool {
    let ending = Path::new(name).extension();
    ending.is_some_and(|ending| {
        endings
            .iter()
            .any(|wanted| ending.eq_ignore_ascii_case(wanted))
    })
}

/// Reads the content of a folder, folders first, without names that begin with a dot.
fn listing(folder: &Path) -> Listing {
    let wrong =
        |error: std::io::Error| say::subject_reason(folder.display(), say::as_written(error));
    let mut entries = Vec::new();
    for path in platform::list(folder).map_err(wrong)? {
        let Some(name) = path.file_name().and_then(|name| name.to_str()) else {
            continue;
        };
        if !name.starts_with('.') {
            entries.push(Entry {
                is_file: !platform::facts(&path).is_ok_and(|facts| facts.is_folder),
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
    fn folders_stand_first_and_endings_count_in_either_case() {
        let folder = crate::files::test_folder("browser");
        std::fs::create_dir_all(folder.join("zz")).expect("made");
        for name in ["b.nc", "a.txt", ".hidden"] {
            std::fs::write(folder.join(name), "").expect("written");
        }
        let names: Vec<_> = listing(&folder)
            .expect("read")
            .into_iter()
            .map(|entry| entry.name)
            .collect();
        assert_eq!(names, ["zz", "a.txt", "b.nc"]);
        assert!(ends_so("A.CNC", &["cnc"]) && !ends_so("cnc", &["cnc"]));
        assert!(listing(&folder.join("none")).is_err());
    }
}
