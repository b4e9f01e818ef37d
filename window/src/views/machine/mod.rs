//! The machine view: the half section of the part with its clamping, or the same as a lit
//! solid; the tool at its current position; and the path of the selected program.

mod animation;
mod bars;
mod caliper;
mod camera;
mod grid;
mod job;
mod load_curve;
mod load_display;
mod microscope;
mod overlay;
pub mod path;
mod path_dots;
mod path_lines;
mod path_renderer;
mod picture;
mod preview;
mod repeat_limit;
mod section_drawing;
mod solid_drawing;
pub mod still_picture;
mod time_bar;
mod xray;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use egui::{Context, Panel, Pos2, Ui, pos2};
use gsk_core::command::{ProgramId, SourcePosition};
use gsk_core::units::Point;
use gsk_host::kernel::part::PartView;
use gsk_host::kernel::{Console, ProgramPlacement};
use gsk_messages::Language;
use gsk_workpiece::measure::Feature;

use super::interface::{View, ViewFrame, ViewStart};
use super::program::{ProgramDocument, TextOrigin, with_line_feeds};
use super::{bar_frame, plain_frame, side_frame};
use crate::focus;
use crate::widgets::questions::Unsaved;
use caliper::Caliper;
use camera::PictureState;
use job::JobPanel;
use load_display::LoadDisplay;
use microscope::Microscope;
use path::BlockRef;
use path_renderer::PathRenderer;
use preview::changed_jobs::ChangedJobs;
use preview::exchange::PreviewResult;
use preview::worker::PreviewWorker;
use section_drawing::SectionDrawing;
use solid_drawing::SolidDrawing;
use time_bar::TimeBar;
use xray::Trial;

/// The instrument in use, which determines the effect of the pointer in the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Instrument {
    #[default]
    /// Instrument with which the pointer selects blocks of the path.
    Path,
    /// Instrument with which the pointer measures the part, a caliper.
    Caliper,
    /// The pointer reads the deviations of the surface from the intended one.
    Microscope,
    /// The user changes tools and stock in the job panel.
    Job,
}

/// The block of the path that the user has selected, and the pass of its cycle.
#[derive(Clone, Debug)]
struct SelectedBlock {
    block: BlockRef,
    pass: Option<path::CyclePass>,
}

/// A request of the machine view to the program view.
#[derive(Clone, Debug, PartialEq)]
pub enum ProgramViewRequest {
    /// Show a block. Its `text` lets the program view recognize it.
    ShowBlock {
        program: ProgramId,
        /// Line of the block in the program text, from 1.
        line: u32,
        /// Text of the block to show.
        text: String,
        /// Whether to open the program view if it is closed.
        open_view: bool,
    },
    /// Replace the text of a program in the editor.
    ReplaceText {
        program: ProgramId,
        /// The text that the program has in the control.
        control_text: String,
        /// The new text of the program.
        new_text: String,
    },
}

/// Height of a view below which its rows below the picture are fewer, points.
const LOW_VIEW_HEIGHT: f32 = 300.0;

/// The view that shows the lathe: path, part and tool, with instruments to examine them.
pub struct LatheView {
    console: Console,
    /// The preview worker, from the first frame on, because the part is cut without the view,
    /// too.
    worker: Option<PreviewWorker>,
    /// Whether the machine view is open.
    is_open: bool,
    /// Whether a view shows the path: this one or the lathe view.
    is_path_shown: bool,
    preview: PreviewResult,
    part: Option<Arc<PartView>>,
    program_text: ProgramTextState,
    section_drawing: SectionDrawing,
    solid_drawing: SolidDrawing,
    path_renderer: PathRenderer,
    time_bar: TimeBar,
    picture: PictureState,
    stops_on_crash: bool,
    /// The block that the user has selected; `None` without one.
    selected: Option<SelectedBlock>,
    /// Position of the pointer, part coordinates; `None` outside the picture.
    pointer: Option<Pos2>,
    instruments: Instruments,
    /// Jobs that the user has changed, by their programs.
    changed_jobs: ChangedJobs,
}

