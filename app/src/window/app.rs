//! Runs [`Window`] on a real display with eframe.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crossbeam::channel::{RecvTimeoutError, bounded};
use eframe::egui::{self, ViewportCommand};
use gsk_core::model::ModelId;
use gsk_messages::{Message, say};
use web_time::{Duration, Instant};

use super::figures::Figures;
use super::layout::floating;
use super::{Chosen, Settings, TITLE, Window, fonts, surroundings, zoom};
use crate::ending::Ending;
use crate::files::data_dir::DataDir;
use crate::files::lessons;
use crate::files::models;
use crate::kernel::{self, Console, Kernel, KernelThread, Outside};
use crate::platform::DisplayServer;
use crate::project::{self, Taking, Who};
use crate::retained::{Keeper, Restored};
use crate::{output, platform, transfer};

/// Size of the window before the size of the monitor is known, points: the LCD at two pixels
/// per dot.
const SIZE: [f32; 2] = [1280.0, 806.0];
/// Share of the monitor's width and height that the window takes at the first start.
const MOST: f32 = 0.92;
/// Settings are written when they have not changed for this time: dragging a splitter does not
/// write a hundred times.
const SETTLED: Duration = Duration::from_secs(1);

/// What the window needs to start.
pub struct Start {
    /// The kernel, not yet running.
    pub kernel: Kernel,
    /// Its console.
    pub console: Console,
    /// The settings of the first frame.
    pub settings: Settings,
    /// The settings in the data directory; `None` when there are none yet.
    pub stored: Option<Settings>,
    pub data: DataDir,
    /// The memory of the control that was read from the data directory, and its errors.
    pub restored: Restored,
    /// A program file to open.
    pub program: Option<PathBuf>,
    /// Start time of the program when frame figures are requested, else `None`.
    pub figures: Option<Instant>,
    pub model: ModelId,
    /// Starts another control model; `None` when the model cannot be changed.
    pub another: Option<Another>,
    /// Whether the window shows the questions of the first start.
    pub asks: bool,
}

/// Prepares the start of another control model with these settings, in the same window.
pub type Another = Box<dyn Fn(ModelId, &Settings) -> Result<Start, Message>>;

/// Opens the window and returns when it is closed.
pub fn run(start: Start) -> Result<(), Message> {
    let viewport = egui::ViewportBuilder::default()
        .with_title(TITLE)
        .with_app_id("gsk980td")
        .with_inner_size(SIZE)
        .with_min_inner_size([480.0, 330.0])
        .with_drag_and_drop(true);
    platform::open_window(
        "gsk980td",
        viewport,
        Box::new(move |creation| {
            fonts::set_up(&creation.egui_ctx);
            let ending = Ending::heard().map_err(std::io::Error::other)?;
            let panics = ending.clone();
            platform::before_panic(move || panics.ask());
            let display = platform::display_server(creation);
            let context = &creation.egui_ctx;
            Ok(Box::new(App::new(start, ending, display, context)?))
        }),
    )
}

struct App {
    window: Window,
    kernel: KernelThread,
    ending: Ending,
    display: DisplayServer,
    /// `None` while the control is off.
    data: Option<Arc<DataDir>>,
    model: ModelId,
    saved: Option<Settings>,
    /// Settings that are not written yet, and the time of their last change.
    changed: Option<(Settings, Instant)>,
    sized: bool,
    title: String,
    figures: Option<Figures>,
    another: Option<Another>,
}

/// Creates the callback with which the kernel requests a repaint. egui's context is locked
/// while a frame is drawn: a separate thread waits for it, so that the kernel does not.
fn bell(context: egui::Context) -> std::io::Result<Box<dyn Fn() + Send>> {
    let (ring, rung) = bounded::<()>(1);
    platform::turn("bell", move || match platform::receive(&rung, None) {
        Ok(()) => {
            // With a delay egui draws one frame; without it, two.
            context.request_repaint_after(Duration::from_millis(1));
            true
        }
        Err(none) => none == RecvTimeoutError::Timeout,
    })?;
    // A request that is still pending covers this one, too.
    Ok(Box::new(move || {
        let _ = ring.try_send(());
    }))
}

