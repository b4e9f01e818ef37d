//! The views beside the panel: machine, program, scope, fault bench, ladder, link page,
//! lessons, commissioning, transfer, parameters and offsets, project. Each is drawn in a pane
//! of the window or in a separate window. A closed view costs no time.

mod aside;
mod bench;
mod commission;
mod data;
pub mod header;
mod ladder;
mod lesson;
mod link;
mod machine;
pub mod program;
pub mod project;
mod scope;
mod transfer;
mod written;

use std::collections::BTreeSet;
use std::sync::Arc;

use egui::{
    Color32, Context, Event, Frame, Margin, Pos2, Rect, ScrollArea, Sense, Ui, UiBuilder, Vec2,
    ViewportBuilder, ViewportId,
};
use gsk_link::LinkState;

use super::badge;
use super::layout::floating::{self, Screen};
use super::layout::{self, Layout, Layouts, Place};
use super::questions::Unsaved;
use super::view::{VIEWS, View, ViewRow, toggled};
use crate::kernel::monitor::MachineView;
use crate::kernel::{Command, Console};
use crate::pc::Remembered;
use crate::platform;
use crate::window::samples::SampleRequest;
use crate::window::{focus, keyboard};
use bench::Bench;
use commission::CommissionView;
use data::DataView;
use gsk_messages::Language;
use ladder::LadderView;
use lesson::LessonView;
use link::LinkPage;
use machine::{LatheView, Wish};
use program::ProgramView;
use project::{ProjectView, Projects};
use scope::Scope;
use transfer::TransferView;

/// All views, and which of them are open.
pub struct Views {
    /// The views that were open in the last frame.
    shown: Vec<View>,
    /// Initial corner and size of the open separate windows, points.
    opened: Vec<(View, Option<Pos2>, Vec2)>,
    scope: Scope,
    bench: Bench,
    ladder: LadderView,
    link: LinkPage,
    program: ProgramView,
    lathe: LatheView,
    lessons: LessonView,
    transfer: TransferView,
    commission: CommissionView,
    data: DataView,
    project: ProjectView,
    console: Console,
    machine: Option<Arc<MachineView>>,
    /// The view that another view requests to open.
    wanted: Option<View>,
}

impl Views {
    /// Creates all views closed. `solid`: the machine view shows the part as a solid.
    /// `finished`: names of the lessons that were completed earlier. `transfer`: port, speed
    /// and files of the last session. `projects`: the projects of the last session.
    pub fn new(
        console: &Console,
        solid: bool,
        finished: BTreeSet<String>,
        transfer: Remembered,
        projects: Projects,
    ) -> Self {
        Self {
            shown: Vec::new(),
            opened: Vec::new(),
            scope: Scope::new(console.clone()),
            bench: Bench::new(console.clone()),
            ladder: LadderView::new(console.clone()),
            link: LinkPage::new(console.clone()),
            program: ProgramView::new(console.clone()),
            lathe: LatheView::new(console.clone(), solid),
            lessons: LessonView::new(console.clone(), finished),
            transfer: TransferView::new(console.clone(), transfer),
            commission: CommissionView::new(console.clone()),
            data: DataView::new(console.clone()),
            project: ProjectView::new(console.clone(), projects),
            console: console.clone(),
            machine: None,
            wanted: None,
        }
    }

    /// Opens and closes views to match `layouts`. Starts or stops the monitoring of the
    /// machine in the kernel and receives the newest machine state.
    pub fn follow(&mut self, context: &Context, layouts: &Layouts) {
        self.lathe.receive(context);
        let before = self.monitors();
        for row in &VIEWS {
            let view = row.view;
            let open = layouts.is_open(view);
            if open == self.shown.contains(&view) {
                continue;
            }
            if open {
                self.shown.push(view);
            } else {
                self.shown.retain(|shown| *shown != view);
            }
            match (view, open) {
                (View::Scope, true) => self.scope.open(),
                (View::Scope, false) => self.scope.close(),
                (View::Ladder, false) => self.ladder.close(),
                (View::Link, true) => self.link.open(),
                (View::Link, false) => self.link.close(),
                (View::Machine, true) => self.lathe.open(),
                (View::Machine, false) => self.lathe.close(),
                (View::Transfer, false) => self.transfer.close(),
                (
                    View::Bench
                    | View::Ladder
                    | View::Program
                    | View::Lesson
                    | View::Transfer
                    | View::Commission
                    | View::Data
                    | View::Project,
                    _,
                ) => {}
            }
        }
        let after = self.monitors();
        if after != before {
            self.machine = None;
            self.console.send(Command::Monitor(after));
        }
        if let Some(machine) = self.console.machine.pop() {
            self.machine = Some(Arc::new(machine));
        }
    }

