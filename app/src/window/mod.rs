//! Draws the main window (bars, panes, panel, dialogs) and dispatches its input. It uses
//! neither threads nor eframe: tests drive it as the program does.

mod alarm_line;
mod answers;
pub mod app;
mod at_end;
mod badge;
mod clear;
mod face;
mod figures;
mod files;
mod first_start;
mod focus;
pub mod fonts;
mod hearing;
mod held;
mod help;
mod key_map;
mod keyboard;
pub mod layout;
mod lcd;
mod long_press;
mod message;
mod news;
mod opener;
mod panel_view;
mod placing;
mod pointing;
mod questions;
mod reader;
pub mod refusal;
mod room;
mod samples;
mod settings;
mod status;
mod surroundings;
mod tips;
mod top_bar;
pub mod view;
mod views;
mod zoom;

use std::path::PathBuf;

use egui::{Event, Frame, Margin, Panel, Pos2, Ui};
use gsk_core::model::ModelId;
use gsk_core::operation::RunState;
use gsk_help::{Subject, Topic, topic};
use gsk_link::LinkState;
use gsk_panel::alarm_log::AlarmRecord;
use gsk_panel::keys::Key;

use crate::files::lessons::Lessons;
use crate::input_watch::QUERY_INTERVAL;
use crate::kernel::{Command, Console, KeysReversed, Snapshot};
use crate::platform;
use crate::sound::Sounds;
use files::Browser;
use first_start::FirstStart;
use held::{Change, Held};
use help::Help;
use keyboard::PcAction;
use long_press::LongPress;
use message::Message;
use opener::Opener;
use pointing::Pointing;
use questions::Questions;
pub use settings::Settings;
use view::View;
use views::Views;
pub use views::project::Chosen;

pub use key_map::pc_name;

pub const TITLE: &str = "GSK980TD";
/// Height of the bar at the top, points.
const BAR: f32 = 28.0;
/// Height of the message line at the bottom, points.
const STATUS: f32 = 22.0;

/// The state of the main window, from one frame to the next.
pub struct Window {
    console: Console,
    picture: Option<Snapshot>,
    settings: Settings,
    opened: Option<PathBuf>,
    message: Option<Message>,
    held: Held<Key>,
    pointing: Pointing,
    opener: Opener,
    key_map: bool,
    help: Help,
    /// Where each area of the panel was drawn in the last frame.
    placed: Vec<placing::View>,
    pointer: Option<Pos2>,
    questions: Questions,
    browser: Browser,
    views: Views,
    lcd: lcd::Lcd,
    face: face::Face,
    models: Models,
    first_start: Option<FirstStart>,
    long_press: LongPress,
    /// Directions of the axis keys that the machine reverses, for their tool tips.
    reversed: KeysReversed,
    /// Whether the kernel already sends the LCD in the other language, too.
    translates: bool,
    sounds: Sounds,
}

/// The control model in use and the request for another one.
#[derive(Clone, Copy, Debug, Default)]
struct Models {
    shown: ModelId,
    asked: Option<ModelId>,
    /// Whether the operator can choose another model.
    changeable: bool,
}

impl Window {
    /// Creates a window that is connected to the kernel's `console`.
    pub fn new(console: Console, settings: Settings) -> Self {
        let opener = Opener::new(console.clone());
        let views = Views::new(
            &console,
            settings.solid,
            settings.lessons.clone(),
            settings.transfer.clone(),
            settings.projects.clone(),
        );
        Self {
            console,
            picture: None,
            settings,
            opened: None,
            message: None,
            held: Held::default(),
            pointing: Pointing::default(),
            opener,
            key_map: false,
            help: Help::default(),
            placed: Vec::new(),
            pointer: None,
            questions: Questions::default(),
            browser: Browser::default(),
            views,
            lcd: lcd::Lcd::default(),
            face: face::Face::default(),
            models: Models::default(),
            first_start: None,
            long_press: LongPress::default(),
            reversed: KeysReversed::default(),
            translates: false,
            sounds: Sounds::default(),
        }
    }

