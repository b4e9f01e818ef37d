//! The machine view: the half section of the part with its clamping, or the same as a lit
//! solid; the tool at its current position; and the path of the selected program.

mod alive;
mod bars;
mod caliper;
mod camera;
mod clock;
mod dots;
mod grid;
mod job;
mod lines;
mod microscope;
mod overlay;
mod path;
mod rest;
mod solids;
mod space;
mod trail;
mod worker;
mod xray;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use egui::{
    Color32, Context, Panel, PointerButton, Pos2, Rect, Response, Role, Sense, Ui, Vec2, WidgetInfo, pos2,
    vec2,
};
use gsk_core::command::{ProgramId, Source};
use gsk_core::units::Point;
use gsk_messages::{Language, say};

use super::program::{Document, Origin, with_line_feeds};
use super::{bar_frame, plain_frame, side_frame};
use crate::kernel::part::PartView;
use crate::kernel::{Command, Console, Place};
use crate::window::focus;
use caliper::Caliper;
use camera::{Camera, Sight};
use clock::Clock;
use job::JobPanel;
use microscope::Microscope;
use path::Block;
use solids::Solids;
use space::Space;
use trail::Trail;
use worker::{Made, Worker};
use xray::Trial;

/// Greatest distance of a click from the path, points.
const REACH: f32 = 8.0;
/// Exponent of the zoom factor per point that the wheel scrolls.
const ZOOM: f32 = 0.004;
/// Length of the chuck in the fitted picture, mm from the jaws' front.
const CHUCK_SHOWN: f32 = 35.0;
/// Margin around a part that no program cuts, mm.
const ROOM_FOR_TOOL: Vec2 = vec2(22.0, 14.0);
/// Least scale at which a single position is shown, points a millimetre.
const CLOSE: f32 = 120.0;
const HIT: Color32 = Color32::from_rgb(255, 70, 60);

/// What the pointer does in the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Instrument {
    #[default]
    /// Selects blocks of the path.
    Path,
    /// Measures the part.
    Caliper,
    /// Compares the surface with the intended one.
    Microscope,
    /// Changes tools and stock.
    Job,
}

/// A selected block of the path, and the pass of its cycle.
#[derive(Clone, Debug)]
struct Chosen {
    block: Block,
    pass: Option<path::Pass>,
}

/// What the machine view requests from the program view.
#[derive(Clone, Debug, PartialEq)]
pub enum Wish {
    /// Show a block. `text` lets the program view recognize it.
    Show {
        program: ProgramId,
        /// Line of the text, from 1.
        line: u32,
        /// The text of the block.
        text: String,
        /// Open the program view if it is closed.
        open: bool,
    },
    /// Replace the text of a program.
    Take {
        program: ProgramId,
        /// The text in the control.
        own: String,
        /// The new text.
        text: String,
    },
}

/// The machine view.
pub struct LatheView {
    console: Console,
    /// From the first frame on: the part is cut without the view, too.
    worker: Option<Worker>,
    /// The view is open.
    is_open: bool,
    made: Made,
    part: Option<PartView>,
    text: Text,
    solids: Solids,
    space: Space,
    trail: Trail,
    clock: Clock,
    sight: Sight,
    crash_stops: bool,
    /// The block that the user has selected.
    chosen: Option<Chosen>,
    /// Position of the pointer, part coordinates.
    pointer: Option<Pos2>,
    instruments: Instruments,
    /// Jobs that the user has changed.
    changed: worker::Changed,
}

/// The program's text as far as it concerns other views.
#[derive(Default)]
struct Text {
    /// The program that was opened last, and its file.
    file: Option<(ProgramId, PathBuf)>,
    /// Another text than the control's is executed.
    trial: Option<Trial>,
    /// A request to the program view.
    wish: Option<Wish>,
}

