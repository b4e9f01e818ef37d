//! Runs [`Window`] on a real display with eframe.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crossbeam::channel::{RecvTimeoutError, bounded};
use eframe::egui::{self, ViewportCommand};
use gsk_core::model::ModelId;
use gsk_host::files::data_dir::DataDir;
use gsk_host::files::exams::UnfinishedExam;
use gsk_host::files::models;
use gsk_host::files::{exercises, lessons};
use gsk_host::kernel::{self, Console, Kernel, KernelEnvironment, KernelThread};
use gsk_host::network::ClassSettings;
use gsk_host::platform::DisplayServer;
use gsk_host::project::{self, ImportRequest, ImportRights};
use gsk_host::retained::{self, Keeper, Restored};
use gsk_host::termination::TerminationFlag;
use gsk_host::transfer::udisk;
use gsk_host::{output, platform, transfer};
use gsk_messages::{Message, say};
use web_time::{Duration, Instant};

use super::frame_figures::FrameFigures;
use super::layout::floating;
use super::repaint_filter::RepaintFilter;
use super::shown_content::ShownContent;
use super::{ProjectSelection, TITLE, Window, WindowSettings, fonts, theme};
use crate::chrome::zoom;

/// Size of the window before the size of the monitor is known, points: the LCD at two pixels
/// per dot.
const INITIAL_SIZE: [f32; 2] = [1280.0, 806.0];
/// Share of the monitor's width and height that the window takes at the first start, 0–1.
const INITIAL_SHARE: f32 = 0.92;
/// Largest monitor on which the window fills the screen at the first start, points: panel and
/// machine need all of it.
const MAXIMIZED_UP_TO: [f32; 2] = [1920.0, 1200.0];
/// Settings are written when they have not changed for this time, so that a dragged splitter
/// does not cause many writes.
const SAVE_DELAY: Duration = Duration::from_secs(1);

/// Everything with which the window starts: kernel, console and settings.
pub struct WindowStart {
    /// The kernel, which is not running yet.
    pub kernel: Kernel,
    /// The window's end of the channels to the kernel.
    pub console: Console,
    /// The settings with which the window opens.
    pub settings: WindowSettings,
    /// The settings in the data directory; `None` if it has none yet.
    pub stored_settings: Option<WindowSettings>,
    pub data: DataDir,
    /// The memory of the control that was read from the data directory, and errors in its
    /// files.
    pub restored: Restored,
    /// A program file to open at the start; `None`: open none.
    pub program: Option<PathBuf>,
    /// Start time of the program; `None` unless frame figures are requested.
    pub figures_since: Option<Instant>,
    pub model: ModelId,
    /// Starts another control model; `None` if the model cannot be changed.
    pub start_model: Option<ModelStarter>,
    /// Whether the window shows the questions of the first start.
    pub shows_first_start: bool,
    /// An exam that was interrupted and continues.
    pub unfinished_exam: UnfinishedExam,
    /// The class that an option of the command line names; `None` without that option.
    pub class_seat: Option<ClassSettings>,
}

/// Prepares the start of another control model with these settings, in the same window.
pub type ModelStarter = Box<dyn Fn(ModelId, &WindowSettings) -> Result<WindowStart, Message>>;

/// Opens the window and returns when the operator has closed it. Returns a message as error if the
/// window cannot be opened.
pub fn run(start: WindowStart) -> Result<(), Message> {
    let viewport = egui::ViewportBuilder::default()
        .with_title(TITLE)
        .with_app_id("gsk980td")
        .with_inner_size(INITIAL_SIZE)
        .with_min_inner_size([480.0, 330.0])
        .with_drag_and_drop(true);
    platform::open_window(
        "gsk980td",
        viewport,
        Box::new(move |creation| {
            fonts::set_up(&creation.egui_ctx);
            let ending =
                TerminationFlag::install_signal_handlers().map_err(std::io::Error::other)?;
            let panics = ending.clone();
            platform::before_panic(move || panics.report_crash());
            let display = platform::display_server(creation);
            let context = &creation.egui_ctx;
            Ok(Box::new(App::new(start, ending, display, context)?))
        }),
    )
}

