//! The machine view: the half section of the part with its clamping, or the same as a lit
//! solid, the tool at its live position, and the path of the selected program.

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
    Color32, Panel, PointerButton, Pos2, Rect, Response, Role, Sense, Ui, Vec2, WidgetInfo, pos2,
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

/// How near a click must be to the path, points.
const REACH: f32 = 8.0;
/// A point of the wheel makes the picture larger by that share.
const ZOOM: f32 = 0.004;
/// What of the chuck is in the fitted picture, mm before the jaws' front.
const CHUCK_SHOWN: f32 = 35.0;
/// Room round a part that no program cuts, mm.
const ROOM_FOR_TOOL: Vec2 = vec2(22.0, 14.0);
/// A place that is looked at closely: so many points a millimetre.
const CLOSE: f32 = 120.0;
const HIT: Color32 = Color32::from_rgb(255, 70, 60);

/// What the pointer does with the part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Instrument {
    #[default]
    /// Finds the blocks of the path.
    Path,
    /// Measures.
    Caliper,
    /// Compares the surface with the one that is meant.
    Microscope,
    /// Changes tools and stock.
    Job,
}

/// A block of the path, and the pass of the cycle it makes there.
#[derive(Clone, Debug)]
struct Chosen {
    block: Block,
    pass: Option<path::Pass>,
}

/// What the machine view asks of the program view.
#[derive(Clone, Debug, PartialEq)]
pub enum Wish {
    /// Show a block, and its text as far as is known.
    Show {
        /// The program.
        program: ProgramId,
        /// Line of the text, from 1.
        line: u32,
        /// What stands there.
        text: String,
        /// Even if the view is closed.
        open: bool,
    },
    /// Take another text in the place of one.
    Take {
        /// The program.
        program: ProgramId,
        /// The text of the control.
        own: String,
        /// The other one.
        text: String,
    },
}

/// The machine view.
pub struct LatheView {
    console: Console,
    /// Only while the view is open.
    worker: Option<Worker>,
    made: Made,
    part: Option<PartView>,
    text: Text,
    solids: Solids,
    space: Space,
    trail: Trail,
    clock: Clock,
    sight: Sight,
    crash_stops: bool,
    /// What was clicked.
    chosen: Option<Chosen>,
    /// Where the pointer is, position of the part.
    pointer: Option<Pos2>,
    instruments: Instruments,
    /// Jobs that a person changed.
    changed: worker::Changed,
}

/// The text of the program, and what other views have to do with it.
#[derive(Default)]
struct Text {
    /// The file that was opened last, and its program.
    file: Option<(ProgramId, PathBuf)>,
    /// Another text than the control's is carried out.
    trial: Option<Trial>,
    /// What other views are to do.
    wish: Option<Wish>,
}

/// What is done with the part.
#[derive(Default)]
struct Instruments {
    in_hand: Instrument,
    caliper: Caliper,
    microscope: Microscope,
    job: JobPanel,
}

impl LatheView {
    /// Closed: nothing is cut. `solid`: the part is shown as a solid.
    pub fn new(console: Console, solid: bool) -> Self {
        Self {
            console,
            worker: None,
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
            crash_stops: false,
            chosen: None,
            pointer: None,
            instruments: Instruments::default(),
            changed: worker::Changed::default(),
        }
    }

    /// Pieces of the path that is drawn.
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

    /// The part costs nothing any more.
    pub fn close(&mut self) {
        self.worker = None;
        self.part = None;
        self.made = Made::default();
        self.console.send(Command::Job(None));
    }

    /// A program was opened in the window: its job may lie beside its file.
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

    /// The file of the program and its machine time, s, once the preview is complete.
    pub fn program_time(&self) -> Option<(&std::path::Path, f64)> {
        let made = &self.made;
        let complete = !made.path.partial && made.alarm.is_none() && !made.tried;
        let file = made.file.as_deref().filter(|_| complete)?;
        Some((file, made.times.spent().whole()))
    }

    /// Draws it and takes its input.
    pub fn show(&mut self, ui: &mut Ui, language: Language) {
        self.receive(ui);
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

    /// Tools and stock beside the picture.
    fn show_job(&mut self, ui: &mut Ui, language: Language) {
        let Some(part) = &self.part else { return };
        let tools = self.made.times.tools();
        // The job of another program than the selected one has no place beside this file.
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

    fn receive(&mut self, ui: &Ui) {
        let worker = self.worker.get_or_insert_with(|| {
            let worker = Worker::start(&self.console, ui.ctx(), &self.changed);
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
            // What was tried out has been stored: the control has no other text any more.
            if let Some(trial) = &self.text.trial
                && !made.tried
                && made.path.programs.get(trial.id).is_some_and(|own| {
                    with_line_feeds(own.text()) == with_line_feeds(trial.tried.text())
                })
            {
                self.text.trial = None;
                worker.try_out(None);
            }
            // The passes lie elsewhere now.
            if let Some(chosen) = &mut self.chosen {
                chosen.pass = made.path.pass_again(chosen.pass.take());
            }
            self.made = made;
        }
        if let Some(part) = self.console.part.pop() {
            self.part = Some(part);
        }
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
                    // A path that still grows is compared when it has come to its end.
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
            // A cycle of many passes, all of them lit, would hide the part.
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

    /// The picture that somebody has moved, or everything.
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
            // Where the tool stands is seen by its path; without one it has some room.
            (Some(part), None) => part.expand2(ROOM_FOR_TOOL),
            (one, other) => one
                .or(other)
                .unwrap_or(Rect::from_center_size(Pos2::ZERO, vec2(200.0, 120.0))),
        };
        Camera::fit(bounds, self.is_rear(), room)
    }

    /// The tool post is behind the spindle; so it is as long as nothing else is known.
    const fn is_rear(&self) -> bool {
        self.made.rear || self.made.serial == 0
    }

    /// What mouse and fingers do.
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

    /// What other views are to do.
    pub const fn take_wish(&mut self) -> Option<Wish> {
        self.text.wish.take()
    }

    /// A text was typed: where the control has another one of the same program, it is
    /// tried out.
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
        let Some(own) = own.filter(|_| programs.current() == Some(id)).cloned() else {
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

    /// Carries another text out than the control's, or its own again.
    fn try_out(&mut self, trial: Option<Trial>) {
        if let Some(worker) = &self.worker {
            let text = trial.as_ref();
            worker.try_out(text.map(Trial::program));
        }
        self.text.trial = trial;
    }

    /// Shows a position in the middle, large.
    fn look_closely(&mut self, at: Pos2) {
        self.look_at(at);
        if let Some(camera) = &mut self.sight.camera {
            camera.scale = camera.scale.max(CLOSE);
        }
    }

    /// Shows a position in the middle, as large as it is.
    fn look_at(&mut self, at: Pos2) {
        let room = Rect::from_center_size(Pos2::ZERO, vec2(600.0, 400.0));
        let camera = self.camera_in(room);
        self.sight.camera = Some(camera.centred(at));
    }
}

/// A point as the view has it: Z, and X as a radius.
fn place(point: Point) -> Pos2 {
    pos2(point.z as f32, point.x as f32)
}

const fn block_of(source: Source) -> Block {
    Block {
        program: source.program,
        line: source.line,
    }
}