/// The instruments, and the one in use.
#[derive(Default)]
struct Instruments {
    in_hand: Instrument,
    caliper: Caliper,
    microscope: Microscope,
    job: JobPanel,
}

impl LatheView {
    /// Creates the view closed. `solid`: the part is shown as a solid.
    pub fn new(console: Console, solid: bool) -> Self {
        Self {
            console,
            worker: None,
            is_open: false,
            made: Made::default(),
            part: None,
            text: Text::default(),
            solids: Solids::default(),
            space: Space::default(),
            trail: Trail::default(),
            clock: Clock::default(),
            sight: Sight {
                solid,
                ..Sight::default()
            },
            crash_stops: true,
            chosen: None,
            pointer: None,
            instruments: Instruments::default(),
            changed: worker::Changed::default(),
        }
    }

    /// The number of segments of the drawn path.
    pub fn pieces(&self) -> usize {
        self.made.path.count()
    }

    /// Whether tools or stock were changed and not saved.
    pub fn is_unsaved(&self) -> bool {
        self.instruments.job.is_unsaved()
    }

    /// Whether the part is shown as a solid.
    pub const fn is_solid(&self) -> bool {
        self.sight.solid
    }

    /// Shows the part from now on.
    pub fn open(&mut self) {
        self.set_open(true);
    }

    /// Shows nothing any more. The part is still cut.
    pub fn close(&mut self) {
        self.part = None;
        self.set_open(false);
    }

    fn set_open(&mut self, is_open: bool) {
        self.is_open = is_open;
        if let Some(worker) = &self.worker {
            worker.shared.visible.store(is_open, Ordering::Relaxed);
        }
        self.console.send(Command::ShowPart(is_open));
    }

    /// Reports a program that was opened in the window. Its job may be in a file beside it.
    pub fn opened(&mut self, path: Option<&std::path::Path>, place: &Place) {
        let program = match place {
            Place::Stored(number) => ProgramId::Stored(*number),
            Place::OnlyRun(_) => ProgramId::External,
        };
        self.text.file = path.map(|path| (program, path.to_owned()));
        self.try_out(None);
        if let (Some(worker), Some((program, file))) = (&self.worker, &self.text.file) {
            worker.opened(*program, file.clone());
        }
    }

    /// The file of the program and its machine time, s; `None` until a preview without alarm
    /// is complete.
    pub fn program_time(&self) -> Option<(&std::path::Path, f64)> {
        let made = &self.made;
        let complete =
            self.is_open && !made.path.partial && made.alarm.is_none() && !made.tried;
        let file = made.file.as_deref().filter(|_| complete)?;
        Some((file, made.times.spent().whole()))
    }

    /// Draws the view and handles its input.
    pub fn show(&mut self, ui: &mut Ui, language: Language) {
        self.receive_part(ui);
        let tools = Panel::top("lathe bar").frame(bar_frame());
        tools.show(ui, |ui| self.toolbar(ui, language));
        let state = Panel::bottom("lathe state").frame(side_frame());
        state.show(ui, |ui| self.state(ui, language));
        if self.instruments.in_hand == Instrument::Job {
            self.show_job(ui, language);
        }
        egui::CentralPanel::default()
            .frame(plain_frame())
            .show(ui, |ui| self.picture(ui, language));
    }

    /// Draws the job panel beside the picture.
    fn show_job(&mut self, ui: &mut Ui, language: Language) {
        let Some(part) = &self.part else { return };
        let tools = self.made.times.tools();
        // The job file must not be that of a program that is not selected.
        let selected = self.made.path.programs.current();
        let file = self.text.file.as_ref();
        let file = file.filter(|(program, _)| selected == Some(*program));
        let lathe = job::Lathe {
            job: &part.job,
            guessed: part.guessed,
            program: file.map(|(_, path)| path.as_path()),
            named: tools
                .iter()
                .map(|it| it.tool)
                .filter(|it| *it > 0)
                .collect(),
            running: part.block.is_some(),
            trouble: self.made.trouble.as_ref(),
        };
        focus::pass_over_edge(ui, "job");
        let panel = Panel::right("job").frame(side_frame());
        let clamped = panel
            .default_size(300.0)
            .size_range(220.0..=420.0)
            .show(ui, |ui| self.instruments.job.show(ui, &lathe, language))
            .inner;
        if let (Some(job), Some(worker)) = (clamped, &self.worker) {
            worker.clamp(job);
        }
    }