struct App {
    window: Window,
    kernel: KernelThread,
    ending: TerminationFlag,
    display: DisplayServer,
    /// The open data directory; `None` while the control is off or without a directory.
    data: Option<Arc<DataDir>>,
    model: ModelId,
    saved_settings: Option<WindowSettings>,
    /// Settings that are not written yet, and the time of their last change; `None` if all are
    /// written.
    unsaved_settings: Option<(WindowSettings, Instant)>,
    is_size_restored: bool,
    title: String,
    figures: Option<FrameFigures>,
    start_model: Option<ModelStarter>,
}

/// Creates the callback with which the kernel requests a repaint. egui's context is locked
/// while a frame is drawn: a separate thread waits for it, so that the kernel does not.
fn spawn_repaint_thread(
    context: egui::Context,
    mut filter: RepaintFilter,
    shown: Arc<ShownContent>,
) -> std::io::Result<Box<dyn Fn() + Send>> {
    let (request, requested) = bounded::<()>(1);
    let mut last_frame = Instant::now();
    let mut next_frame = last_frame;
    platform::start_task("bell", move || match platform::receive(&requested, None) {
        Ok(()) => {
            if filter.needs_repaint() {
                let now = Instant::now();
                let is_pending = next_frame > now;
                if !is_pending {
                    last_frame = next_frame;
                    shown.count_frame();
                }
                // With a delay egui draws one frame; without it, two.
                let soon = now + Duration::from_millis(1);
                let due = soon.max(last_frame + shown.frame_interval());
                next_frame = if is_pending { next_frame.min(due) } else { due };
                // Repeated in any case: a frame for a key discards the request before it.
                let delay = next_frame.saturating_duration_since(now);
                context.request_repaint_after(delay);
            }
            true
        }
        Err(error) => error == RecvTimeoutError::Timeout,
    })?;
    // A request that is still pending covers this one, too.
    Ok(Box::new(move || {
        let _ = request.try_send(());
    }))
}

impl App {
    fn new(
        start: WindowStart,
        ending: TerminationFlag,
        display: DisplayServer,
        context: &egui::Context,
    ) -> std::io::Result<Self> {
        let WindowStart {
            kernel,
            console,
            settings,
            stored_settings: stored,
            data,
            restored,
            program,
            figures_since: figures,
            model,
            start_model: another,
            shows_first_start: asks,
            unfinished_exam,
            class_seat,
        } = start;
        let data = Arc::new(data);
        let keeper = Keeper::start(Arc::clone(&data), &restored, kernel.emulator())?;
        let shown = Arc::new(ShownContent::default());
        let filter = RepaintFilter::new(&console, ending.clone(), Arc::clone(&shown));
        let kernel_host = KernelEnvironment {
            wake: spawn_repaint_thread(context.clone(), filter, Arc::clone(&shown))?,
            keeper: Some(keeper),
            partner_folder: Some(platform::sent_folder(data.path(), transfer::FOLDER)),
            udisk_folder: Some(data.path().join(udisk::FOLDER)),
            termination: ending.clone(),
        };
        // The board stops at once when the display is lost, whatever the window library does.
        let display_lost = ending.clone();
        platform::watch_display(display, console.input_watch.clone(), move || {
            display_lost.request();
        })?;
        let thread = kernel::start(kernel, &console, kernel_host)?;
        let mut window = Window::new(console, settings.clone());
        window.report_shown_content(shown);
        window.paint_panel();
        window.set_model(model, another.is_some());
        if asks {
            window.open_first_start();
        }
        window.set_lessons(lessons::load_lessons(Some(data.path())));
        match platform::course_page() {
            Some(course) => window.set_course(&course, data.path().to_owned()),
            None => {
                let found = exercises::load_exercises(Some(data.path()));
                window.set_exercises(found, data.path().to_owned(), unfinished_exam);
            }
        }
        if let Some(class) = class_seat {
            window.join_class(class);
        }
        theme::set_light(context, settings.light);
        let complaints = restored.complaints;
        if let Some(message) = platform::startup_message() {
            window.show_message(message);
        }
        if !complaints.is_empty() {
            window.show_message(say::several(complaints));
        }
        if let Some(path) = program {
            window.open(context, path);
        }
        Ok(Self {
            window,
            kernel: thread,
            ending,
            display,
            data: Some(data),
            model,
            saved_settings: stored,
            unsaved_settings: None,
            is_size_restored: false,
            title: String::new(),
            figures: figures.map(FrameFigures::new),
            start_model: another,
        })
    }