/// The state of the program text on which the machine view depends.
#[derive(Default)]
struct ProgramTextState {
    /// The program that was opened last from a file, and the path of this file.
    file: Option<(ProgramId, PathBuf)>,
    /// The text that is executed instead of the control's; `None`: the control's.
    trial: Option<Trial>,
    /// A request to the program view that it has not taken yet.
    request: Option<ProgramViewRequest>,
}

/// All instruments of the view, and which one is in use.
#[derive(Default)]
struct Instruments {
    selected: Instrument,
    caliper: Caliper,
    microscope: Microscope,
    job: JobPanel,
    /// The load of the cuts, which every instrument shows if it is switched on.
    load: LoadDisplay,
}

impl View for LatheView {
    fn create(start: ViewStart<'_>) -> Self {
        Self::new(start.console.clone(), start.settings.solid)
    }

    fn open(&mut self) {
        self.set_open(true);
    }

    fn close(&mut self) {
        self.part = None;
        self.set_open(false);
    }

    fn show(&mut self, ui: &mut Ui, frame: ViewFrame<'_>) {
        self.part = frame.part.map(Arc::clone);
        self.draw(ui, frame.language);
    }

    fn unsaved(&self) -> Option<Unsaved> {
        self.instruments.job.is_unsaved().then_some(Unsaved::Job)
    }
}

impl LatheView {
    /// Creates the view closed. `solid`: it shows the part as a solid.
    pub fn new(console: Console, solid: bool) -> Self {
        Self {
            console,
            worker: None,
            is_open: false,
            is_path_shown: false,
            preview: PreviewResult::default(),
            part: None,
            program_text: ProgramTextState::default(),
            section_drawing: SectionDrawing::default(),
            solid_drawing: SolidDrawing::default(),
            path_renderer: PathRenderer::default(),
            time_bar: TimeBar::default(),
            picture: PictureState {
                is_solid: solid,
                ..PictureState::default()
            },
            stops_on_crash: true,
            selected: None,
            pointer: None,
            instruments: Instruments::default(),
            changed_jobs: ChangedJobs::default(),
        }
    }

    /// The feature of the part that was clicked with the caliper; `None` without one.
    pub fn kept_feature(&self) -> Option<Feature> {
        let is_measuring = self.instruments.selected == Instrument::Caliper;
        self.instruments.caliper.kept().filter(|_| is_measuring)
    }

    /// Returns the number of segments of the drawn path.
    pub fn segment_count(&self) -> usize {
        self.preview.path.segment_count()
    }

    /// Whether the part is drawn as a 3D solid.
    pub const fn is_solid(&self) -> bool {
        self.picture.is_solid
    }

    fn set_open(&mut self, is_open: bool) {
        self.is_open = is_open;
    }

    /// Sets whether a view shows the path; the worker computes it only then.
    pub fn set_path_shown(&mut self, is_shown: bool) {
        self.is_path_shown = is_shown;
        if let Some(worker) = &self.worker {
            worker.flags.visible.store(is_shown, Ordering::Relaxed);
        }
    }

    /// Returns the programmed path that is drawn.
    pub const fn path(&self) -> &Arc<path::DrawnPath> {
        &self.preview.path
    }

    /// Reports to the worker a program that was opened in the window. Its job may be in a file
    /// beside it.
    pub fn report_opened_program(
        &mut self,
        path: Option<&std::path::Path>,
        location: &ProgramPlacement,
    ) {
        let program = match location {
            ProgramPlacement::Stored(number) => ProgramId::Stored(*number),
            ProgramPlacement::OnlyRun(_) => ProgramId::External,
        };
        self.program_text.file = path.map(|path| (program, path.to_owned()));
        self.set_trial(None);
        match (&self.worker, &self.program_text.file) {
            (Some(worker), Some((program, file))) => {
                worker.report_opened_file(*program, file.clone());
            }
            (Some(worker), None) => worker.report_reopened(program),
            (None, _) => {}
        }
    }

    /// The path of the program's file, and its machine time, s; `None` unless the view is open
    /// and a preview of the control's text has ended without an alarm.
    pub fn program_time(&self) -> Option<(&std::path::Path, f64)> {
        let preview = &self.preview;
        let complete = self.is_open
            && !preview.path.is_partial
            && preview.alarm.is_none()
            && !preview.is_trial;
        let file = preview.program_file.as_deref().filter(|_| complete)?;
        Some((file, preview.times.spent().total_s()))
    }