    /// The sample that was chosen among the lessons.
    pub const fn take_sample(&mut self) -> Option<SampleRequest> {
        self.lessons.take_sample()
    }

    pub const fn program(&mut self) -> &mut ProgramView {
        &mut self.program
    }

    /// The machine view.
    pub const fn lathe(&mut self) -> &mut LatheView {
        &mut self.lathe
    }

    pub const fn lessons(&mut self) -> &mut LessonView {
        &mut self.lessons
    }

    /// The PC's side of the serial port.
    pub const fn transfer(&self) -> &TransferView {
        &self.transfer
    }

    pub const fn project(&mut self) -> &mut ProjectView {
        &mut self.project
    }

    /// The first item that closing the window would lose: program text, then job, then
    /// project.
    pub fn unsaved(&self) -> Option<Unsaved> {
        let text = self.program.is_unsaved().then_some(Unsaved::Text);
        let job = || self.lathe.is_unsaved().then_some(Unsaved::Job);
        let project = || self.project.is_unsaved().then_some(Unsaved::Project);
        text.or_else(job).or_else(project)
    }

    /// Whether an open view needs the state of the machine and the PLC.
    fn monitors(&self) -> bool {
        self.shown.iter().any(|view| view.monitors())
    }

    /// Draws a view. `native`: it is in a separate window and receives all keys.
    fn content(&mut self, ui: &mut Ui, view: View, language: Language, native: bool) {
        match view {
            View::Scope => self.scope.show(ui, language, native),
            View::Link => self.link.show(ui, language),
            View::Program => {
                self.program.show(ui, language, native);
                if let Some(document) = self.program.newly_typed() {
                    self.lathe.typed(document);
                }
            }
            View::Machine => {
                self.lathe.show(ui, language);
                self.carry_out_wish();
            }
            View::Lesson => self.lessons.show(ui, language),
            // The web page has no ports: this arm lets the compiler drop the transfer view's
            // code.
            View::Transfer if !platform::has_ports() => {}
            View::Transfer => self.transfer.show(ui, language),
            View::Commission => {
                let machine = self.machine.as_ref();
                if self.commission.show(ui, language, machine) && !self.shown.contains(&View::Scope)
                {
                    self.wanted = Some(View::Scope);
                }
            }
            // The web page has no folders: this arm lets the compiler drop the project view's
            // code.
            View::Project if !platform::has_folders() => {}
            View::Project => self.project.show(ui, language),
            View::Data => self.data.show(ui, language, self.machine.as_ref()),
            View::Bench => self.bench.show(ui, language, self.machine.as_ref()),
            View::Ladder => {
                let machine = self.machine.as_ref();
                self.ladder.show(ui, language, machine, native);
            }
        }
    }

    /// Passes a request of the machine view to the program view.
    fn carry_out_wish(&mut self) {
        let Some(wish) = self.lathe.take_wish() else {
            return;
        };
        let is_open = self.shown.contains(&View::Program);
        match wish {
            Wish::Show { open: false, .. } if !is_open => return,
            Wish::Show {
                program,
                line,
                text,
                ..
            } => self.program.show_block(program, line, text),
            Wish::Take { program, own, text } => self.program.take_over(program, own, text),
        }
        if !is_open {
            self.wanted = Some(View::Program);
        }
    }

    /// Takes the view that another view requests to open.
    pub const fn take_wanted(&mut self) -> Option<View> {
        self.wanted.take()
    }