impl App {
    fn new(
        start: Start,
        ending: Ending,
        display: DisplayServer,
        context: &egui::Context,
    ) -> std::io::Result<Self> {
        let Start {
            kernel,
            console,
            settings,
            stored,
            data,
            restored,
            program,
            figures,
            model,
            another,
            asks,
        } = start;
        let data = Arc::new(data);
        let keeper = Keeper::start(Arc::clone(&data), &restored, kernel.emulator())?;
        let outside = Outside {
            wake: bell(context.clone())?,
            keeper: Some(keeper),
            partner: Some(platform::sent_folder(data.path(), transfer::FOLDER)),
            ending: ending.clone(),
        };
        // The board stops at once when the display is lost, whatever the window library does.
        let gone = ending.clone();
        platform::watch_display(display, console.watch.clone(), move || gone.ask())?;
        let thread = kernel::start(kernel, &console, outside)?;
        let mut window = Window::new(console, settings.clone());
        window.paint_panel();
        window.set_model(model, another.is_some());
        if asks {
            window.ask_first();
        }
        window.set_lessons(lessons::all(Some(data.path())));
        surroundings::set(context, settings.light);
        let complaints = restored.complaints;
        if let Some(said) = platform::first_word() {
            window.say(said);
        }
        if !complaints.is_empty() {
            window.say(say::several(complaints));
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
            saved: stored,
            changed: None,
            sized: false,
            title: TITLE.to_owned(),
            figures: figures.map(Figures::new),
            another,
        })
    }

    /// Turns the control off and another model on, with the memory of that model. The same
    /// model is turned on again with its other lathe.
    fn change_model(&mut self, model: ModelId, context: &egui::Context) {
        if model == self.model {
            let said = say::first_lathe_is_on();
            return self.turn_on_again(context, |_| said);
        }
        let Some(another) = self.another.take() else {
            return;
        };
        let started = another(model, self.window.settings());
        self.another = Some(another);
        let (ending, display) = (self.ending.clone(), self.display);
        let app = started
            .and_then(|start| App::new(start, ending, display, context).map_err(say::as_written));
        match app {
            Ok(app) => {
                let mut before = core::mem::replace(self, app);
                self.another = before.another.take();
                self.sized = true;
                self.window.set_model(model, true);
                self.window.say(say::model_is_on(model.name()));
                before.turn_off();
            }
            Err(said) => self.window.say(said),
        }
    }

    /// Turns the control off, takes over the chosen project files, and turns the control on
    /// again.
    fn take_over(&mut self, chosen: &Chosen, context: &egui::Context) {
        let model = self.model;
        self.turn_on_again(context, |directory| {
            let taking = Taking {
                project: &chosen.folder,
                directory,
                model: Some(model),
                who: Who::LoggedOn,
                dry_run: false,
            };
            let taken = project::take_over(&taking, &|it| chosen.has(it));
            match &taken {
                Ok(taken) => taken.message(),
                Err(error) => error.message(),
            }
        });
    }

    /// Turns the control off, calls `then` with exclusive access to the data directory, and
    /// turns the control on again. Shows the message that `then` returns.
    fn turn_on_again(&mut self, context: &egui::Context, then: impl FnOnce(&Path) -> Message) {
        let Some(another) = self.another.take() else {
            return;
        };
        self.turn_off();
        // The control has released the directory: `then` can open it for writing.
        let Some(data) = self.data.take() else {
            return;
        };
        let directory = models::directory(data.path(), self.model);
        drop(data);
        let said = then(&directory);
        let started = another(self.model, self.window.settings());
        let (ending, display) = (self.ending.clone(), self.display);
        let app = started
            .and_then(|start| App::new(start, ending, display, context).map_err(say::as_written));
        match app {
            Ok(app) => {
                *self = app;
                self.another = Some(another);
                self.sized = true;
                self.window.set_model(self.model, true);
                self.window.say(said);
            }
            Err(failed) => {
                output::complain_of(&said);
                output::complain_of(&failed);
                self.window.kernel_gone();
            }
        }
    }

    fn turn_off(&mut self) {
        self.window.let_go();
        self.kernel.stop();
        self.save_settings();
    }

    /// Restores the stored size of the window once, limited by the monitor. Later calls store
    /// the current size.
    fn size_once(&mut self, context: &egui::Context) {
        if self.sized {
            self.window.remember_place(context);
            return;
        }
        let Some(monitor) = zoom::follow(context, self.window.settings()) else {
            return;
        };
        self.sized = true;
        let last = self.window.settings().layouts.window;
        let (corner, size) = floating::main_window(last, monitor, MOST);
        context.send_viewport_cmd(ViewportCommand::InnerSize(size));
        context.send_viewport_cmd(ViewportCommand::OuterPosition(corner));
    }

    /// Updates the window title. It shows when the keys move a real machine.
    fn follow_title(&mut self, context: &egui::Context) {
        let title = self.window.title();
        if title != self.title {
            self.title.clone_from(&title);
            context.send_viewport_cmd(ViewportCommand::Title(title));
        }
    }

    /// Writes changed settings after [`SETTLED`] without a further change.
    fn keep_settings(&mut self, context: &egui::Context) {
        let settings = self.window.settings();
        if self.saved.as_ref() == Some(settings) {
            self.changed = None;
            return;
        }
        let changed = match &self.changed {
            Some((last, at)) if last == settings => *at,
            _ => Instant::now(),
        };
        self.changed = Some((settings.clone(), changed));
        if changed.elapsed() >= SETTLED {
            self.save_settings();
        } else {
            context.request_repaint_after(SETTLED);
        }
    }

    fn save_settings(&mut self) {
        let settings = self.window.settings().clone();
        if self.saved.as_ref() == Some(&settings) {
            return;
        }
        let stored = self.data.as_ref().map(|it| it.store("window", &settings));
        self.saved = Some(settings);
        if let Some(Err(said)) = stored {
            self.window.say(said);
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
            self.window.let_go();
        }
        if self.ending.is_asked() {
            self.window.close_without_asking();
            context.send_viewport_cmd(ViewportCommand::Close);
        } else if !self.kernel.is_alive() {
            self.window.kernel_gone();
        }
        self.keep_settings(context);
    }

    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        self.size_once(ui.ctx());
        self.window.ui(ui);
        if let Some(model) = self.window.take_model() {
            self.change_model(model, ui.ctx());
        }
        if platform::has_folders()
            && let Some(chosen) = self.window.take_chosen()
        {
            self.take_over(&chosen, ui.ctx());
        }
        self.follow_title(ui.ctx());
        if let Some(figures) = &mut self.figures {
            figures.frame(frame.info().cpu_usage);
            figures.pieces(self.window.pieces_of_path());
        }
    }

    fn clear_color(&self, _visuals: &egui::Visuals) -> [f32; 4] {
        surroundings::ground(self.window.settings().light).to_normalized_gamma_f32()
    }

    fn on_exit(&mut self, _gl: Option<&eframe::glow::Context>) {
        self.turn_off();
    }
}
