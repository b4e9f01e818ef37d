//! The ladder view: rungs with live power flow, search, cross reference, forced bits, halt and
//! step; messages, comments and initial data as tables; editing.

mod block;
mod change;
mod directive;
mod draft;
mod draw;
mod edit;
mod layout;
mod search;
mod side;
mod tables;
mod value;
mod words;

use std::sync::Arc;

use crossbeam::queue::ArrayQueue;
use egui::{Panel, Pos2, RichText, ScrollArea, Sense, Ui, vec2};
use gsk_core::cnc::{LadderStep, Request};
use gsk_core::memory::Refusal;
use gsk_core::plc::address::BitAddress;
use gsk_core::plc::{Ladder, PlcAddress, Statement};

use crate::kernel::monitor::MachineView;
use crate::kernel::{Command, Console};
use crate::window::focus;
use draft::Draft;
use draw::Sheet;
use edit::Editor;
use gsk_messages::{Language, Message, say};
use layout::Drawing;
use search::Search;

/// Width from which the side list is always shown beside the rungs, points.
const WIDE: f32 = 940.0;

/// The tabs of the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Tab {
    Rungs,
    List,
    Messages,
    Comments,
    StartValues,
}

impl Tab {
    const ALL: [Self; 5] = [
        Self::Rungs,
        Self::List,
        Self::Messages,
        Self::Comments,
        Self::StartValues,
    ];

    fn name(self) -> Message {
        match self {
            Self::Rungs => say::ladder_tab_rungs(),
            Self::List => say::ladder_tab_list(),
            Self::Messages => say::ladder_tab_messages(),
            Self::Comments => say::ladder_tab_comments(),
            Self::StartValues => say::ladder_tab_initial_data(),
        }
    }
}

/// The state of the ladder view.
pub struct LadderView {
    console: Console,
    tab: Tab,
    comments: bool,
    drawing: Option<Drawing>,
    /// The number of uses of each address in the drawn ladder.
    uses: Vec<(PlcAddress, usize)>,
    /// The selected statement, as an index in the program.
    chosen: Option<usize>,
    /// The height to scroll to in the next frame, points from the top.
    scroll_to: Option<f32>,
    search: Search,
    editing: bool,
    draft: Option<Draft>,
    editor: Option<Editor>,
    /// Fields of the selected row of a table.
    row: Vec<String>,
    /// Why the row was refused.
    complaint: Option<String>,
    /// The address that the editing tools use, as typed.
    address: String,
    /// The rung to scroll to once it is drawn.
    show_rung: Option<u32>,
    /// The line to scroll to in the list, from 1.
    list_line: Option<u32>,
    /// Why the control would refuse a ladder now; `None` if it would take one.
    refused: Option<Refusal>,
    /// A list that was read from a file.
    opened: Arc<ArrayQueue<String>>,
}

impl LadderView {
    /// Creates the view at the first rung.
    pub fn new(console: Console) -> Self {
        Self {
            console,
            tab: Tab::Rungs,
            comments: true,
            drawing: None,
            uses: Vec::new(),
            chosen: None,
            scroll_to: None,
            search: Search::default(),
            editing: false,
            draft: None,
            editor: None,
            row: Vec::new(),
            complaint: None,
            address: String::new(),
            show_rung: None,
            list_line: None,
            refused: None,
            opened: Arc::new(ArrayQueue::new(1)),
        }
    }

    /// Lets a halted ladder run again when the view is closed.
    pub fn close(&mut self) {
        self.ask(Request::HaltLadder(false));
    }

    fn ask(&self, request: Request) {
        self.console.send(Command::Ask(Box::new(request)));
    }

