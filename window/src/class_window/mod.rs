//! The window of the instructor: all seats of a class as tiles, the one that needs help first, and
//! what he requests of the selected one.

mod exam_form;
mod join_pane;
mod part_drawing;
mod seat_pane;
mod tiles;

use std::io;
use std::path::PathBuf;

use eframe::egui::{self, Frame, Margin, Panel, RichText, Ui};
use gsk_host::files::exercises::{AvailableExercises, find_own_source};
use gsk_host::message_format::describe_io_error;
use gsk_host::network::class::class_address::ClassAddress;
use gsk_host::network::class::class_roster::ClassRoster;
use gsk_host::network::class::seat_request::{MAX_REQUEST_BYTES, SeatRequest};
use gsk_host::network::class::{ClassEvent, ClassLink, ClassPageServer};
use gsk_host::network::page_url;
use gsk_host::network::service_state::ServiceState;
use gsk_host::platform;
use gsk_messages::{Language, Message, say};
use web_time::Duration;

use crate::{fonts, theme};
use exam_form::ExamForm;
use join_pane::JoinPane;
pub use join_pane::SeatPage;
use seat_pane::SeatPane;

/// Size of the window at the start, points.
const INITIAL_SIZE: [f32; 2] = [1100.0, 720.0];
/// Width of the pane of the selected seat, points.
const PANE_WIDTH: f32 = 348.0;
/// Distance of the panes for an exam and for joining from the right edge, points.
const PANE_MARGIN: f32 = 2.0 * PANE_WIDTH + 48.0;
/// Height of the bar with its margin, points.
const BAR_HEIGHT: f32 = 44.0;
/// Time between two frames while seats report.
const FRAME_INTERVAL: Duration = Duration::from_millis(100);
/// Number of messages that the line at the bottom keeps.
const MAX_MESSAGES: usize = 50;

/// What the window of a class needs to start.
pub struct ClassStart {
    /// The class.
    pub class: ClassAddress,
    /// Folder for results.
    pub results: PathBuf,
    /// Language of the window.
    pub language: Language,
    /// The exercises that the instructor can send.
    pub exercises: AvailableExercises,
    /// Data folder with his own exercises; `None` without one.
    pub data: Option<PathBuf>,
    /// Where the page of the class is; `None` without one.
    pub page_address: Option<String>,
    /// The page for browsers with which a seat joins; `None` without one.
    pub seat_page: Option<SeatPage>,
}

/// Opens the window and returns when it is closed. Returns a message as error if it cannot be
/// opened.
pub fn run(start: ClassStart) -> Result<(), Message> {
    let viewport = egui::ViewportBuilder::default()
        .with_title(say::class_title(&start.class.code).text(start.language))
        .with_app_id("gsk980td-class")
        .with_inner_size(INITIAL_SIZE);
    platform::open_window(
        "gsk980td-class",
        viewport,
        Box::new(move |creation| {
            let context = creation.egui_ctx.clone();
            fonts::set_up(&context);
            let wake = move || context.request_repaint_after(FRAME_INTERVAL);
            let link = ClassLink::start(&start.class, start.results.clone(), wake)?;
            let window = ClassWindow::new(start, link);
            Ok(Box::new(ClassApp(
                window.map_err(|error| io::Error::other(error.to_string()))?,
            )))
        }),
    )
}

struct ClassApp(ClassWindow);

impl eframe::App for ClassApp {
    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        self.0.ui(ui);
    }
}

/// The state of the window between two frames.
pub struct ClassWindow {
    start: ClassStart,
    link: ClassLink,
    /// Name in topics of the selected seat; `None` without one.
    selected: Option<String>,
    pane: SeatPane,
    exam: ExamForm,
    is_exam_open: bool,
    join: JoinPane,
    is_join_open: bool,
    /// The page of the class; `None` without one.
    page: Option<ClassPageServer>,
    /// The newest messages, the newest last.
    messages: Vec<Message>,
}