    /// Takes what the worker has found; called in every frame, so that a program has its
    /// job and its part before the view is opened.
    pub fn receive(&mut self, context: &Context) {
        let worker = self.worker.get_or_insert_with(|| {
            let worker = Worker::start(&self.console, context, &self.changed);
            worker.shared.visible.store(self.is_open, Ordering::Relaxed);
            if let Some(trial) = &self.text.trial {
                worker.try_out(Some(trial.program()));
            }
            if let Some((program, file)) = &self.text.file {
                worker.opened(*program, file.clone());
            }
            worker
        });
        if let Some(made) = worker.result() {
            if made.serial != self.made.serial {
                self.sight.camera = None;
                self.chosen = None;
                self.instruments.microscope.clear();
            }
            // The control has stored the text that was tried out: the trial ends.
            if let Some(trial) = &self.text.trial
                && !made.tried
                && made.path.programs.get(trial.id).is_some_and(|own| {
                    with_line_feeds(own.text()) == with_line_feeds(trial.tried.text())
                })
            {
                self.text.trial = None;
                worker.try_out(None);
            }
            // The passes have moved.
            if let Some(chosen) = &mut self.chosen {
                chosen.pass = made.path.pass_again(chosen.pass.take());
            }
            self.made = made;
        }
    }

    /// Takes the part, and hands it to the instrument in hand.
    fn receive_part(&mut self, ui: &Ui) {
        if let Some(part) = self.console.part.pop() {
            self.part = Some(part);
        }
        let Some(worker) = &self.worker else { return };
        let running = self.part.as_ref().is_some_and(|part| part.block.is_some());
        worker.shared.running.store(running, Ordering::Relaxed);
        if let Some(compared) = worker.compared() {
            self.instruments.microscope.receive(compared);
        }
        if let Some(part) = &self.part {
            match self.instruments.in_hand {
                Instrument::Path | Instrument::Job => {}
                Instrument::Caliper => self.instruments.caliper.take(&part.section, ui.ctx()),
                Instrument::Microscope => {
                    // A growing path is compared once it is complete.
                    let ready = !running && !self.made.path.partial;
                    if ready && self.instruments.microscope.asks(&self.made.path, &part.job) {
                        worker.compare(Arc::clone(&part.job));
                    }
                    let clamped = part.job.stock.jaw_front();
                    self.instruments
                        .microscope
                        .take(&part.section, clamped, ui.ctx());
                }
            }
        }
    }