    /// Sets the name of the control model in use. `changeable` allows the operator to request
    /// another one.
    pub const fn set_model(&mut self, shown: ModelId, changeable: bool) {
        self.models = Models {
            shown,
            asked: None,
            changeable,
        };
    }

    /// Takes the control model that the operator requested since the last call.
    pub const fn take_model(&mut self) -> Option<ModelId> {
        self.models.asked.take()
    }

    /// Opens the project in `folder` and lists its differences from the control.
    pub fn compare(&mut self, context: &egui::Context, folder: PathBuf) {
        self.views.project().open(folder, true, context);
        self.show_view(View::Project);
    }

    fn show_view(&mut self, view: View) {
        let layouts = &mut self.settings.layouts;
        if !layouts.is_open(view) {
            layouts.toggle(view);
        } else if layouts.docked().contains(&view) {
            layouts.bring(Some(view));
        }
    }

    /// Takes the project files that the operator chose to take over. The caller turns the
    /// control off to do so.
    pub const fn take_chosen(&mut self) -> Option<Chosen> {
        self.views.project().take_chosen()
    }

    /// Enables the drawing of the panel. Tests without a display leave it off.
    pub const fn paint_panel(&mut self) {
        self.face.turn_on();
    }

    /// What is stored for the next start.
    pub const fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Stores the size and position of the window in the settings.
    pub fn remember_place(&mut self, context: &egui::Context) {
        if let Some(place) = context.input(|input| layout::floating::place(input.viewport())) {
            self.settings.layouts.window = Some(place);
        }
    }

    /// Shows `said` on the message line.
    pub fn say(&mut self, said: impl Into<gsk_messages::Message>) {
        self.message = Some(Message::Said(said.into()));
    }

    /// Sets the lessons of a teacher, which are listed with those of the program, and the
    /// errors of the lessons that cannot be used.
    pub fn set_lessons(&mut self, lessons: Lessons) {
        let view = self.views.lessons();
        view.set_lessons(lessons.lessons, lessons.wrong);
    }

    /// Opens a program file, or a project by its `project.gpr`. The result appears on the
    /// message line.
    pub fn open(&mut self, context: &egui::Context, path: PathBuf) {
        let is_project = path
            .file_name()
            .is_some_and(|name| name == crate::project::HEAD);
        if let Some(folder) = path
            .parent()
            .filter(|_| is_project && platform::has_folders())
        {
            self.compare(context, folder.to_owned());
            return;
        }
        self.opener.open(path, context);
    }

    /// Shows that the kernel has ended unexpectedly, and lets the window close.
    pub fn kernel_gone(&mut self) {
        self.message = Some(Message::KernelGone);
        self.close_without_asking();
    }

    /// Lets the window close without the question about unsaved work.
    pub const fn close_without_asking(&mut self) {
        self.questions.let_close();
    }

    pub fn title(&self) -> String {
        badge::title(self.models.shown.name(), self.board())
    }

    /// State of the board that moves real slides; `None` without a board.
    fn board(&self) -> Option<LinkState> {
        self.picture.as_ref().and_then(|picture| picture.board)
    }

    /// The latest state of the control that the window shows; `None` before the first one.
    pub const fn picture(&self) -> Option<&Snapshot> {
        self.picture.as_ref()
    }

    /// Releases all held keys: the window is hidden or has lost the focus.
    pub fn let_go(&mut self) {
        self.pointing.forget();
        self.long_press.forget();
        let changes = self.held.release_all();
        self.console.watch.set_holders(self.held.holders());
        self.send(&changes);
    }