    /// Draws the machine view and handles its input.
    fn draw(&mut self, ui: &mut Ui, language: Language) {
        self.pass_part_on(ui);
        let is_low = ui.available_height() < LOW_VIEW_HEIGHT;
        let tools = Panel::top("lathe bar").frame(bar_frame());
        tools.show(ui, |ui| self.show_toolbar(ui, language));
        let state = Panel::bottom("lathe state").frame(side_frame());
        state.show(ui, |ui| self.show_state(ui, is_low, language));
        if self.instruments.selected == Instrument::Job {
            self.show_job(ui, language);
        }
        egui::CentralPanel::default()
            .frame(plain_frame())
            .show(ui, |ui| self.show_picture(ui, language));
    }

    /// Draws the job panel beside the picture.
    fn show_job(&mut self, ui: &mut Ui, language: Language) {
        // An exercise without a part has no stock to clamp.
        let part = self.part.as_ref().filter(|part| part.empty_chuck.is_none());
        let Some(part) = part else { return };
        let tools = self.preview.times.tools();
        // The job file must not be that of a program that is not selected.
        let selected = self.preview.path.programs.selected();
        let file = self.program_text.file.as_ref();
        let file = file.filter(|(program, _)| selected == Some(*program));
        let programs = &self.preview.path.programs;
        let lathe = job::JobContext {
            program: selected.and_then(|id| Some((id, programs.get(id)?))),
            console: &self.console,
            job: &part.job,
            is_guessed: part.job_name.is_none(),
            is_changed: self.preview.is_changed_job,
            program_file: file.map(|(_, path)| path.as_path()),
            used_tools: tools
                .iter()
                .map(|it| it.tool)
                .filter(|it| *it > 0)
                .collect(),
            is_running: part.block.is_some(),
            rear_tool_post: self.preview.rear_tool_post,
            file_error: self.preview.job_file_error.as_ref(),
        };
        focus::skip_resize_edge(ui, "job");
        let panel = Panel::right("job").frame(side_frame());
        let clamped = panel
            .default_size(300.0)
            .size_range(220.0..=420.0)
            .show(ui, |ui| self.instruments.job.show(ui, &lathe, language))
            .inner;
        if let (Some(job), Some(worker)) = (clamped, &self.worker) {
            worker.clamp(job);
        }
        if let Some((program, file)) = self.instruments.job.take_saved_program() {
            if let Some(worker) = &self.worker {
                worker.report_opened_file(program, file.clone());
            }
            self.program_text.file = Some((program, file));
        }
    }

    /// Receives the results of the worker. Called in every frame, so that a program has its
    /// job and its part before the view is opened.
    pub fn receive(&mut self, context: &Context) {
        let worker = self.worker.get_or_insert_with(|| {
            let worker = PreviewWorker::start(&self.console, context, &self.changed_jobs);
            worker
                .flags
                .visible
                .store(self.is_path_shown, Ordering::Relaxed);
            if let Some(trial) = &self.program_text.trial {
                worker.set_trial(Some(trial.to_program()));
            }
            if let Some((program, file)) = &self.program_text.file {
                worker.report_opened_file(*program, file.clone());
            }
            worker
        });
        if let Some(preview) = worker.take_result() {
            if preview.program_count != self.preview.program_count {
                self.picture.show_whole_part();
                self.selected = None;
                self.instruments.microscope.clear();
                self.instruments.load.clear();
            }
            // The control has stored the text that was tried out: the trial ends.
            if let Some(trial) = &self.program_text.trial
                && !preview.is_trial
                && preview
                    .path
                    .programs
                    .get(trial.program_id)
                    .is_some_and(|own| {
                        with_line_feeds(own.text()) == with_line_feeds(trial.trial_text.text())
                    })
            {
                self.program_text.trial = None;
                worker.set_trial(None);
            }
            // The passes have moved.
            if let Some(chosen) = &mut self.selected {
                chosen.pass = preview.path.find_same_pass(chosen.pass.take());
            }
            self.preview = preview;
        }
    }

