//! Draws the main window (bars, panes, panel, dialogs) and dispatches its input. Tests drive
//! [`Window`] as the program does; only [`app`] needs eframe's event loop.

#![deny(clippy::print_stdout, clippy::print_stderr)]
#![allow(missing_docs, reason = "internal names")]

pub mod app;
mod chrome;
pub mod class_window;
mod focus;
pub mod fonts;
mod frame_figures;
mod help;
mod input;
pub mod layout;
mod panel_view;
mod placement;
mod repaint_filter;
mod request;
mod samples;
mod screen_reader;
mod settings;
mod shown_content;
mod theme;
pub mod view;
mod views;
mod widgets;

use std::path::PathBuf;
use std::sync::Arc;

use egui::{Frame, Margin, Panel, Pos2, Ui};
use gsk_core::model::ModelId;
use gsk_core::operation::RunState;
use gsk_help::{Subject, Topic, topic};
use gsk_host::files::exams::UnfinishedExam;
use gsk_host::files::exercises::AvailableExercises;
use gsk_host::files::lessons::AvailableLessons;
use gsk_host::kernel::{Command, Console, KeysReversed, PanelSnapshot};
use gsk_host::platform::{self, CoursePage};
use gsk_host::sound::MachineSound;
use gsk_link::LinkState;
use gsk_panel::alarm_log::AlarmRecord;
use gsk_panel::faceplate::PartKind;
use gsk_panel::keys::Key;

use crate::chrome::class_offer::ClassOffer;
use crate::chrome::exam_limits::ClosedForExam;
use crate::chrome::first_start::FirstStart;
use crate::chrome::key_dispatch::KeyReceiver;
use crate::chrome::message_history::MessageHistory;
use crate::chrome::network_pane::NetworkPane;
use crate::chrome::program_opener::ProgramOpener;
use crate::chrome::timeline::TimelineStrip;
use crate::chrome::way_back::WayBack;
use crate::chrome::why_pane::WhyPane;
use crate::chrome::{top_bar, zoom};
use crate::input::held_keys::HeldKeys;
use crate::input::key_map;
use crate::input::long_press::LongPress;
use crate::input::panel_pointer::PanelPointer;
use crate::layout::WindowLayout;
use crate::panel_view::{faceplate_image, lcd};
use crate::placement::{panel_placement, stop_key_clearance};
use crate::shown_content::ShownContent;
use crate::widgets::files::FileBrowser;
use crate::widgets::questions::Questions;
use crate::widgets::real_machine_bar;
use crate::widgets::status_message::StatusMessage;
use help::HelpWindow;
pub use settings::WindowSettings;
use view::ViewId;
use views::Views;
use views::interface::ViewStart;
pub use views::lathe::{SceneRecorder, encode_scene};
pub use views::project::ProjectSelection;

pub use crate::chrome::startup_error;
pub use crate::input::key_map::pc_name;

pub const TITLE: &str = "GSK980TD";
/// Height of the bar at the top, points.
const TOP_BAR_HEIGHT: f32 = 28.0;
/// Height of the message line at the bottom, points.
const MESSAGE_LINE_HEIGHT: f32 = 22.0;

/// The state of the main window between two frames.
pub struct Window {
    console: Console,
    snapshot: Option<PanelSnapshot>,
    settings: WindowSettings,
    opened_program: Option<PathBuf>,
    message: Option<StatusMessage>,
    message_history: MessageHistory,
    held_keys: HeldKeys<Key>,
    pointing: PanelPointer,
    opener: ProgramOpener,
    is_key_map_open: bool,
    help: HelpWindow,
    /// The areas of the panel with the positions of the last frame.
    placed_areas: Vec<panel_placement::PlacedArea>,
    pointer_position: Option<Pos2>,
    /// The topic of the element or the docked view under the pointer; `None` if there is none or
    /// a window covers it.
    pointed_topic: Option<&'static Topic>,
    /// The part under the pointer that has been pressed or turned; its tip stays hidden.
    used_part: Option<PartKind>,
    questions: Questions,
    browser: FileBrowser,
    views: Views,
    lcd: lcd::Lcd,
    faceplate: faceplate_image::FaceplateImage,
    models: Models,
    first_start: Option<FirstStart>,
    long_press: LongPress,
    /// Which axis keys act in the reverse direction, for their tool tips.
    reversed_keys: KeysReversed,
    /// Whether the kernel is requested to send the LCD in the other language, too.
    is_translation_requested: bool,
    sounds: MachineSound,
    timeline: TimelineStrip,
    /// The return to the start point of a program whose keys the panel marks; `None` if the
    /// operator has not requested it.
    way_back: Option<WayBack>,
    /// The views and bars that were closed for the current exam; `None` outside exams.
    closed_for_exam: Option<ClosedForExam>,
    why: WhyPane,
    network: NetworkPane,
    /// The task that the instructor of the class offers; `None` without one.
    class_offer: Option<ClassOffer>,
}