    /// Draws one frame and handles its input.
    pub fn ui(&mut self, ui: &mut Ui) {
        // Checked here because the key that closes the menu is consumed later.
        let menu = egui::Popup::is_any_open(ui.ctx());
        self.receive();
        self.follow_sound();
        let why_not = self.model_choice().why_not;
        self.views.project().set_why_not(why_not);
        let only_docks = ui.ctx().embed_viewports();
        self.settings.layouts.set_only_docks(only_docks);
        if self.views.lessons().take_begun() && !self.settings.layouts.is_open(View::Machine) {
            // The learner sees what his keys do to the part.
            self.settings.layouts.dock_beside(View::Machine);
        }
        self.views.follow(ui.ctx(), &self.settings.layouts);
        self.take_files(ui);
        zoom::follow(ui.ctx(), &self.settings);
        let language = self.settings.language;
        badge::show(ui, "panel", self.board(), language);
        let slim = Frame::new()
            .fill(egui::Color32::from_gray(34))
            .inner_margin(Margin::symmetric(8, 0));
        let bar = Panel::top("bar")
            .exact_size(BAR)
            .frame(slim)
            .show_separator_line(false);
        let asked = bar
            .show(ui, |ui| {
                let opened = self.opened.as_ref();
                let picture = self.picture.as_ref();
                let models = self.model_choice();
                top_bar::show(ui, &self.settings, opened, picture, &models)
            })
            .inner;
        let line = Panel::bottom("status")
            .exact_size(STATUS)
            .frame(slim)
            .show_separator_line(false);
        line.show(ui, |ui| self.status(ui));
        // The central panel has no frame: the clear colour fills what the panel leaves free.
        egui::CentralPanel::default()
            .frame(Frame::NONE)
            .show(ui, |ui| {
                if !self.asks_first(ui) {
                    self.panes(ui);
                }
            });
        clear::remember(ui.ctx(), &self.placed);
        self.settings.solid = self.views.lathe().is_solid();
        let finished = self.views.lessons().finished();
        if self.settings.lessons != *finished {
            self.settings.lessons.clone_from(finished);
        }
        let transfer = self.views.transfer().remembered();
        if self.settings.transfer != *transfer {
            self.settings.transfer.clone_from(transfer);
        }
        let projects = self.views.project().remembered();
        if self.settings.projects != *projects {
            self.settings.projects.clone_from(projects);
        }
        if let Some(asked) = asked {
            if asked.shows_something() {
                self.first_start = None;
            }
            self.answer(asked, ui);
        }
        if self.key_map {
            self.key_map = key_map::show(ui.ctx(), language, &self.placed);
        }
        let picture = self.picture.as_ref();
        match self.help.show(ui.ctx(), language, picture, &self.placed) {
            Some(help::Asked::Lesson(order)) => self.console.send(Command::Lesson(order)),
            Some(help::Asked::Block(occurrence)) => self.show_block(*occurrence),
            None => {}
        }
        let picture = self.picture.as_ref();
        let unsaved = self.views.unsaved();
        self.questions
            .show(ui.ctx(), language, picture, &self.console, unsaved);
        let (board, lcd) = (self.board(), self.lcd.place());
        let beside = self.browser.show(ui.ctx(), language, lcd);
        self.keyboard(ui, menu);
        self.typed(&beside.stops);
        let layouts = &mut self.settings.layouts;
        let typed = self
            .views
            .show_floating(ui.ctx(), language, board, lcd, layouts);
        if typed.jogs_in_list {
            self.axis_key_in_list();
        }
        self.typed(&typed.events);
        if let Some(request) = self.views.take_sample() {
            self.opener.open_sample(request, ui.ctx());
        }
        focus::leave_keys(ui.ctx());
        let focused = typed.focused || beside.focused || ui.input(|input| input.focused);
        if !focused {
            self.let_go();
        }
        self.console.watch.set_holders(self.held.holders());
        if self.held.any() {
            // The kernel releases all keys when it receives no `Alive` command from the
            // window, or when the display does not show the keys as held.
            self.console.send(Command::Alive);
            ui.ctx().request_repaint_after(QUERY_INTERVAL);
        }
    }

