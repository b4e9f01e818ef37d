//! The views beside the panel: machine, lathe, program, scope, fault bench, ladder, link page,
//! lessons, commissioning, transfer, parameters and offsets, project. Each is drawn in a pane
//! of the window or in a separate window. A closed view costs no time, except that the machine
//! view still finds the job of the selected program: the kernel always cuts the part.

mod bench;
mod commission;
mod data;
mod exercise;
mod form;
pub mod header;
pub mod interface;
mod ladder;
pub mod lathe;
mod lesson;
mod link;
mod machine;
pub mod program;
pub mod project;
mod registry;
mod scope;
mod separate_window;
mod text_files;
mod transfer;
mod undo_panel;

use std::sync::Arc;

use egui::{Context, Frame, Margin, Pos2, ScrollArea, Sense, Ui, UiBuilder, Vec2};
use gsk_host::kernel::monitor::MachineView;
use gsk_host::kernel::part::PartView;
use gsk_host::kernel::{Command, Console};

use super::layout::floating::WindowScreen;
use super::layout::{Layouts, MIN_SHARE};
use super::view::{VIEWS, ViewId};
use crate::focus;
use crate::samples::SampleRequest;
use crate::settings::StoredSceneCamera;
use crate::shown_content::ShownContent;
use crate::theme;
use crate::widgets::questions::Unsaved;
use gsk_messages::Language;
use interface::{ViewFrame, ViewStart};
use ladder::LadderView;
use lesson::LessonView;
use machine::{LatheView, ProgramViewRequest};
use program::ProgramView;
pub use program::{halt_text, show_halt_buttons};
use project::ProjectView;
use registry::AllViews;
use separate_window::ViewWindow;
pub use separate_window::{PanelInput, SeparateWindows, show_or_close};
use transfer::TransferView;

/// All views of the window, and which of them are open.
pub struct Views {
    /// The views that were open in the last frame.
    open_views: Vec<ViewId>,
    /// Initial corner and size of each open separate window, points.
    window_geometry: Vec<(ViewId, Option<Pos2>, Vec2)>,
    all: AllViews,
    console: Console,
    machine: Option<Arc<MachineView>>,
    /// The part, as it was received last; `None` before the first one.
    part: Option<Arc<PartView>>,
    /// The view that another view has requested to open; `None` without a request.
    view_to_open: Option<ViewId>,
    shown: Arc<ShownContent>,
}

/// The views that show more of the PLC memory than the inputs.
const PLC_VIEWS: [ViewId; 3] = [ViewId::Ladder, ViewId::Commission, ViewId::Link];

impl Views {
    /// Creates all views in the closed state.
    pub fn new(start: ViewStart<'_>) -> Self {
        Self {
            open_views: Vec::new(),
            window_geometry: Vec::new(),
            all: AllViews::create(start),
            console: start.console.clone(),
            machine: None,
            part: None,
            view_to_open: None,
            shown: Arc::default(),
        }
    }

    /// Sets where the views report what they show.
    pub fn report_shown_content(&mut self, shown: Arc<ShownContent>) {
        self.shown = shown;
    }

    /// Opens and closes views to match `layouts`. Starts or stops the kernel's reports of the
    /// machine state and the part, and receives the newest ones.
    pub fn follow(&mut self, context: &Context, layouts: &Layouts) {
        self.all.lathe.receive(context);
        let picked = self.all.lathe.kept_feature();
        self.all.lessons.exercises().set_picked_feature(picked);
        let was_monitoring = self.needs_machine_state();
        let was_showing_part = self.needs_part();
        for row in &VIEWS {
            let view = row.view;
            let open = layouts.is_open(view);
            if open == self.open_views.contains(&view) {
                continue;
            }
            if open {
                self.open_views.push(view);
            } else {
                self.open_views.retain(|shown| *shown != view);
            }
            match self.all.get(view) {
                Some(drawn) if open => drawn.open(),
                Some(drawn) => drawn.close(),
                None => {}
            }
        }
        let shows_plc = PLC_VIEWS.iter().any(|view| layouts.is_open(*view));
        let is_monitoring = self.needs_machine_state();
        if is_monitoring != was_monitoring {
            self.machine = None;
            self.console.send(Command::Monitor(is_monitoring));
        }
        if let Some(machine) = self.console.machine.pop() {
            self.machine = Some(Arc::new(machine));
        }
        let is_showing_part = self.needs_part();
        if context.input(|input| !input.events.is_empty() || input.pointer.any_down()) {
            self.shown.record_input();
        }
        self.shown
            .set_views(shows_plc, is_monitoring || is_showing_part);
        if is_showing_part != was_showing_part {
            self.part = None;
            self.console.send(Command::ShowPart(is_showing_part));
            self.all.lathe.set_path_shown(is_showing_part);
        }
        if let Some(part) = self.console.part.pop() {
            self.part = Some(part);
        }
    }