/// The control model in use and the operator's request for another one.
#[derive(Clone, Copy, Debug, Default)]
struct Models {
    current: ModelId,
    requested: Option<ModelId>,
    /// Whether the operator may switch to another control model.
    is_changeable: bool,
}

impl Window {
    /// Creates a window that is connected to the kernel's `console`.
    pub fn new(console: Console, settings: WindowSettings) -> Self {
        let opener = ProgramOpener::new(console.clone());
        let timeline = TimelineStrip::new(console.clone());
        let views = Views::new(ViewStart {
            console: &console,
            settings: &settings,
        });
        Self {
            console,
            network: NetworkPane::new(&settings.network),
            class_offer: None,
            snapshot: None,
            settings,
            opened_program: None,
            message: None,
            message_history: MessageHistory::default(),
            held_keys: HeldKeys::default(),
            pointing: PanelPointer::default(),
            opener,
            is_key_map_open: false,
            help: HelpWindow::default(),
            placed_areas: Vec::new(),
            pointer_position: None,
            pointed_topic: None,
            used_part: None,
            questions: Questions::default(),
            browser: FileBrowser::default(),
            views,
            lcd: lcd::Lcd::default(),
            faceplate: faceplate_image::FaceplateImage::default(),
            models: Models::default(),
            first_start: None,
            long_press: LongPress::default(),
            reversed_keys: KeysReversed::default(),
            is_translation_requested: false,
            sounds: MachineSound::default(),
            timeline,
            way_back: None,
            closed_for_exam: None,
            why: WhyPane::default(),
        }
    }

    /// Sets the control model in use. `is_changeable` allows the operator to request another
    /// one.
    pub const fn set_model(&mut self, current: ModelId, is_changeable: bool) {
        self.models = Models {
            current,
            requested: None,
            is_changeable,
        };
    }

    /// Removes and returns the control model that the operator has requested since the last call;
    /// `None` without one.
    pub const fn take_requested_model(&mut self) -> Option<ModelId> {
        self.models.requested.take()
    }

    /// Opens the project in `folder` and lists its differences from the control.
    pub fn compare_project(&mut self, context: &egui::Context, folder: PathBuf) {
        self.views.project().open(folder, true, context);
        self.show_view(ViewId::Project);
    }

    fn show_view(&mut self, view: ViewId) {
        let layouts = &mut self.settings.layouts;
        if !layouts.is_open(view) {
            layouts.toggle(view);
        } else if layouts.docked().contains(&view) {
            layouts.bring_to_front(Some(view));
        }
    }

    /// Removes and returns the values of a project that the operator has chosen to take over;
    /// `None` without any. The caller turns the control off to write them.
    pub const fn take_project_selection(&mut self) -> Option<ProjectSelection> {
        self.views.project().take_selection()
    }

    /// Enables the drawing of the panel. Tests without a display leave it off.
    pub const fn paint_panel(&mut self) {
        self.faceplate.enable();
    }

    /// Returns the settings that are stored for the next start.
    pub const fn settings(&self) -> &WindowSettings {
        &self.settings
    }

    /// Stores the size and position of the window in the settings.
    pub fn store_geometry(&mut self, context: &egui::Context) {
        if let Some(geometry) =
            context.input(|input| layout::floating::normal_geometry(input.viewport()))
        {
            self.settings.layouts.window = Some(geometry);
        }
        if let Some(is_maximized) = context.input(|input| input.viewport().maximized) {
            self.settings.layouts.is_maximized = Some(is_maximized);
        }
    }

    /// Shows `message` on the message line.
    pub fn show_message(&mut self, message: impl Into<gsk_messages::Message>) {
        self.message = Some(StatusMessage::Text(message.into()));
    }

    /// Sets the exercises that the window lists, and the data folder with the key of results.
    /// `unfinished`: the exam in that folder that has not ended; it continues.
    pub fn set_exercises(
        &mut self,
        found: AvailableExercises,
        data: PathBuf,
        unfinished: UnfinishedExam,
    ) {
        let exercises = self.views.lessons().exercises();
        exercises.set_exercises(found, data, unfinished);
    }

    /// Lists only the exercises of a course that a learning platform has opened, and shows them.
    pub fn set_course(&mut self, course: &CoursePage, data: PathBuf) {
        self.views.lessons().exercises().set_course(course, data);
        self.first_start = None;
        self.settings.layouts.choose(WindowLayout::Learner);
        self.show_view(ViewId::Lesson);
    }