    /// Draws the view and handles its input. `own_keys`: the view is in a separate window and
    /// handles editing keys.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        language: Language,
        machine: Option<&Arc<MachineView>>,
        own_keys: bool,
    ) {
        let Some(machine) = machine else {
            ui.centered_and_justified(|ui| ui.label(say::window_one_moment().text(language)));
            return;
        };
        self.follow(machine);
        if own_keys {
            self.editing_keys(ui);
        }
        self.draw_anew(&self.shown(machine));
        let bar = Panel::top("ladder bar").frame(super::bar_frame());
        bar.show(ui, |ui| self.toolbar(ui, language, machine));
        if self.editing {
            let tools = Panel::top("ladder tools").frame(super::bar_frame());
            tools.show(ui, |ui| self.edit_bar(ui, language));
        }
        // In a narrow view the coils use the width of the side list until an element is
        // selected.
        let has_room = ui.available_width() >= WIDE;
        let has_side = has_room || self.chosen.is_some() || !machine.plc.forces().is_empty();
        let line = Panel::bottom("ladder state").frame(super::bar_frame());
        line.show(ui, |ui| {
            self.state_line(ui, language, machine, has_side || self.tab != Tab::Rungs);
        });
        if self.tab == Tab::Rungs && self.editing {
            focus::pass_over_edge(ui, "rung editor");
            let editor = Panel::bottom("rung editor")
                .default_size(132.0)
                .size_range(80.0..=400.0)
                .resizable(true)
                .frame(super::side_frame());
            editor.show(ui, |ui| self.rung_editor(ui, language));
        }
        if self.tab == Tab::Rungs && has_side {
            let side = Panel::right("ladder side")
                .exact_size(side::width(ui.available_width()))
                .resizable(false)
                .frame(super::side_frame());
            side.show(ui, |ui| self.side(ui, language, machine));
        }
        egui::CentralPanel::default()
            .frame(super::plain_frame())
            .show(ui, |ui| match self.tab {
                Tab::Rungs => self.rungs(ui, language, machine),
                Tab::List => self.list(ui, language, machine),
                Tab::Messages => self.messages(ui, language, machine),
                Tab::Comments => self.comment_table(ui, language, machine),
                Tab::StartValues => self.start_values(ui, language, machine),
            });
    }

    /// Computes the positions of the rungs when the ladder or the choice of comments has
    /// changed.
    fn draw_anew(&mut self, ladder: &Arc<Ladder>) {
        let known = self.drawing.as_ref();
        if known.is_some_and(|drawing| drawing.is_of(ladder, self.comments)) {
            return;
        }
        let same = known.is_some_and(|drawing| Arc::ptr_eq(&drawing.ladder, ladder));
        if !same {
            let last = ladder.statements().len().saturating_sub(1);
            self.chosen = self.chosen.filter(|_| self.editing).map(|at| at.min(last));
            self.search.clear();
            let uses = |subject: PlcAddress| (subject, ladder.references(subject).len());
            self.uses = ladder.addresses().into_iter().map(uses).collect();
        }
        let drawing = Drawing::new(ladder, self.comments);
        // The selected rung remains in view when comments are switched on or off.
        let rung = self.chosen.and_then(|at| ladder.statements().get(at));
        let place = rung.and_then(|statement| drawing.rung(statement.rung));
        self.scroll_to = place.filter(|_| same).map(|placed| placed.top);
        self.drawing = Some(drawing);
    }

    fn toolbar(&mut self, ui: &mut Ui, language: Language, machine: &MachineView) {
        ui.horizontal_wrapped(|ui| {
            for tab in Tab::ALL {
                if ui
                    .selectable_label(self.tab == tab, tab.name().text(language))
                    .clicked()
                {
                    self.tab = tab;
                    self.row.clear();
                    self.complaint = None;
                }
            }
            ui.separator();
            let halted = machine.halted;
            let word = if halted {
                say::ladder_run().text(language)
            } else {
                say::ladder_halt().text(language)
            };
            let hint = say::ladder_halt_hint().text(language);
            let button = egui::Button::new(word).min_size(vec2(52.0, 0.0));
            if ui.add(button).on_hover_text(hint).clicked() {
                self.ask(Request::HaltLadder(!halted));
            }
            for (word, step) in [
                (say::ladder_one_scan().text(language), LadderStep::Slot),
                (say::ladder_one_rung().text(language), LadderStep::Rung),
            ] {
                if ui.add_enabled(halted, egui::Button::new(word)).clicked() {
                    self.ask(Request::StepLadder(step));
                    if let Some(next) = machine.plc.next_rung() {
                        self.jump(next);
                    }
                }
            }
            ui.separator();
            let edit = egui::Button::selectable(self.editing, say::ladder_edit().text(language));
            if ui.add(edit).clicked() {
                self.toggle_editing(machine);
            }
            if self.tab == Tab::Rungs {
                ui.separator();
                ui.checkbox(
                    &mut self.comments,
                    say::ladder_show_comments().text(language),
                );
                ui.separator();
                let ladder = self.shown(machine);
                self.search_field(ui, language, &ladder);
            }
        });
    }

    /// Scrolls to a rung.
    fn jump(&mut self, rung: u32) {
        self.tab = Tab::Rungs;
        let placed = self.drawing.as_ref().and_then(|drawing| drawing.rung(rung));
        self.scroll_to = placed.map(|placed| placed.top);
    }

    /// Selects a statement and scrolls to its rung.
    fn go_to(&mut self, ladder: &Ladder, at: usize) {
        self.chosen = Some(at);
        if let Some(statement) = ladder.statements().get(at) {
            self.jump(statement.rung);
        }
    }

    fn rungs(&mut self, ui: &mut Ui, language: Language, machine: &MachineView) {
        let Some(drawing) = self.drawing.take() else {
            return;
        };
        let width = ui.available_width() - 14.0;
        if let Some(rung) = self.show_rung.take() {
            self.scroll_to = drawing.rung(rung).map(|placed| placed.top);
        }
        let plc = &machine.plc;
        let runs = Arc::ptr_eq(&drawing.ladder, plc.ladder());
        let forced = |bit: BitAddress| {
            let found = plc.forces().iter().find(|force| force.bit == bit);
            found.map(|force| force.value)
        };
        let complaints = self.complaints(&drawing.ladder, language);
        let sheet = Sheet {
            ladder: &drawing.ladder,
            memory: runs.then(|| plc.memory()),
            language,
            comments: self.comments,
            chosen: self.chosen,
            forced: &forced,
            sought: self.search.subject(),
            next: if machine.halted && runs {
                plc.next_rung()
            } else {
                None
            },
            complaints: &complaints,
            width,
        };
        let mut area = ScrollArea::both().auto_shrink([false, false]);
        let room = ui.available_height();
        if let Some(top) = self.scroll_to.take() {
            let offset = (top - room * 0.25).clamp(0.0, (drawing.height - room).max(0.0));
            area = area.vertical_scroll_offset(offset);
        }
        let mut clicked = None;
        area.show_viewport(ui, |ui, seen| {
            let wide = width.max(draw::width(drawing.columns, self.comments));
            let size = vec2(wide, drawing.height + 8.0);
            let (place, _) = ui.allocate_exact_size(size, Sense::HOVER);
            for placed in drawing.between(seen.top() - 8.0, seen.bottom()) {
                let corner = Pos2::new(place.left(), place.top() + 8.0 + placed.top);
                let power = if runs {
                    plc.power_flow(&placed.network)
                } else {
                    Vec::new()
                };
                clicked = draw::rung(ui, &sheet, placed, corner, &power).or(clicked);
            }
        });
        if let Some(at) = clicked {
            self.chosen = Some(at);
        }
        self.drawing = Some(drawing);
    }

    /// The compiler's messages about rungs: rung, whether it is an error, text.
    fn complaints(&self, ladder: &Ladder, language: Language) -> Vec<(u32, bool, String)> {
        let errors = self.draft.as_ref().filter(|_| self.editing);
        let errors = errors.map_or(&[][..], Draft::errors).iter();
        let errors = errors.map(|error| (true, error));
        let warnings = ladder.warnings().iter().map(|warning| (false, warning));
        errors
            .chain(warnings)
            .map(|(error, found)| (found.rung, error, words::finding(found, language)))
            .collect()
    }

    fn state_line(&self, ui: &mut Ui, language: Language, machine: &MachineView, has_side: bool) {
        let plc = &machine.plc;
        let ladder = plc.ladder();
        ui.horizontal_wrapped(|ui| {
            let (words, colour) = match (plc.fault(), machine.halted) {
                (Some(fault), _) => {
                    let words = fault.message().text(language);
                    (words, egui::Color32::from_rgb(255, 120, 96))
                }
                (None, true) => {
                    let rung = plc.next_rung().unwrap_or(0);
                    (say::ladder_halted(rung).text(language), draw::HELD)
                }
                (None, false) => (say::ladder_running().text(language), draw::LIVE),
            };
            ui.label(RichText::new(words).color(colour));
            ui.separator();
            let header = ladder.header();
            let about = [&header.remark, &header.version, &header.unit];
            let about: Vec<&str> = about
                .iter()
                .map(|text| text.as_str())
                .filter(|text| !text.is_empty())
                .collect();
            ui.label(RichText::new(about.join("  ")).weak());
            ui.separator();
            let figures =
                say::ladder_size(ladder.steps(), ladder.rung_count(), ladder.part_count());
            let figures = figures.text(language);
            ui.label(RichText::new(figures).weak());
            if !has_side {
                ui.separator();
                let words = say::ladder_click_element().text(language);
                ui.label(RichText::new(words).weak());
            }
            if machine.next_ladder.is_some() {
                ui.separator();
                let words = say::ladder_new_at_power_on().text(language);
                ui.label(RichText::new(words).color(draw::HELD));
                let words = say::ladder_power_off_and_on().text(language);
                let hint = say::ladder_power_off_and_on_hint().text(language);
                if ui.button(words).on_hover_text(hint).clicked() {
                    self.console.send(Command::PowerCycle);
                }
            }
        });
    }
}

/// The addresses that a statement uses.
fn subjects(statement: &Statement) -> Vec<PlcAddress> {
    use gsk_core::plc::Operand;
    let named = |operand: &Operand| match operand {
        Operand::Bit(bit) => Some(PlcAddress::Bit(*bit)),
        Operand::Byte(byte) => Some(PlcAddress::Byte(*byte)),
        _ => None,
    };
    statement.operands.iter().filter_map(named).collect()
}