impl ClassWindow {
    /// A window on a class whose connection runs.
    ///
    /// # Errors
    /// The page of the class cannot listen.
    pub fn new(start: ClassStart, link: ClassLink) -> Result<Self, Message> {
        let address = start.page_address.as_deref();
        let page = address
            .map(|address| link.serve_page(address))
            .transpose()?;
        Ok(Self {
            start,
            link,
            selected: None,
            pane: SeatPane::default(),
            exam: ExamForm::default(),
            is_exam_open: false,
            join: JoinPane::default(),
            is_join_open: false,
            page,
            messages: Vec::new(),
        })
    }

    /// Opens the window without a display server, for tests.
    ///
    /// # Errors
    /// The system starts no thread, or the page cannot listen.
    pub fn start(start: ClassStart) -> Result<Self, Message> {
        let link = ClassLink::start(&start.class, start.results.clone(), || {});
        let link = link.map_err(|error| describe_io_error(&error))?;
        Self::new(start, link)
    }

    /// Draws one frame and handles its input.
    pub fn ui(&mut self, ui: &mut Ui) {
        self.receive();
        let language = self.start.language;
        let bar = Frame::new()
            .fill(theme::BAR_GROUND)
            .inner_margin(Margin::symmetric(8, 4));
        Panel::top("class bar")
            .frame(bar)
            .show(ui, |ui| self.show_bar(ui, language));
        Panel::bottom("class messages")
            .frame(bar)
            .show(ui, |ui| self.show_messages(ui, language));
        let roster = self.link.roster();
        let selected = self.selected.as_deref().and_then(|id| roster.seat(id));
        if let Some(seat) = selected {
            let side = Frame::new()
                .fill(theme::SIDE_GROUND)
                .inner_margin(Margin::same(8));
            let request = Panel::right("seat")
                .exact_size(PANE_WIDTH)
                .frame(side)
                .show(ui, |ui| {
                    let now_ms = self.link.now_ms();
                    self.pane
                        .show(ui, language, seat, &self.start.exercises.tasks, now_ms)
                });
            let request = request.inner.map(|request| self.with_own_task(request));
            match request {
                Some(Ok(request)) => self.link.request(&seat.id, request),
                Some(Err(reason)) => self.add_message(reason),
                None => {}
            }
            // The pane renews its request for the LCD.
            ui.ctx().request_repaint_after(Duration::from_secs(1));
        }
        self.show_exam_form(ui, language, &roster);
        self.show_join_pane(ui, language);
        let ground = Frame::new()
            .fill(theme::WINDOW_GROUND)
            .inner_margin(Margin::same(8));
        let clicked = egui::CentralPanel::default().frame(ground).show(ui, |ui| {
            if roster.count().1 == 0 {
                let class = &self.start.class;
                let text = say::class_empty(&class.code, &class.broker).text(language);
                ui.label(RichText::new(text).color(theme::HINT_TEXT));
            }
            tiles::show(ui, language, &roster, self.selected.as_deref())
        });
        if let Some(clicked) = clicked.inner {
            let is_same = self.selected.as_deref() == Some(&*clicked);
            self.selected = (!is_same).then_some(clicked);
            self.pane = SeatPane::default();
        }
    }

    /// Adds the files of an exercise of the instructor's own to a request that offers it. A seat
    /// has the others.
    fn with_own_task(&self, request: SeatRequest) -> Result<SeatRequest, Message> {
        let SeatRequest::Task { exercise } = &request else {
            return Ok(request);
        };
        let Some(file) = find_own_source(exercise, self.start.data.as_deref())? else {
            return Ok(request);
        };
        let request = SeatRequest::TaskFile {
            exercise: file.id,
            text: file.text,
            drawing: file.drawing,
        };
        match request.to_json().len() {
            size if size > MAX_REQUEST_BYTES => {
                let [size, limit] = [size, MAX_REQUEST_BYTES].map(|bytes| bytes / 1024);
                Err(say::class_task_too_large(size, limit))
            }
            _ => Ok(request),
        }
    }