    /// Sets where the window reports what it shows.
    pub fn report_shown_content(&mut self, shown: Arc<ShownContent>) {
        self.views.report_shown_content(shown);
    }

    /// Sets the lessons that the window lists, those of a teacher included, and the errors in
    /// lesson files.
    pub fn set_lessons(&mut self, lessons: AvailableLessons) {
        let view = self.views.lessons();
        view.set_lessons(lessons.lessons, lessons.errors);
    }

    /// Opens a program file, or a project by its `project.gpr`. The message line shows the
    /// result.
    pub fn open(&mut self, context: &egui::Context, path: PathBuf) {
        let is_project = path
            .file_name()
            .is_some_and(|name| name == gsk_host::project::PROJECT_FILE);
        if let Some(folder) = path
            .parent()
            .filter(|_| is_project && platform::has_folders())
        {
            self.compare_project(context, folder.to_owned());
            return;
        }
        self.opener.open(path, context);
    }

    /// Shows that the kernel has ended unexpectedly, and lets the window close.
    pub fn report_kernel_end(&mut self) {
        self.message = Some(StatusMessage::KernelEnded);
        self.allow_closing();
    }

    /// Lets the window close without the question about unsaved work.
    pub const fn allow_closing(&mut self) {
        self.questions.allow_closing();
    }

    pub fn title(&self) -> String {
        let model = self.models.current.name();
        real_machine_bar::window_title(&model.text(self.settings.language), self.board())
    }

    /// State of the board that moves real slides; `None` if no board is connected.
    fn board(&self) -> Option<LinkState> {
        self.snapshot.as_ref().and_then(|picture| picture.board)
    }

    /// The latest snapshot of the control; `None` before the first one.
    pub const fn snapshot(&self) -> Option<&PanelSnapshot> {
        self.snapshot.as_ref()
    }

    /// Draws one frame of the window and handles its input.
    pub fn ui(&mut self, ui: &mut Ui) {
        // Checked here because the key that closes the menu, or leaves the field, is consumed later.
        let receiver = KeyReceiver::at_begin_of_frame(ui.ctx());
        self.receive(ui.ctx());
        self.update_sound();
        let refusal = self.model_choice().refusal;
        self.views.project().set_refusal(refusal);
        let only_docks = ui.ctx().embed_viewports();
        self.settings.layouts.set_single_window(only_docks);
        if self.views.lessons().take_begun() && !self.settings.layouts.is_open(ViewId::Machine) {
            // The learner sees what his keys do to the part.
            self.settings.layouts.dock_beside(ViewId::Machine);
        }
        self.restrict_to_exam();
        self.views.follow(ui.ctx(), &self.settings.layouts);
        self.take_dropped_files(ui);
        zoom::apply(ui.ctx(), &self.settings);
        let language = self.settings.language;
        real_machine_bar::show(ui, "panel", self.board(), language);
        let slim = Frame::new()
            .fill(theme::BAR_GROUND)
            .inner_margin(Margin::symmetric(8, 0));
        let bar = Panel::top("bar")
            .exact_size(TOP_BAR_HEIGHT)
            .frame(slim)
            .show_separator_line(false);
        let requests = bar
            .show(ui, |ui| {
                let opened = self.opened_program.as_ref();
                let picture = self.snapshot.as_ref();
                let models = self.model_choice();
                top_bar::show(ui, &self.settings, opened, picture, &models)
            })
            .inner;
        let status_panel = Panel::bottom("status")
            .exact_size(MESSAGE_LINE_HEIGHT)
            .frame(slim)
            .show_separator_line(false);
        status_panel.show(ui, |ui| self.show_message_line(ui));
        self.timeline
            .follow(&mut self.settings.timeline, self.snapshot.as_ref());
        // The central panel has no frame: the clear colour fills what the panel leaves free.
        egui::CentralPanel::default()
            .frame(Frame::NONE)
            .show(ui, |ui| {
                if !self.show_first_start(ui) {
                    self.show_panes(ui);
                }
            });
        stop_key_clearance::store_stop_keys(ui.ctx(), &self.placed_areas);
        self.store_view_settings();
        if let Some(requests) = requests {
            if requests.needs_window_area() {
                self.first_start = None;
            }
            self.handle_request(requests, ui);
        }
        if self.is_key_map_open {
            self.is_key_map_open = {
                let model = self.panel_model();
                key_map::show(ui.ctx(), language, model, &self.placed_areas)
            };
        }
        self.show_why_pane(ui.ctx());
        self.show_network_pane(ui.ctx());
        self.show_class_offer(ui.ctx());
        self.show_help(ui.ctx());
        let picture = self.snapshot.as_ref();
        let unsaved = self.views.first_unsaved();
        self.questions
            .show(ui.ctx(), language, picture, &self.console, unsaved);
        let (board, lcd) = (self.board(), self.lcd.bounds());
        let browser_input = self.browser.show(ui.ctx(), language, lcd);
        self.handle_keyboard(ui, receiver);
        self.handle_keys(&browser_input.stop_events);
        let shared = views::SeparateWindows {
            language,
            board,
            lcd,
            messages: self.messages_for_separate_windows(),
            alarm_topic: self.alarm_topic(),
        };
        let layouts = &mut self.settings.layouts;
        let view_input = self.views.show_floating(ui.ctx(), &shared, layouts);
        if view_input.jogs_in_list {
            self.explain_axis_key_in_list();
        }
        self.handle_keys(&view_input.events);
        if let Some(request) = self.views.take_sample() {
            self.opener.open_sample(request, ui.ctx());
            self.show_view(ViewId::Machine);
        }
        focus::release_cursor_keys(ui.ctx());
        let focused =
            view_input.has_focus || browser_input.has_focus || ui.input(|input| input.focused);
        if !focused {
            self.release_keys();
        }
        self.renew_held_keys(ui.ctx());
    }