    /// Turns the control off and another model on, with the memory of that model. If the model
    /// is already on, turns it on again with the lathe that was chosen.
    fn change_model(&mut self, model: ModelId, context: &egui::Context) {
        if model == self.model {
            // The slides of the other lathe stand at its start.
            return self.restart_control(context, |directory| {
                match retained::forget_position(directory) {
                    Ok(()) => say::first_lathe_is_on(),
                    Err(failed) => failed,
                }
            });
        }
        let Some(start_model) = self.start_model.take() else {
            return;
        };
        let started = start_model(model, self.window.settings());
        self.start_model = Some(start_model);
        let (ending, display) = (self.ending.clone(), self.display);
        let app = started
            .and_then(|start| App::new(start, ending, display, context).map_err(say::as_written));
        match app {
            Ok(app) => {
                let mut previous = core::mem::replace(self, app);
                self.start_model = previous.start_model.take();
                self.is_size_restored = true;
                self.window.set_model(model, true);
                self.window.show_message(say::model_is_on(model.name()));
                previous.turn_control_off();
            }
            Err(message) => self.window.show_message(message),
        }
    }

    /// Turns the control off, writes the chosen values of a project into its memory, and turns
    /// the control on again.
    fn take_over_project(&mut self, chosen: &ProjectSelection, context: &egui::Context) {
        let model = self.model;
        self.restart_control(context, |directory| {
            let takeover = ImportRequest {
                project_folder: &chosen.folder,
                data_dir: directory,
                model: Some(model),
                rights: ImportRights::LoggedOn,
                dry_run: false,
            };
            let taken = project::import_project(&takeover, &|it| chosen.contains(it));
            match &taken {
                Ok(taken) => taken.message(),
                Err(error) => error.message(),
            }
        });
    }

    /// Turns the control off, calls `while_off` with the path of the data directory, which it
    /// may then lock, and turns the control on again. Shows the message that `while_off`
    /// returns.
    fn restart_control(
        &mut self,
        context: &egui::Context,
        while_off: impl FnOnce(&Path) -> Message,
    ) {
        let Some(start_model) = self.start_model.take() else {
            return;
        };
        self.turn_control_off();
        // The control has released the directory: `while_off` can open it for writing.
        let Some(data) = self.data.take() else {
            return;
        };
        let directory = models::data_directory(data.path(), self.model);
        drop(data);
        let message = while_off(&directory);
        let started = start_model(self.model, self.window.settings());
        let (ending, display) = (self.ending.clone(), self.display);
        let app = started
            .and_then(|start| App::new(start, ending, display, context).map_err(say::as_written));
        match app {
            Ok(app) => {
                *self = app;
                self.start_model = Some(start_model);
                self.is_size_restored = true;
                self.window.set_model(self.model, true);
                self.window.show_message(message);
            }
            Err(failed) => {
                output::report_error(&message);
                output::report_error(&failed);
                self.window.report_kernel_end();
            }
        }
    }

    fn turn_control_off(&mut self) {
        self.window.release_keys();
        self.kernel.stop();
        self.save_settings();
    }