    /// Passes the state of the part to the instrument in use.
    fn pass_part_on(&mut self, ui: &Ui) {
        if let Some(part) = &self.part {
            let known = self.picture.tool_bounds.as_ref();
            if !known.is_some_and(|(job, _)| Arc::ptr_eq(job, &part.job)) {
                let bounds = section_drawing::tool_bounds(&part.job);
                self.picture.tool_bounds = Some((Arc::clone(&part.job), bounds));
            }
        }
        let Some(worker) = &self.worker else { return };
        let is_running = self.part.as_ref().is_some_and(|part| part.block.is_some());
        worker
            .flags
            .program_runs
            .store(is_running, Ordering::Relaxed);
        if let Some(compared) = worker.take_comparison() {
            self.instruments.microscope.set_comparison(compared);
        }
        if let Some(curve) = worker.take_load() {
            self.instruments.load.set_curve(curve);
        }
        if let Some(part) = &self.part {
            let load = &mut self.instruments.load;
            if !is_running && load.needs_curve(&self.preview.path, &part.job) {
                worker.request_load(Arc::clone(&part.job));
            }
            match self.instruments.selected {
                Instrument::Path | Instrument::Job => {}
                Instrument::Caliper => self.instruments.caliper.update(&part.section, ui.ctx()),
                Instrument::Microscope => {
                    // A growing path is compared once it is complete.
                    let is_complete = !is_running && !self.preview.path.is_partial;
                    if is_complete
                        && self
                            .instruments
                            .microscope
                            .needs_comparison(&self.preview.path, &part.job)
                    {
                        worker.compare(Arc::clone(&part.job));
                    }
                    let clamped = part.job.stock.jaw_front();
                    self.instruments
                        .microscope
                        .update_deviations(&part.section, clamped, ui.ctx());
                }
            }
        }
    }

    /// Whether the user has requested the lathe in space since the last call.
    pub const fn take_space_request(&mut self) -> bool {
        core::mem::replace(&mut self.picture.requests_space, false)
    }

    /// Takes the request to the program view, if there is one.
    pub const fn take_program_request(&mut self) -> Option<ProgramViewRequest> {
        self.program_text.request.take()
    }

    /// Executes a text of the program view instead of the control's, if it belongs to the
    /// selected program and differs from the control's text.
    pub fn try_typed_text(&mut self, document: &ProgramDocument) {
        let id = match &document.origin {
            TextOrigin::Memory(number) => ProgramId::Stored(*number),
            TextOrigin::File(path, _) => match &self.program_text.file {
                Some((id, file)) if file == path => *id,
                _ => return,
            },
            TextOrigin::New => return,
        };
        let programs = &self.preview.path.programs;
        let own = match &self.program_text.trial {
            Some(trial) if trial.program_id == id => Some(&trial.control_text),
            _ => programs.get(id),
        };
        let own = own.filter(|_| self.is_open && programs.selected() == Some(id));
        let Some(own) = own.cloned() else {
            return;
        };
        let tried = document.to_program();
        let is_same = with_line_feeds(own.text()) == tried.text();
        let trial = (!is_same).then_some(Trial {
            program_id: id,
            control_text: own,
            trial_text: tried,
        });
        if trial != self.program_text.trial {
            self.set_trial(trial);
        }
    }

    fn make_show_request(&self, block: BlockRef, open_view: bool) -> ProgramViewRequest {
        ProgramViewRequest::ShowBlock {
            program: block.program,
            line: block.line,
            text: self.preview.path.block_text(block).to_owned(),
            open_view,
        }
    }

    /// Executes the text of `trial` instead of the control's; `None`: the control's text
    /// again.
    fn set_trial(&mut self, trial: Option<Trial>) {
        if let Some(worker) = &self.worker {
            let text = trial.as_ref();
            worker.set_trial(text.map(Trial::to_program));
        }
        self.program_text.trial = trial;
    }
}

/// Converts a point of the control to part coordinates of the view: x is Z, y is X as a
/// radius, mm.
fn to_pos2(point: Point) -> Pos2 {
    pos2(point.z as f32, point.x as f32)
}

const fn to_block_ref(source: SourcePosition) -> BlockRef {
    BlockRef {
        program: source.program,
        line: source.line,
    }
}