    /// Shows the help window, and follows its links to lessons and blocks.
    fn show_help(&mut self, context: &egui::Context) {
        let (language, picture) = (self.settings.language, self.snapshot.as_ref());
        let request = self
            .help
            .show(context, language, picture, &self.placed_areas);
        match request {
            Some(help::HelpRequest::Lesson(order)) => self.console.send(Command::Lesson(order)),
            Some(help::HelpRequest::Block(occurrence)) => self.show_block(*occurrence),
            Some(help::HelpRequest::OpenLessons) => self.show_view(ViewId::Lesson),
            None => {}
        }
    }

    /// Deletes the OpenGL objects before the window closes.
    pub fn release(&self, gl: &eframe::glow::Context) {
        self.views.release(gl);
    }

    /// Copies the data that views keep for the next start into the settings.
    fn store_view_settings(&mut self) {
        self.settings.solid = self.views.lathe().is_solid();
        self.settings.scene_camera = self.views.scene_camera();
        let finished = self.views.lessons().finished_lessons();
        if self.settings.lessons != *finished {
            self.settings.lessons.clone_from(finished);
        }
        let exercises = self.views.lessons().exercises();
        if self.settings.exercises != *exercises.best() {
            self.settings.exercises.clone_from(exercises.best());
        }
        if self.settings.learner != exercises.learner() {
            exercises.learner().clone_into(&mut self.settings.learner);
        }
        if let Some(is_open) = exercises.take_timeline_request() {
            self.settings.timeline = is_open;
            if is_open {
                // What is to be seen there: the part, or the panel.
                let layouts = &mut self.settings.layouts;
                let machine = Some(ViewId::Machine);
                let machine = machine.filter(|view| layouts.docked().contains(view));
                layouts.bring_to_front(machine);
            }
        }
        let transfer = self.views.transfer().settings();
        if self.settings.transfer != *transfer {
            self.settings.transfer.clone_from(transfer);
        }
        let watched = self.views.program().watched();
        if self.settings.watches != watched {
            watched.clone_into(&mut self.settings.watches);
        }
        let projects = self.views.project().settings();
        if self.settings.projects != *projects {
            self.settings.projects.clone_from(projects);
        }
    }

    /// Number of segments of the tool path in the machine view.
    pub fn count_path_pieces(&mut self) -> usize {
        self.views.lathe().segment_count()
    }

    /// Whether RESET may stop a motion or a run; true before the first snapshot.
    fn is_running_or_unknown(&self) -> bool {
        self.snapshot.as_ref().is_none_or(|it| {
            let board = matches!(it.board, Some(LinkState::Moving | LinkState::Homing));
            it.is_moving || board || matches!(it.run_state, RunState::Run | RunState::Hold)
        })
    }

    /// Opens the program view at the block in which an alarm was raised.
    fn show_block(&mut self, occurrence: AlarmRecord) {
        let Some(source) = occurrence.alarm.source else {
            return;
        };
        let program = self.views.program();
        program.show_block(source.program, source.line, occurrence.block);
        self.show_view(ViewId::Program);
    }

    /// The help topic about the current alarm; `None` without an alarm.
    fn alarm_topic(&self) -> Option<&'static Topic> {
        let alarm = self.snapshot.as_ref()?.alarm.as_ref()?;
        topic(Subject::Alarm(alarm.row()?.number))
    }
}
