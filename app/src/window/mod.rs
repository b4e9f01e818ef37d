//! The window: the panel as it is painted and operated. It knows nothing of
//! threads and of eframe; a test drives it as the program does.

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

/// Title of the window.
pub const TITLE: &str = "GSK980TD";
/// Height of the bar above and of the line below, points.
const BAR: f32 = 28.0;
/// Height of the line of messages, points.
const STATUS: f32 = 22.0;

/// The window's state.
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
    /// Where the panel lies, by its areas, and the pointer, where nothing covers it.
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
    /// Which way the axis keys move, for their tips.
    reversed: KeysReversed,
    /// The kernel hands out the LCD in the other language, too.
    translates: bool,
    sounds: Sounds,
}

/// The control model, and the one that was asked for.
#[derive(Clone, Copy, Debug, Default)]
struct Models {
    shown: ModelId,
    asked: Option<ModelId>,
    /// Whether it can be changed.
    changeable: bool,
}

impl Window {
    /// A window on a console.
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

    /// Says which control model this is, and whether another one may be asked for.
    pub const fn set_model(&mut self, shown: ModelId, changeable: bool) {
        self.models = Models {
            shown,
            asked: None,
            changeable,
        };
    }

    /// The model that was asked for.
    pub const fn take_model(&mut self) -> Option<ModelId> {
        self.models.asked.take()
    }

    /// Opens a project and lists what differs from the control.
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

    /// What the control is to take over while it is off.
    pub const fn take_chosen(&mut self) -> Option<Chosen> {
        self.views.project().take_chosen()
    }

    /// From now on the panel is painted: for a real display.
    pub const fn paint_panel(&mut self) {
        self.face.turn_on();
    }

    /// What is remembered for the next start.
    pub const fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Remembers how large the window is.
    pub fn remember_place(&mut self, context: &egui::Context) {
        if let Some(place) = context.input(|input| layout::floating::place(input.viewport())) {
            self.settings.layouts.window = Some(place);
        }
    }

    /// Says something on the line of messages.
    pub fn say(&mut self, said: impl Into<gsk_messages::Message>) {
        self.message = Some(Message::Said(said.into()));
    }

    /// Lessons of a teacher beside those of the program, and what is wrong with others.
    pub fn set_lessons(&mut self, lessons: Lessons) {
        let view = self.views.lessons();
        view.set_lessons(lessons.lessons, lessons.wrong);
    }

    /// Opens a program file, or a project by its `project.gpr`; what comes of it is said on
    /// the line of messages.
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

    /// Says that the kernel has ended without being asked to.
    pub fn kernel_gone(&mut self) {
        self.message = Some(Message::KernelGone);
        self.close_without_asking();
    }

    /// A request to close it is not questioned any more.
    pub const fn close_without_asking(&mut self) {
        self.questions.let_close();
    }

    /// The window's title.
    pub fn title(&self) -> String {
        badge::title(self.models.shown.name(), self.board())
    }

    /// State of the board that moves real slides, if there is one.
    fn board(&self) -> Option<LinkState> {
        self.picture.as_ref().and_then(|picture| picture.board)
    }

    /// The picture that is shown.
    pub const fn picture(&self) -> Option<&Snapshot> {
        self.picture.as_ref()
    }

    /// Lets everything go: the window is hidden or has lost the focus.
    pub fn let_go(&mut self) {
        self.pointing.forget();
        self.long_press.forget();
        let changes = self.held.release_all();
        self.console.watch.set_holders(self.held.holders());
        self.send(&changes);
    }

    /// Draws the window and takes its input.
    pub fn ui(&mut self, ui: &mut Ui) {
        // Before the key that closes it is taken.
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
        // What the panel leaves free is the colour that a picture is cleared with.
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
            // The kernel lets go of keys when it hears nothing of the window, or when the
            // display does not show them held.
            self.console.send(Command::Alive);
            ui.ctx().request_repaint_after(QUERY_INTERVAL);
        }
    }

    /// Pieces of the path in the machine view.
    pub fn pieces_of_path(&mut self) -> usize {
        self.views.lathe().pieces()
    }

    /// Whether RESET may have something to stop; unknown is yes.
    fn may_stop(&self) -> bool {
        self.picture.as_ref().is_none_or(|it| {
            let board = matches!(it.board, Some(LinkState::Moving | LinkState::Homing));
            it.moves || board || matches!(it.run, RunState::Run | RunState::Hold)
        })
    }

    /// The PC keyboard; while a text is being typed the panel has its stops alone. `menu`: one
    /// was open when the keys came.
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

    /// An axis key was pressed where the keys of the cursor move in a list: no axis moves.
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

    /// What help says of the alarm that stands.
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

/// A key as it is printed, in brackets: `[超程解除]`.
fn key_label(key: Key) -> String {
    let printed = key.row().legend.iter();
    let shown = printed.filter(|line| !line.is_ascii()).copied();
    let shown: String = shown.collect();
    match shown.is_empty() {
        true => format!("[{}]", key.row().legend.concat()),
        false => format!("[{shown}]"),
    }
}