    /// Count of the pieces of the tool path in the machine view.
    pub fn pieces_of_path(&mut self) -> usize {
        self.views.lathe().pieces()
    }

    /// Whether RESET may have something to stop; true while the state is unknown.
    fn may_stop(&self) -> bool {
        self.picture.as_ref().is_none_or(|it| {
            let board = matches!(it.board, Some(LinkState::Moving | LinkState::Homing));
            it.moves || board || matches!(it.run, RunState::Run | RunState::Hold)
        })
    }

    /// Handles the PC keyboard. While a text field has the focus, only the stop keys reach the
    /// panel. `menu`: a menu was open when the keys arrived.
    fn keyboard(&mut self, ui: &Ui, menu: bool) {
        let events: Vec<Event> = ui.input(|input| input.events.clone());
        if ui.ctx().text_edit_focused() || self.first_start.is_some() {
            let stops: Vec<Event> = events.into_iter().filter(keyboard::stops).collect();
            self.typed(&stops);
            return;
        }
        zoom::typed(ui.ctx(), &events, &mut self.settings);
        let mut events = keyboard::beside_focus(ui.ctx(), events);
        if keyboard::beside_keeper(ui.ctx(), &mut events) {
            self.axis_key_in_list();
        }
        if menu {
            events = keyboard::beside_menu(events, self.may_stop());
        }
        if let Some(view) = view::toggled(&events) {
            self.settings.layouts.toggle(view);
        }
        if let Some(layout) = layout::chosen(&events) {
            self.settings.layouts.choose(layout);
        }
        self.typed(&events);
    }

    /// Shows that an axis key moved the cursor of a list and no axis.
    fn axis_key_in_list(&mut self) {
        self.message = Some(Message::KeyRefused(
            gsk_messages::say::window_axis_key_in_list(),
        ));
    }

    /// Opens the program view at the block that raised an alarm.
    fn show_block(&mut self, occurrence: AlarmRecord) {
        let Some(source) = occurrence.alarm.source else {
            return;
        };
        let program = self.views.program();
        program.show_block(source.program, source.line, occurrence.block);
        self.show_view(View::Program);
    }

    /// The help topic of the current alarm.
    fn standing(&self) -> Option<&'static Topic> {
        let alarm = self.picture.as_ref()?.alarm.as_ref()?;
        topic(Subject::Alarm(alarm.row()?.number))
    }

    fn typed(&mut self, events: &[Event]) {
        for event in events {
            match keyboard::action(event) {
                Some(PcAction::Help) => {
                    let about = self.pointer.and_then(|at| self.pointed_at(at));
                    self.help.ask(about.or_else(|| self.standing()));
                }
                Some(PcAction::Turn(graduations)) => self.console.send(Command::Turn(graduations)),
                Some(PcAction::Type(character)) => {
                    self.held.forget_kept();
                    self.console.send(Command::Type(character));
                }
                Some(PcAction::Press(holder, key)) => {
                    let changes = self.held.press(holder, key);
                    self.send(&changes);
                }
                Some(PcAction::Release(holder)) => {
                    let changes = self.held.set(holder, None);
                    self.send(&changes);
                }
                None => {}
            }
        }
    }

    fn send(&self, changes: &[Change<Key>]) {
        for change in changes {
            self.console.send(Command::Key {
                key: change.key,
                down: change.down,
            });
        }
    }
}

/// The key with its printed legend in brackets: `[超程解除]`.
fn key_label(key: Key) -> String {
    let printed = key.row().legend.iter();
    let shown = printed.filter(|line| !line.is_ascii()).copied();
    let shown: String = shown.collect();
    match shown.is_empty() {
        true => format!("[{}]", key.row().legend.concat()),
        false => format!("[{shown}]"),
    }
}