    fn picture(&mut self, ui: &mut Ui, language: Language) {
        let room = ui.available_rect_before_wrap();
        let sense = Sense::CLICK | Sense::DRAG;
        let response = ui.interact(room, ui.scope_id().with("lathe"), sense);
        response.widget_info(|| {
            let name = say::lathe_picture().text(language);
            WidgetInfo::labeled(Role::Canvas, true, name)
        });
        if room.width() < 20.0 || room.height() < 20.0 {
            return;
        }
        let mut camera = self.camera_in(room);
        self.point(ui, &response, &mut camera);
        let tip = self.part.as_ref().map(|part| place(part.tip));
        if let (true, Some(tip)) = (self.sight.follow, tip) {
            camera.follow(tip);
            self.sight.camera = Some(camera);
        }
        let painter = ui.painter().with_clip_rect(room);
        let solid = self.part.as_ref().filter(|_| self.sight.solid);
        let mut tool_drawn = false;
        if let Some(part) = solid {
            tool_drawn = self.space.draw(&painter, &camera, part);
        } else {
            grid::lines(&painter, &camera);
            if let Some(part) = &self.part {
                self.solids.draw(&painter, &camera, part);
            }
        }
        let path = &self.made.path;
        if self.instruments.in_hand == Instrument::Microscope {
            self.instruments.microscope.draw(&painter, &camera);
        } else {
            self.trail.draw(&painter, &camera, path);
        }
        if let Some(fault) = self.made.fault {
            lines::mark_wrong(&painter, &camera, &self.made.path, fault);
        }
        if let Some(Chosen { block, pass }) = &self.chosen {
            // Highlighting all passes of a cycle would hide the part.
            match pass {
                Some(pass) => lines::highlight_pass(&painter, &camera, &path.pieces_of(pass)),
                None => lines::highlight(&painter, &camera, path, *block, false),
            }
        }
        if let Some(part) = &self.part {
            let tip = place(part.tip);
            if let Some(block) = part.block.map(block_of) {
                match path.pass_in_work(block, tip) {
                    Some(pass) => {
                        lines::highlight_pass(&painter, &camera, &path.pieces_of(pass));
                    }
                    None => lines::highlight(&painter, &camera, path, block, true),
                }
            }
            if solid.is_none() {
                tool_drawn = self.solids.tool(&painter, &camera, part, tip);
            }
            if !tool_drawn {
                solids::tip(&painter, &camera, tip);
            }
            if part.coolant {
                alive::coolant(&painter, &camera, tip);
            }
            overlay::hits(&painter, &camera, part);
        }
        if self.instruments.in_hand == Instrument::Caliper {
            self.instruments.caliper.draw(&painter, &camera, language);
        }
        if solid.is_none() {
            grid::figures(&painter, &camera);
        }
        if let Some(part) = &self.part {
            overlay::states(&painter, room, part, language);
        }
    }

    /// The camera that the user has moved, or one that shows everything.
    fn camera_in(&self, room: Rect) -> Camera {
        if let Some(camera) = self.sight.camera {
            return camera.within(room);
        }
        if let Some(part) = self.part.as_ref().filter(|_| self.sight.solid) {
            let stock = &part.job.stock;
            let (_, jaws) = stock.chuck_section();
            let shown = [&stock.section(), &jaws, &stock.tailstock_section()];
            return Camera::fit_solid(&shown, self.is_rear(), room);
        }
        let part = self.part.as_ref().map(|part| {
            let stock = &part.job.stock;
            let (radius, front) = (stock.radius() as f32, stock.front() as f32);
            let back = stock.jaw_front() as f32 - CHUCK_SHOWN;
            Rect::from_min_max(pos2(back, -radius), pos2(front, radius))
        });
        let bounds = match (part, self.made.path.bounds) {
            (Some(part), Some(path)) => part.union(path),
            // The path shows where the tool is. Without a path the tool needs a margin.
            (Some(part), None) => part.expand2(ROOM_FOR_TOOL),
            (one, other) => one
                .or(other)
                .unwrap_or(Rect::from_center_size(Pos2::ZERO, vec2(200.0, 120.0))),
        };
        Camera::fit(bounds, self.is_rear(), room)
    }

    /// Whether the tool post is on the far side of the spindle; true until the first result.
    const fn is_rear(&self) -> bool {
        self.made.rear || self.made.serial == 0
    }