    /// Restores the stored size of the window once, limited by the monitor. Later calls store
    /// the current size.
    fn restore_or_store_size(&mut self, context: &egui::Context) {
        if self.is_size_restored {
            self.window.store_geometry(context);
            return;
        }
        let Some(monitor) = zoom::apply(context, self.window.settings()) else {
            return;
        };
        self.is_size_restored = true;
        let stored = self.window.settings().layouts.window;
        let (corner, size) = floating::place_main_window(stored, monitor, INITIAL_SHARE);
        context.send_viewport_cmd(ViewportCommand::InnerSize(size));
        context.send_viewport_cmd(ViewportCommand::OuterPosition(corner));
        let is_small = monitor.x <= MAXIMIZED_UP_TO[0] && monitor.y <= MAXIMIZED_UP_TO[1];
        let layouts = &self.window.settings().layouts;
        if layouts.is_maximized.unwrap_or(stored.is_none() && is_small) {
            context.send_viewport_cmd(ViewportCommand::Maximized(true));
        }
    }

    /// Updates the window title with the current board state: it warns when the keys move a
    /// real machine.
    fn update_title(&mut self, context: &egui::Context) {
        let title = self.window.title();
        if title != self.title {
            self.title.clone_from(&title);
            context.send_viewport_cmd(ViewportCommand::Title(title));
        }
    }

    /// Writes changed settings after [`SAVE_DELAY`] without a further change.
    fn save_settled_settings(&mut self, context: &egui::Context) {
        let settings = self.window.settings();
        if self.saved_settings.as_ref() == Some(settings) {
            self.unsaved_settings = None;
            return;
        }
        let changed_at = match &self.unsaved_settings {
            Some((last, at)) if last == settings => *at,
            _ => Instant::now(),
        };
        self.unsaved_settings = Some((settings.clone(), changed_at));
        if changed_at.elapsed() >= SAVE_DELAY {
            self.save_settings();
        } else {
            context.request_repaint_after(SAVE_DELAY);
        }
    }

    fn save_settings(&mut self) {
        let settings = self.window.settings().clone();
        if self.saved_settings.as_ref() == Some(&settings) {
            return;
        }
        let stored = self.data.as_ref().map(|it| it.store("window", &settings));
        self.saved_settings = Some(settings);
        if let Some(Err(message)) = stored {
            self.window.show_message(message);
        }
    }
}

impl eframe::App for App {
    fn logic(&mut self, context: &egui::Context, _frame: &mut eframe::Frame) {
        let hidden = context.input(|input| {
            let viewport = input.viewport();
            viewport.minimized == Some(true) || viewport.occluded == Some(true)
        });
        if hidden {
            self.window.release_keys();
        }
        if self.ending.is_requested() {
            self.window.allow_closing();
            context.send_viewport_cmd(ViewportCommand::Close);
        } else if !self.kernel.is_alive() {
            self.window.report_kernel_end();
        }
        self.save_settled_settings(context);
    }

    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        self.restore_or_store_size(ui.ctx());
        self.window.ui(ui);
        if let Some(model) = self.window.take_requested_model() {
            self.change_model(model, ui.ctx());
        }
        if platform::has_folders()
            && let Some(chosen) = self.window.take_project_selection()
        {
            self.take_over_project(&chosen, ui.ctx());
        }
        self.update_title(ui.ctx());
        if let Some(figures) = &mut self.figures {
            figures.record_frame(frame.info().cpu_usage);
            figures.record_pieces(self.window.count_path_pieces());
        }
    }

    fn clear_color(&self, _visuals: &egui::Visuals) -> [f32; 4] {
        theme::background(self.window.settings().light).to_normalized_gamma_f32()
    }

    fn on_exit(&mut self, gl: Option<&eframe::glow::Context>) {
        if let Some(gl) = gl {
            self.window.release(gl);
        }
        self.turn_control_off();
    }
}