    /// Draws a docked view into its pane, with scroll bars if it is larger than the pane.
    pub fn show_docked(
        &mut self,
        ui: &mut Ui,
        view: View,
        language: Language,
    ) -> Option<header::Asked> {
        let row = view.row();
        let place = match ui.ctx().embed_viewports() {
            true => header::Place::Only,
            false => header::Place::Docked,
        };
        let asked = header::show(ui, row, language, place);
        let mut room = ui.max_rect();
        room.min.y = room.bottom().min(room.top() + header::HEIGHT);
        let size = room.size().max(Vec2::from(row.least));
        ui.scope_builder(UiBuilder::new().max_rect(room), |ui| {
            ScrollArea::both()
                .id_salt(("docked", row.view))
                .auto_shrink([false, false])
                .show(ui, |ui| {
                    let (place, _) = ui.allocate_exact_size(size, Sense::HOVER);
                    let mut inside = ui.new_child(UiBuilder::new().max_rect(place));
                    inside.set_clip_rect(inside.clip_rect().intersect(place));
                    self.content(&mut inside, view, language, false);
                    focus::follow(ui);
                });
        });
        asked
    }

    /// Draws the views in separate windows. Returns the keyboard input that they leave to the
    /// panel, and whether one of them has the focus.
    pub fn show_floating(
        &mut self,
        context: &Context,
        language: Language,
        board: Option<LinkState>,
        lcd: Option<Rect>,
        layouts: &mut Layouts,
    ) -> Typed {
        self.follow(context, layouts);
        let mut typed = Typed::default();
        let floating = layouts.floating();
        self.opened.retain(|(view, ..)| floating.contains(view));
        for view in floating {
            let row = view.row();
            let opened = self.opened.iter().find(|(open, ..)| *open == view);
            let opened = opened.map(|(_, corner, size)| (*corner, *size));
            let (corner, size) = opened.unwrap_or_else(|| {
                let screen = Screen::of(context, lcd);
                let header = Vec2::new(0.0, header::HEIGHT);
                let [wanted, least] = [row.size, row.least].map(|it| Vec2::from(it) + header);
                let (corner, size) = screen.open(layouts.place(view), wanted, least);
                self.opened.push((view, corner, size));
                (corner, size)
            });
            let window = OwnWindow {
                row,
                language,
                board,
                corner,
                size,
            };
            let left = window.show(context, &mut typed, |ui| {
                let asked = header::show(ui, row, language, header::Place::Floating);
                self.content(ui, view, language, true);
                asked
            });
            if let Some(place) = left.place {
                layouts.remember(view, place);
            }
            match left.asked {
                Some(header::Asked::Dock) => layouts.dock(view),
                Some(header::Asked::Close) => layouts.toggle(view),
                Some(header::Asked::Float) | None => {}
            }
        }
        if let Some(view) = typed.toggled {
            layouts.toggle(view);
        }
        if let Some(layout) = typed.chosen {
            layouts.choose(layout);
        }
        typed
    }
}

/// Keyboard input in the windows of views that is meant for the panel.
#[derive(Debug, Default)]
pub struct Typed {
    /// A window of a view has the focus.
    pub focused: bool,
    pub events: Vec<Event>,
    /// A jog key was suppressed because a list uses the cursor keys.
    pub jogs_in_list: bool,
    /// The view whose key was pressed in the window of another view.
    toggled: Option<View>,
    /// The layout whose key was pressed.
    chosen: Option<Layout>,
}

/// A separate window of one view.
struct OwnWindow {
    row: &'static ViewRow,
    language: Language,
    board: Option<LinkState>,
    /// Initial corner, points; `None`: the window manager places the window.
    corner: Option<Pos2>,
    size: Vec2,
}

/// What a view's window reports after a frame.
#[derive(Debug, Default)]
struct Left {
    asked: Option<header::Asked>,
    /// The current position and size of the window.
    place: Option<Place>,
}