    /// Draws the form of an exam, and sends its requests.
    fn show_exam_form(&mut self, ui: &Ui, language: Language, roster: &ClassRoster) {
        let mut requests = Vec::new();
        let selected = self.selected.as_deref().and_then(|id| roster.seat(id));
        let (form, start) = (&mut self.exam, &self.start);
        egui::Window::new(say::exam_heading().text(language))
            .id(egui::Id::unique("class exam"))
            .default_pos(pane_position(ui))
            .open(&mut self.is_exam_open)
            .collapsible(false)
            .default_width(PANE_WIDTH)
            .show(ui.ctx(), |ui| {
                let tasks = &start.exercises.tasks;
                let seats = (roster, selected);
                requests = form.show(ui, language, tasks, &start.class.code, seats);
            });
        for (seat, request) in requests {
            self.link.request(&seat, request);
        }
    }

    /// Draws how a seat joins.
    fn show_join_pane(&mut self, ui: &Ui, language: Language) {
        let (pane, start, page) = (&mut self.join, &self.start, &self.page);
        egui::Window::new(say::class_join_title().text(language))
            .id(egui::Id::unique("class join"))
            .default_pos(pane_position(ui))
            .open(&mut self.is_join_open)
            .collapsible(false)
            .default_width(PANE_WIDTH)
            .show(ui.ctx(), |ui| {
                pane.show(ui, language, &start.class, start.seat_page.as_ref());
                if let Some(page) = page {
                    ui.separator();
                    let url = page_url(&page.url()).unwrap_or_else(|| page.url());
                    ui.label(say::class_page_listening(url).text(language));
                }
            });
    }

    fn receive(&mut self) {
        while let Some(event) = self.link.take_event() {
            match event {
                ClassEvent::Lcd(seat, picture) => {
                    if self.selected.as_deref() == Some(&*seat) {
                        self.pane.set_lcd(*picture);
                    }
                }
                ClassEvent::Message(message) => self.add_message(message),
            }
        }
    }

    fn add_message(&mut self, message: Message) {
        if self.messages.len() >= MAX_MESSAGES {
            self.messages.remove(0);
        }
        self.messages.push(message);
    }

    fn show_bar(&mut self, ui: &mut Ui, language: Language) {
        ui.horizontal(|ui| {
            let title = say::class_title(&self.start.class.code).text(language);
            ui.label(RichText::new(title).strong());
            let (online, seats) = self.link.roster().count();
            ui.label(say::class_seats(online, seats).text(language));
            let state = self.link.state().get();
            let colour = match state {
                ServiceState::Connected(_) => theme::SUCCESS,
                ServiceState::Failed(_) => theme::ERROR_TEXT,
                _ => theme::BUSY,
            };
            ui.label(RichText::new(state.message().text(language)).color(colour));
            let right = egui::Layout::right_to_left(egui::Align::Center);
            ui.with_layout(right, |ui| {
                let other = say::window_other_language().text(language);
                if ui.button(other).clicked() {
                    self.start.language = language.other();
                }
                ui.toggle_value(
                    &mut self.is_exam_open,
                    say::class_exam_button().text(language),
                );
                ui.toggle_value(
                    &mut self.is_join_open,
                    say::class_join_button().text(language),
                );
                let is_light = theme::is_light(ui.ctx());
                let light = say::window_light().text(language);
                if ui.add(egui::Button::selectable(is_light, light)).clicked() {
                    theme::set_light(ui.ctx(), !is_light);
                }
            });
        });
    }

    /// Draws the newest message; the earlier ones are its tip.
    fn show_messages(&self, ui: &mut Ui, language: Language) {
        let Some(newest) = self.messages.last() else {
            let folder = self.start.results.display();
            let hint = say::class_result_waiting(folder).text(language);
            ui.label(RichText::new(hint).color(theme::HINT_TEXT));
            return;
        };
        let all = self.messages.iter().rev().map(|it| it.text(language));
        let all: Vec<String> = all.collect();
        ui.label(newest.text(language))
            .on_hover_text(all.join("\n"));
    }
}

/// Where a pane opens: below the bar, beside the first tiles.
fn pane_position(ui: &Ui) -> egui::Pos2 {
    let room = ui.ctx().content_rect();
    let left = (room.right() - PANE_MARGIN).max(room.left());
    egui::pos2(left, room.top() + BAR_HEIGHT)
}