    /// Deletes the OpenGL objects before the window closes.
    pub fn release(&self, gl: &eframe::glow::Context) {
        self.all.scene.release(gl);
    }

    /// Takes the sample that the operator has chosen among the lessons, if any.
    pub const fn take_sample(&mut self) -> Option<SampleRequest> {
        self.all.lessons.take_sample()
    }

    pub const fn program(&mut self) -> &mut ProgramView {
        &mut self.all.program
    }

    pub const fn lathe(&mut self) -> &mut LatheView {
        &mut self.all.lathe
    }

    /// Returns the camera of the lathe view, for the settings.
    pub fn scene_camera(&self) -> Option<StoredSceneCamera> {
        self.all.scene.stored_camera()
    }

    pub const fn ladder(&mut self) -> &mut LadderView {
        &mut self.all.ladder
    }

    pub const fn lessons(&mut self) -> &mut LessonView {
        &mut self.all.lessons
    }

    /// The view for file transfers between the PC and a control.
    pub const fn transfer(&self) -> &TransferView {
        &self.all.transfer
    }

    pub const fn project(&mut self) -> &mut ProjectView {
        &mut self.all.project
    }

    /// The first kind of unsaved work that closing the window would lose: program text, then
    /// job, then project. `None` if there is none.
    pub fn first_unsaved(&self) -> Option<Unsaved> {
        self.all.first_unsaved()
    }

    /// Whether an open view shows the state of the machine and the PLC.
    fn needs_machine_state(&self) -> bool {
        self.open_views.iter().any(|view| view.row().is_monitor)
    }

    /// Drops the part that was received last and requests that of the machine that is shown now,
    /// which may have none.
    pub fn renew_part(&mut self) {
        self.part = None;
        if self.needs_part() {
            self.console.send(Command::ShowPart(true));
        }
    }

    /// Whether any open view shows the part.
    fn needs_part(&self) -> bool {
        self.open_views.iter().any(|view| view.row().shows_part)
    }

    /// Draws the content of a view. `native`: the view is in a separate window and receives
    /// all keys.
    fn draw_content(&mut self, ui: &mut Ui, view: ViewId, language: Language, native: bool) {
        let frame = ViewFrame {
            language,
            owns_keys: native,
            machine: self.machine.as_ref(),
            part: self.part.as_ref(),
        };
        if view == ViewId::Lathe {
            self.all.scene.set_path(self.all.lathe.path());
        }
        if let Some(drawn) = self.all.get(view) {
            drawn.show(ui, frame);
        }
        self.pass_requests_on();
    }

    /// Passes requests of a view to the view that handles them.
    fn pass_requests_on(&mut self) {
        if let Some(document) = self.all.program.take_changed_document() {
            self.all.lathe.try_typed_text(document);
        }
        self.handle_program_request();
        if self.all.lathe.take_space_request() {
            self.view_to_open = Some(ViewId::Lathe);
        }
        if self.all.lessons.take_bench_request() {
            self.view_to_open = Some(ViewId::Bench);
        }
        if self.all.commission.take_scope_request() && !self.open_views.contains(&ViewId::Scope) {
            self.view_to_open = Some(ViewId::Scope);
        }
    }

    /// Passes a request of the machine view to the program view.
    fn handle_program_request(&mut self) {
        let Some(request) = self.all.lathe.take_program_request() else {
            return;
        };
        let is_open = self.open_views.contains(&ViewId::Program);
        match request {
            ProgramViewRequest::ShowBlock {
                open_view: false, ..
            } if !is_open => return,
            ProgramViewRequest::ShowBlock {
                program,
                line,
                text,
                ..
            } => self.all.program.show_block(program, line, text),
            ProgramViewRequest::ReplaceText {
                program,
                control_text: own,
                new_text: text,
            } => self.all.program.replace_text(program, own, text),
        }
        if !is_open {
            self.view_to_open = Some(ViewId::Program);
        }
    }

