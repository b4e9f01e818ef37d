//! The window: the panel as it is painted and operated. It knows nothing of
//! threads and of eframe; a test drives it as the program does.

mod alarm_line;
pub mod app;
mod badge;
mod clear;
mod face;
mod figures;
mod files;
mod first_start;
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
use gsk_panel::keys::Key;
use gsk_panel::occurrences::Occurrence;

use crate::files::lessons::Lessons;
use crate::kernel::{Command, Console, KeysReversed, LessonOrder, Notice, Snapshot};
use crate::platform;
use crate::sound::Sounds;
use files::Browser;
use first_start::FirstStart;
use gsk_messages::say;
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

    /// The models to choose from, and why not now.
    fn model_choice(&self) -> top_bar::ModelChoice {
        let run = self.picture.as_ref().map(|picture| picture.run);
        let why_not = if self.board().is_some() {
            Some(say::model_not_with_board())
        } else if !matches!(run, Some(RunState::Reset | RunState::Stop)) {
            Some(say::model_not_while_running())
        } else if self.views.unsaved().is_some() {
            Some(say::model_not_unsaved())
        } else {
            None
        };
        top_bar::ModelChoice {
            shown: self.models.shown,
            offered: self.models.changeable,
            why_not,
        }
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
        self.views.follow(&self.settings.layouts);
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
        self.browser.show(ui.ctx(), language);
        self.keyboard(ui, menu);
        let (board, lcd) = (self.board(), self.lcd.place());
        let layouts = &mut self.settings.layouts;
        let typed = self
            .views
            .show_floating(ui.ctx(), language, board, lcd, layouts);
        self.typed(&typed.events);
        let focused = typed.focused || ui.input(|input| input.focused);
        if !focused {
            self.let_go();
        }
        if self.held.any() {
            // The kernel lets go of keys when it hears nothing of the window.
            self.console.send(Command::Alive);
            ui.ctx()
                .request_repaint_after(std::time::Duration::from_millis(100));
        }
    }

    /// Pieces of the path in the machine view.
    pub fn pieces_of_path(&mut self) -> usize {
        self.views.lathe().pieces()
    }

    /// Takes what the kernel has sent.
    fn receive(&mut self) {
        // The program that is no longer the selected one.
        let mut left = None;
        if let Some(picture) = self.console.pictures.pop() {
            let before = self.picture.as_ref();
            let alarm = before.and_then(|it| it.alarm.as_ref());
            let alarms = picture.alarm.is_some() && picture.alarm.as_ref() != alarm;
            let was_known = before.is_some_and(|it| !it.place_unknown);
            if alarms || (picture.place_unknown && was_known) {
                // The newest word stands on the line.
                self.message = None;
            }
            let was = before.and_then(|it| it.program);
            left = was.filter(|program| picture.program != Some(*program));
            if before.is_none_or(|before| before.screen != picture.screen) {
                platform::tell_screen(|| picture.screen.text());
            }
            self.views.lessons().seen(&picture);
            self.hear(&picture);
            self.picture = Some(picture);
        }
        while let Ok(notice) = self.console.notices.try_recv() {
            match notice {
                Notice::Said(text) => self.message = Some(Message::Said(text)),
                Notice::Collided(what) => self.message = Some(Message::Collided(what)),
                Notice::FreshStock => {
                    self.message
                        .take_if(|message| matches!(message, Message::Collided(_)));
                }
                Notice::Refused(alarm) => self.message = Some(Message::Refused(alarm)),
                Notice::Sent(what) => self.message = Some(Message::Sent(what)),
                Notice::NumberTaken(opened, number) => {
                    self.questions.ask_for_place(opened, number);
                }
                Notice::Opened { name, path, place } => {
                    self.views.program().opened(path.as_deref(), &place);
                    self.views.lathe().opened(path.as_deref(), &place);
                    let shown = PathBuf::from(name);
                    let shown = shown.file_name().unwrap_or_default();
                    let shown = shown.to_string_lossy().into_owned();
                    self.message = Some(Message::opened(self.message.take(), shown, place));
                    if let Some(path) = path.as_ref().filter(|path| platform::lasts(path)) {
                        self.settings.remember(path);
                    }
                    self.opened = path;
                }
                // What it says of a file must not cover an alarm that stands by now.
                Notice::Looked(..)
                    if self.picture.as_ref().is_some_and(|it| it.alarm.is_some()) => {}
                Notice::Looked(file, look) => {
                    self.message = Some(Message::looked(self.message.take(), file, look));
                }
                Notice::Key(Some(why)) => self.message = Some(Message::KeyRefused(why)),
                Notice::Key(None) => {
                    self.message
                        .take_if(|message| matches!(message, Message::KeyRefused(_)));
                }
            }
        }
        // What is said of the new one has come before its picture.
        self.message
            .take_if(|message| left.is_some_and(|program| message.is_about(program)));
    }

    /// Files that were dropped on the window.
    fn take_files(&mut self, ui: &Ui) {
        let (dropped, hovering) = ui.input(|input| {
            let dropped = input.raw.dropped_files.clone();
            (dropped, !input.raw.hovered_files.is_empty())
        });
        if !dropped.is_empty() {
            let (opener, context) = (self.opener.clone(), ui.ctx().clone());
            platform::take_dropped(&dropped, move |path| opener.open(path, &context));
        } else if hovering {
            self.message = Some(Message::DropHere);
        }
    }

    fn answer(&mut self, asked: top_bar::Asked, ui: &Ui) {
        match asked {
            top_bar::Asked::Choose => {
                self.opener.choose(self.settings.language, ui.ctx());
            }
            top_bar::Asked::Open(path) => self.open(ui.ctx(), path),
            top_bar::Asked::Sample(sample) => self.opener.open_sample(sample, ui.ctx()),
            // A page has no folders, and need not have what reads them.
            top_bar::Asked::Project(_) if !platform::has_folders() => {}
            top_bar::Asked::Project(command) => {
                let language = self.settings.language;
                self.views.project().command(command, language, ui.ctx());
                self.show_view(View::Project);
            }
            top_bar::Asked::Layout(layout) => self.settings.layouts.choose(layout),
            top_bar::Asked::View(view) => self.settings.layouts.toggle(view),
            top_bar::Asked::Lessons => match self.settings.layouts.is_open(View::Lesson) {
                true => self.settings.layouts.toggle(View::Lesson),
                false => self.settings.layouts.dock(View::Lesson),
            },
            top_bar::Asked::LeaveLesson => {
                self.console.send(Command::Lesson(LessonOrder::Leave));
            }
            top_bar::Asked::Speed(speed) => self.console.send(Command::Speed(speed)),
            top_bar::Asked::FreeBits => self.console.send(Command::FreeBits),
            top_bar::Asked::Mend => self.console.send(Command::Mend),
            top_bar::Asked::Light => {
                self.settings.light = !self.settings.light;
                surroundings::set(ui.ctx(), self.settings.light);
            }
            top_bar::Asked::Model(model) => self.models.asked = Some(model),
            top_bar::Asked::Sound(volume) => self.settings.sound = volume,
            top_bar::Asked::Fingers => self.settings.fingers = !self.settings.fingers,
            top_bar::Asked::Zoom(per_cent) => self.settings.zoom = per_cent,
            top_bar::Asked::FirstStart => self.ask_first(),
            top_bar::Asked::Keys => self.key_map = !self.key_map,
            top_bar::Asked::Help => self.help.ask(None),
            top_bar::Asked::Language => {
                self.settings.language = self.settings.language.other();
            }
        }
    }

    fn status(&self, ui: &mut Ui) {
        let language = self.settings.language;
        if let Some(key) = self.held.kept() {
            let text = say::window_key_is_kept_hint(key_label(key)).text(language);
            return top_bar::status(ui, Some(&text), true, "");
        }
        let speed = self
            .picture
            .as_ref()
            .map_or(100, |picture| picture.speed_percent);
        if speed < 100 {
            let text = say::window_too_slow(speed).text(language);
            return top_bar::status(ui, Some(&text), true, "");
        }
        let pressed = self
            .picture
            .as_ref()
            .is_some_and(|picture| picture.pressed.contains(&Key::EmergencyStop));
        let alarm = self.picture.as_ref().and_then(|it| it.alarm.as_ref());
        // With a board the alarm says where the slides stand.
        if pressed && alarm.is_none_or(|alarm| alarm.detail.is_none()) {
            return top_bar::status(
                ui,
                Some(&say::window_hint_emergency_stop().text(language)),
                true,
                "",
            );
        }
        if let Some(alarm) = alarm
            && self.message.is_none()
        {
            return top_bar::alarm(ui, alarm, language, self.lcd.place());
        }
        let warned = self.message.as_ref().is_some_and(Message::is_warning);
        let waits = self.picture.as_ref().and_then(|it| it.waits.as_ref());
        if let Some(waits) = waits.filter(|_| !warned) {
            let place = waits.block.as_ref();
            let place = place.map(|it| alarm_line::place_of(it, language));
            let what = waits.what.clone();
            let text = say::window_waits(place.unwrap_or_default(), what).text(language);
            return top_bar::status(ui, Some(&text), false, "");
        }
        let unknown = self.picture.as_ref().is_some_and(|it| it.place_unknown);
        let hint = if unknown {
            say::window_hint_machine_zero()
        } else {
            say::window_hint()
        };
        let message = self.message.as_ref();
        let text = message.map(|message| message.text(language));
        let warning = message.is_some_and(Message::is_warning);
        top_bar::status(ui, text.as_deref(), warning, &hint.text(language));
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
            let stops: Vec<Event> = events.into_iter().filter(views::stops).collect();
            self.typed(&stops);
            return;
        }
        zoom::typed(ui.ctx(), &events, &mut self.settings);
        let mut events = keyboard::beside_focus(ui.ctx(), events);
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

    /// Opens the program view at the block that raised an alarm.
    fn show_block(&mut self, occurrence: Occurrence) {
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