impl OwnWindow {
    fn show(
        &self,
        context: &Context,
        typed: &mut Typed,
        mut add: impl FnMut(&mut Ui) -> Option<header::Asked>,
    ) -> Left {
        let row = self.row;
        let title = (row.name)().text(self.language);
        let id = format!("{:?}", row.view);
        let mut left = Left::default();
        let mut builder = ViewportBuilder::default()
            .with_title(badge::title(&format!("{title} - GSK980TD"), self.board))
            .with_app_id("gsk980td")
            .with_inner_size(self.size)
            .with_min_inner_size(Vec2::from(row.least).min(self.size));
        if let Some(corner) = self.corner {
            builder = builder.with_position(corner);
        }
        let viewport = ViewportId::from_hash_of(&id);
        context.show_viewport_immediate(viewport, builder, |ui, _| {
            badge::show(ui, &id, self.board, self.language);
            left.asked = add(ui);
            let typing = ui.ctx().egui_wants_keyboard_input();
            let mut all = ui.input(|input| input.events.clone());
            typed.jogs_in_list |= keyboard::beside_keeper(ui.ctx(), &mut all);
            ui.input(|input| {
                typed.focused |= input.focused;
                let toggled = toggled(&input.events);
                let again = toggled == Some(row.view);
                if again || input.viewport().close_requested() {
                    left.asked = Some(header::Asked::Close);
                }
                if !again {
                    typed.toggled = typed.toggled.or(toggled);
                }
                typed.chosen = typed.chosen.or(layout::chosen(&input.events));
                left.place = floating::place(input.viewport());
            });
            all.retain(|event| for_panel(event, row.view, typing));
            typed.events.extend(all);
        });
        left
    }
}

/// Whether a key pressed in a view's window is meant for the panel. Feed hold, emergency stop
/// and every release always are. Function keys and combinations with Ctrl or Alt are, unless
/// the view uses these keys itself or a text field is being filled.
fn for_panel(event: &Event, view: View, typing: bool) -> bool {
    let Event::Key { key, modifiers, .. } = event else {
        return false;
    };
    if keyboard::stops(event) {
        return true;
    }
    let number = key.name().strip_prefix('F');
    let function = number.is_some_and(|number| !number.is_empty());
    let combined = modifiers.ctrl || modifiers.alt;
    let own_keys = matches!(view, View::Ladder | View::Program);
    !own_keys && !typing && !modifiers.shift && (function || combined)
}

fn bar_frame() -> Frame {
    Frame::new()
        .fill(Color32::from_gray(34))
        .inner_margin(Margin::symmetric(8, 5))
}

fn side_frame() -> Frame {
    Frame::new()
        .fill(Color32::from_gray(28))
        .inner_margin(Margin::symmetric(8, 6))
}

fn plain_frame() -> Frame {
    Frame::new().fill(Color32::from_gray(18))
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Key, Modifiers};

    fn press(key: Key, modifiers: Modifiers) -> Event {
        Event::Key {
            key,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers,
        }
    }

    #[test]
    fn stops_reach_the_panel_from_everywhere_and_a_start_never_by_mistake() {
        let plain = Modifiers::NONE;
        for view in [View::Scope, View::Bench, View::Ladder, View::Link] {
            for typing in [false, true] {
                for key in [Key::F10, Key::F12] {
                    assert!(for_panel(&press(key, plain), view, typing));
                    assert!(for_panel(&press(key, Modifiers::SHIFT), view, typing));
                }
                assert!(!for_panel(&press(Key::X, plain), view, typing));
            }
            assert!(!for_panel(&press(Key::F9, plain), view, true));
        }
        // F9 saves in the ladder view, Ctrl+Z undoes.
        assert!(!for_panel(&press(Key::F9, plain), View::Ladder, false));
        assert!(!for_panel(
            &press(Key::Z, Modifiers::CTRL),
            View::Ladder,
            false
        ));
        assert!(for_panel(&press(Key::F9, plain), View::Scope, false));
        assert!(for_panel(
            &press(Key::ArrowLeft, Modifiers::CTRL),
            View::Scope,
            false
        ));
    }
}