    /// Takes the view that another view has requested to open, if any.
    pub const fn take_view_to_open(&mut self) -> Option<ViewId> {
        self.view_to_open.take()
    }

    /// Draws a docked view into its pane, with scroll bars if it is larger than the pane.
    /// Returns the action of its header, if any.
    pub fn show_docked(
        &mut self,
        ui: &mut Ui,
        view: ViewId,
        language: Language,
    ) -> Option<header::HeaderAction> {
        let row = view.row();
        let placement = match ui.ctx().embed_viewports() {
            true => header::ViewPlacement::SingleWindow,
            false => header::ViewPlacement::Docked,
        };
        let action = header::show(ui, row, language, placement);
        let mut content_rect = ui.max_rect();
        content_rect.min.y = content_rect
            .bottom()
            .min(content_rect.top() + header::HEIGHT);
        // The text of a lesson scrolls above its buttons, and the picture of the lathe and the lanes
        // of the scope shrink: a low pane shows their lower edge.
        let share = match row.shows_part || row.view == ViewId::Scope {
            true => MIN_SHARE,
            false => Vec2::splat(1.0),
        };
        // The layout measures panes with their header.
        let least = Vec2::from(row.min_size) * share - egui::vec2(0.0, header::HEIGHT);
        let size = content_rect.size().max(least);
        ui.scope_builder(UiBuilder::new().max_rect(content_rect), |ui| {
            ScrollArea::both()
                .id_salt(("docked", row.view))
                .auto_shrink([false, false])
                .show(ui, |ui| {
                    let (rect, _) = ui.allocate_exact_size(size, Sense::HOVER);
                    let mut inside = ui.new_child(UiBuilder::new().max_rect(rect));
                    inside.set_clip_rect(inside.clip_rect().intersect(rect));
                    self.draw_content(&mut inside, view, language, false);
                    focus::scroll_to_focus(ui);
                });
        });
        action
    }

    /// Draws the views in separate windows. Returns the keyboard input that they leave to the
    /// panel, and whether one of them has the focus.
    pub fn show_floating(
        &mut self,
        context: &Context,
        shared: &SeparateWindows,
        layouts: &mut Layouts,
    ) -> PanelInput {
        self.follow(context, layouts);
        let mut panel_input = PanelInput::default();
        let floating = layouts.floating();
        self.window_geometry
            .retain(|(view, ..)| floating.contains(view));
        for view in floating {
            let row = view.row();
            let opened = self.window_geometry.iter().find(|(open, ..)| *open == view);
            let opened = opened.map(|(_, corner, size)| (*corner, *size));
            let (corner, size) = opened.unwrap_or_else(|| {
                let screen = WindowScreen::of_main_window(context, shared.lcd);
                let frame = Vec2::new(0.0, header::HEIGHT + separate_window::MESSAGE_HEIGHT);
                let [wanted, least] = [row.size, row.min_size].map(|it| Vec2::from(it) + frame);
                let (corner, size) =
                    screen.place_window(layouts.stored_geometry(view), wanted, least);
                self.window_geometry.push((view, corner, size));
                (corner, size)
            });
            let window = ViewWindow {
                row,
                model: self.console.model,
                shared,
                corner,
                size,
            };
            let report = window.show(context, &mut panel_input, |ui| {
                let language = shared.language;
                let action = header::show(ui, row, language, header::ViewPlacement::Floating);
                self.draw_content(ui, view, language, true);
                action
            });
            if let Some(geometry) = report.geometry {
                layouts.store_geometry(view, geometry);
            }
            match report.header_action {
                Some(header::HeaderAction::Dock) => layouts.dock(view),
                Some(header::HeaderAction::Close) => layouts.toggle(view),
                Some(header::HeaderAction::Float) | None => {}
            }
        }
        if let Some(view) = panel_input.toggled_view {
            show_or_close(context, layouts, view);
        }
        if let Some(layout) = panel_input.chosen_layout {
            layouts.choose(layout);
        }
        panel_input
    }
}

fn bar_frame() -> Frame {
    Frame::new()
        .fill(theme::BAR_GROUND)
        .inner_margin(Margin::symmetric(8, 5))
}

fn side_frame() -> Frame {
    Frame::new()
        .fill(theme::SIDE_GROUND)
        .inner_margin(Margin::symmetric(8, 6))
}

fn plain_frame() -> Frame {
    Frame::new().fill(theme::DRAWING_GROUND)
}