    /// Handles the mouse and touch input in the picture.
    fn point(&mut self, ui: &Ui, response: &Response, camera: &mut Camera) {
        let before = *camera;
        let hover = response.hover_pos();
        self.pointer = hover.map(|at| camera.part(at));
        if let Some(at) = hover {
            let (scrolled, pinched) =
                ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
            let factor = (scrolled * ZOOM).exp() * pinched;
            if factor != 1.0 {
                camera.zoom(factor, at);
            }
        }
        if response.dragged() {
            let turns = response.dragged_by(PointerButton::Primary)
                && ui.input(|input| !input.modifiers.shift);
            if turns && self.sight.solid && self.part.is_some() {
                camera.orbit(response.drag_delta());
            } else {
                camera.pan(response.drag_delta());
            }
        }
        if *camera != before {
            self.sight.camera = Some(*camera);
        }
        if response.double_clicked() {
            self.sight.camera = None;
            *camera = self.camera_in(camera.room);
        } else if response.clicked()
            && let Some(at) = response.interact_pointer_pos()
        {
            let path = &self.made.path;
            match self.instruments.in_hand {
                Instrument::Caliper => self.instruments.caliper.click(),
                Instrument::Path | Instrument::Microscope | Instrument::Job => {
                    let piece = path.nearest(camera.part(at), REACH / camera.scale);
                    self.chosen = piece.and_then(|piece| {
                        let pass = path.pass_at(piece).cloned();
                        let block = path.block_at(piece)?;
                        Some(Chosen { block, pass })
                    });
                    let block = self.chosen.as_ref().map(|chosen| chosen.block);
                    self.text.wish = block.map(|block| self.show_block(block, false));
                }
            }
        }
        match self.instruments.in_hand {
            Instrument::Path | Instrument::Job => {}
            Instrument::Caliper => self.instruments.caliper.point(self.pointer, camera),
            Instrument::Microscope => self.instruments.microscope.point(self.pointer, camera),
        }
    }

    /// Takes the request to the program view.
    pub const fn take_wish(&mut self) -> Option<Wish> {
        self.text.wish.take()
    }

    /// Tries out a text from the program view if it belongs to the selected program and
    /// differs from the control's text.
    pub fn typed(&mut self, document: &Document) {
        let id = match &document.origin {
            Origin::Memory(number) => ProgramId::Stored(*number),
            Origin::File(path, _) => match &self.text.file {
                Some((id, file)) if file == path => *id,
                _ => return,
            },
            Origin::New => return,
        };
        let programs = &self.made.path.programs;
        let own = match &self.text.trial {
            Some(trial) if trial.id == id => Some(&trial.own),
            _ => programs.get(id),
        };
        let own = own.filter(|_| self.is_open && programs.current() == Some(id));
        let Some(own) = own.cloned() else {
            return;
        };
        let tried = document.program();
        let same = with_line_feeds(own.text()) == tried.text();
        let trial = (!same).then_some(Trial { id, own, tried });
        if trial != self.text.trial {
            self.try_out(trial);
        }
    }

    fn show_block(&self, block: Block, open: bool) -> Wish {
        Wish::Show {
            program: block.program,
            line: block.line,
            text: self.made.path.text(block).to_owned(),
            open,
        }
    }

    /// Executes another text than the control's, or the control's text again.
    fn try_out(&mut self, trial: Option<Trial>) {
        if let Some(worker) = &self.worker {
            let text = trial.as_ref();
            worker.try_out(text.map(Trial::program));
        }
        self.text.trial = trial;
    }

    /// Centres a position and enlarges the picture to a close view.
    fn look_closely(&mut self, at: Pos2) {
        self.look_at(at);
        if let Some(camera) = &mut self.sight.camera {
            camera.scale = camera.scale.max(CLOSE);
        }
    }

    /// Centres a position at the current scale.
    fn look_at(&mut self, at: Pos2) {
        let room = Rect::from_center_size(Pos2::ZERO, vec2(600.0, 400.0));
        let camera = self.camera_in(room);
        self.sight.camera = Some(camera.centred(at));
    }
}

/// Converts a point to part coordinates of the view: x is Z, y is X as a radius.
fn place(point: Point) -> Pos2 {
    pos2(point.z as f32, point.x as f32)
}

const fn block_of(source: Source) -> Block {
    Block {
        program: source.program,
        line: source.line,
    }
}
