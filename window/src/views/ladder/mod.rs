//! The ladder view: rungs with live power flow, search, cross reference, forced bits, halt and
//! step; messages, comments, parameters and initial data as tables; editing; a control at a port.

mod compiler_text;
mod control_line;
mod directive;
mod draft;
mod draw;
mod edit;
mod element_change;
mod file_menu;
mod function_box;
mod layout;
mod operand_value;
mod parameter_wizard;
mod rung_clipboard;
mod search;
mod side;
mod tables;

use std::sync::Arc;

use crossbeam::queue::ArrayQueue;
use egui::{Panel, Pos2, RichText, ScrollArea, Sense, Ui, vec2};
use gsk_core::cnc::{ControlRequest, LadderStep};
use gsk_core::memory::WriteRefusal;
use gsk_core::plc::address::BitAddress;
use gsk_core::plc::{Ladder, PlcAddress, Statement};
use gsk_host::kernel::monitor::MachineView;
use gsk_host::kernel::{Command, Console};
use gsk_host::pc::TransferSettings;

use super::interface::{View, ViewFrame, ViewStart};
use crate::focus;
use crate::theme;
use control_line::ControlLine;
use draft::LadderDraft;
use draw::RungContext;
use edit::RungEditor;
use gsk_messages::{Language, Message, say};
use layout::LadderDrawing;
use parameter_wizard::ParameterWizard;
use rung_clipboard::RungClipboard;
use search::LadderSearch;

/// Width of the view, points, from which the side list is always shown beside the rungs.
const WIDE_VIEW: f32 = 940.0;

/// The tabs of the ladder view: diagram, list and tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Tab {
    Rungs,
    List,
    Messages,
    Comments,
    Parameters,
    StartValues,
}

impl Tab {
    const ALL: [Self; 6] = [
        Self::Rungs,
        Self::List,
        Self::Messages,
        Self::Comments,
        Self::Parameters,
        Self::StartValues,
    ];

    fn name(self) -> Message {
        match self {
            Self::Rungs => say::ladder_tab_rungs(),
            Self::List => say::ladder_tab_list(),
            Self::Messages => say::ladder_tab_messages(),
            Self::Comments => say::ladder_tab_comments(),
            Self::Parameters => say::ladder_tab_parameters(),
            Self::StartValues => say::ladder_tab_initial_data(),
        }
    }
}

/// The state of the ladder view.
pub struct LadderView {
    console: Console,
    tab: Tab,
    with_comments: bool,
    drawing: Option<LadderDrawing>,
    /// Each address of the drawn ladder with the number of its uses.
    use_counts: Vec<(PlcAddress, usize)>,
    /// The selected statement, as an index in the program; `None` without a selection.
    selected: Option<usize>,
    /// Distance from the top to scroll to in the next frame, points; `None` does not scroll.
    scroll_to_y: Option<f32>,
    search: LadderSearch,
    clipboard: RungClipboard,
    wizard: ParameterWizard,
    line: ControlLine,
    is_editing: bool,
    draft: Option<LadderDraft>,
    editor: Option<RungEditor>,
    /// Texts in the fields of the selected table row.
    row_fields: Vec<String>,
    /// The reason why the typed row was refused; `None` if it was not.
    row_error: Option<String>,
    /// The address for the editing tools, as typed.
    address_entry: String,
    /// Number of the rung to scroll to once it is drawn; `None` does not scroll.
    pending_rung: Option<u32>,
    /// Line of the list to scroll to, from 1; `None` does not scroll.
    pending_line: Option<u32>,
    /// The reason why the control would refuse a ladder at the moment; `None` if it would accept
    /// one.
    refusal: Option<WriteRefusal>,
    /// Queue for an instruction list that was read from a file.
    opened_lists: Arc<ArrayQueue<String>>,
    /// The bit whose value the user wants explained; `None` without a request.
    bit_to_explain: Option<BitAddress>,
}

impl View for LadderView {
    fn create(start: ViewStart<'_>) -> Self {
        Self::new(start.console.clone(), &start.settings.transfer)
    }

    fn close(&mut self) {
        self.send_request(ControlRequest::HaltLadder(false));
    }

    fn show(&mut self, ui: &mut Ui, frame: ViewFrame<'_>) {
        self.draw(ui, frame.language, frame.machine, frame.owns_keys);
    }
}

impl LadderView {
    /// Takes the bit that the user wants explained, if any.
    pub const fn take_bit_to_explain(&mut self) -> Option<BitAddress> {
        self.bit_to_explain.take()
    }

    /// Creates the view, scrolled to the first rung. `settings`: port and rate for other controls.
    pub fn new(console: Console, settings: &TransferSettings) -> Self {
        Self {
            console,
            tab: Tab::Rungs,
            with_comments: true,
            drawing: None,
            use_counts: Vec::new(),
            selected: None,
            scroll_to_y: None,
            search: LadderSearch::default(),
            clipboard: RungClipboard::default(),
            wizard: ParameterWizard::default(),
            line: ControlLine::new(settings),
            is_editing: false,
            draft: None,
            editor: None,
            row_fields: Vec::new(),
            row_error: None,
            address_entry: String::new(),
            pending_rung: None,
            pending_line: None,
            refusal: None,
            opened_lists: Arc::new(ArrayQueue::new(1)),
            bit_to_explain: None,
        }
    }

    /// Requests to scroll to a rung in the next frame.
    pub const fn show_rung(&mut self, number: u32) {
        self.tab = Tab::Rungs;
        self.pending_rung = Some(number);
    }

    fn send_request(&self, request: ControlRequest) {
        self.console.send(Command::Request(Box::new(request)));
    }

    /// Draws the view and handles its input. `own_keys`: the view is in a separate window and
    /// handles editing keys.
    fn draw(
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
        self.sync_draft(machine);
        if own_keys {
            self.handle_editing_keys(ui);
            self.handle_clipboard_keys(ui);
        }
        self.update_drawing(&self.drawn_ladder(machine));
        let bar = Panel::top("ladder bar").frame(super::bar_frame());
        bar.show(ui, |ui| self.show_toolbar(ui, language, machine));
        if self.is_editing {
            let tools = Panel::top("ladder tools").frame(super::bar_frame());
            tools.show(ui, |ui| self.show_edit_bar(ui, language));
        }
        // In a narrow view the coils use the width of the side list until an element is
        // selected.
        let is_wide = ui.available_width() >= WIDE_VIEW;
        let has_side = is_wide || self.selected.is_some() || !machine.plc.forces().is_empty();
        let line = Panel::bottom("ladder state").frame(super::bar_frame());
        line.show(ui, |ui| {
            self.show_state(ui, language, machine, has_side || self.tab != Tab::Rungs);
        });
        if self.tab == Tab::Rungs && self.is_editing {
            focus::skip_resize_edge(ui, "rung editor");
            let editor = Panel::bottom("rung editor")
                .default_size(132.0)
                .size_range(80.0..=400.0)
                .resizable(true)
                .frame(super::side_frame());
            editor.show(ui, |ui| self.show_rung_editor(ui, language));
        }
        if self.tab == Tab::Rungs {
            let ladder = self.drawn_ladder(machine);
            self.show_search_results(ui, language, &ladder);
        }
        if self.tab == Tab::Rungs && has_side {
            let side = Panel::right("ladder side")
                .exact_size(side::side_width(ui.available_width()))
                .resizable(false)
                .frame(super::side_frame());
            side.show(ui, |ui| self.show_side(ui, language, machine));
        }
        egui::CentralPanel::default()
            .frame(super::plain_frame())
            .show(ui, |ui| match self.tab {
                Tab::Rungs => self.show_rungs(ui, language, machine),
                Tab::List => self.show_list(ui, language, machine),
                Tab::Messages => self.show_messages(ui, language, machine),
                Tab::Comments => self.show_comments(ui, language, machine),
                Tab::Parameters => self.show_parameter_wizard(ui, language, machine),
                Tab::StartValues => self.show_start_values(ui, language, machine),
            });
    }

    /// Computes the positions of the rungs when the ladder or the choice of comments has
    /// changed.
    fn update_drawing(&mut self, ladder: &Arc<Ladder>) {
        let previous = self.drawing.as_ref();
        if previous.is_some_and(|drawing| drawing.is_current(ladder, self.with_comments)) {
            return;
        }
        let is_same_ladder = previous.is_some_and(|drawing| Arc::ptr_eq(&drawing.ladder, ladder));
        if !is_same_ladder {
            let last = ladder.statements().len().saturating_sub(1);
            self.selected = self
                .selected
                .filter(|_| self.is_editing)
                .map(|at| at.min(last));
            self.search.clear();
            let uses = |subject: PlcAddress| (subject, ladder.references(subject).len());
            self.use_counts = ladder.addresses().into_iter().map(uses).collect();
        }
        let drawing = LadderDrawing::new(ladder, self.with_comments);
        // The selected rung remains in view when comments are switched on or off.
        let rung = self.selected.and_then(|at| ladder.statements().get(at));
        let positioned = rung.and_then(|statement| drawing.rung(statement.rung));
        self.scroll_to_y = positioned
            .filter(|_| is_same_ladder)
            .map(|placed| placed.top);
        self.drawing = Some(drawing);
    }

    fn show_toolbar(&mut self, ui: &mut Ui, language: Language, machine: &MachineView) {
        ui.horizontal_wrapped(|ui| {
            for tab in Tab::ALL {
                if ui
                    .selectable_label(self.tab == tab, tab.name().text(language))
                    .clicked()
                {
                    self.tab = tab;
                    self.row_fields.clear();
                    self.row_error = None;
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
                self.send_request(ControlRequest::HaltLadder(!halted));
            }
            for (word, step) in [
                (say::ladder_one_scan().text(language), LadderStep::Slot),
                (say::ladder_one_rung().text(language), LadderStep::Rung),
            ] {
                if ui.add_enabled(halted, egui::Button::new(word)).clicked() {
                    self.send_request(ControlRequest::StepLadder(step));
                    if let Some(next) = machine.plc.next_rung() {
                        self.scroll_to_rung(next);
                    }
                }
            }
            ui.separator();
            let edit = egui::Button::selectable(self.is_editing, say::ladder_edit().text(language));
            if ui.add(edit).clicked() {
                self.toggle_editing(machine);
            }
            self.show_print_button(ui, language, machine);
            if self.tab == Tab::Rungs {
                ui.separator();
                ui.checkbox(
                    &mut self.with_comments,
                    say::ladder_show_comments().text(language),
                );
                ui.separator();
                let ladder = self.drawn_ladder(machine);
                self.show_search_field(ui, language, &ladder);
            }
        });
    }

    /// Scrolls to the rung with this number.
    fn scroll_to_rung(&mut self, rung: u32) {
        self.tab = Tab::Rungs;
        let placed = self.drawing.as_ref().and_then(|drawing| drawing.rung(rung));
        self.scroll_to_y = placed.map(|placed| placed.top);
    }

    /// Selects the statement with index `at` and scrolls to its rung.
    fn select_statement(&mut self, ladder: &Ladder, at: usize) {
        self.selected = Some(at);
        if let Some(statement) = ladder.statements().get(at) {
            self.scroll_to_rung(statement.rung);
        }
    }

    fn show_rungs(&mut self, ui: &mut Ui, language: Language, machine: &MachineView) {
        let Some(drawing) = self.drawing.take() else {
            return;
        };
        let width = ui.available_width() - 14.0;
        if let Some(rung) = self.pending_rung.take() {
            self.scroll_to_y = drawing.rung(rung).map(|placed| placed.top);
        }
        let plc = &machine.plc;
        let is_running = Arc::ptr_eq(&drawing.ladder, plc.ladder());
        let forced = |bit: BitAddress| {
            let found = plc.forces().iter().find(|force| force.bit == bit);
            found.map(|force| force.value)
        };
        let complaints = self.compiler_messages(&drawing.ladder, language);
        let sheet = RungContext {
            ladder: &drawing.ladder,
            memory: is_running.then(|| plc.memory()),
            language,
            with_comments: self.with_comments,
            selected: self.selected,
            chosen_rungs: self.chosen_rungs(),
            forced: &forced,
            searched: self.search.searched_address(),
            next_rung: if machine.halted && is_running {
                plc.next_rung()
            } else {
                None
            },
            compiler_messages: &complaints,
            min_width: width,
        };
        let mut area = ScrollArea::both().auto_shrink([false, false]);
        let view_height = ui.available_height();
        if let Some(top) = self.scroll_to_y.take() {
            let offset =
                (top - view_height * 0.25).clamp(0.0, (drawing.height - view_height).max(0.0));
            area = area.vertical_scroll_offset(offset);
        }
        let mut clicked = None;
        area.show_viewport(ui, |ui, seen| {
            let wide = width.max(draw::rung_width(drawing.columns, self.with_comments));
            let size = vec2(wide, drawing.height + 8.0);
            let (rect, _) = ui.allocate_exact_size(size, Sense::HOVER);
            for placed in drawing.rungs_between(seen.top() - 8.0, seen.bottom()) {
                let corner = Pos2::new(rect.left(), rect.top() + 8.0 + placed.top);
                let power = if is_running {
                    plc.power_flow(&placed.network)
                } else {
                    Vec::new()
                };
                clicked = draw::draw_rung(ui, &sheet, placed, corner, &power).or(clicked);
            }
        });
        if let Some(at) = clicked {
            let with_shift = ui.input(|input| input.modifiers.shift);
            self.select_clicked(at, with_shift);
        }
        self.drawing = Some(drawing);
    }

    /// The compiler's messages about rungs: number of the rung, whether it is an error, text.
    fn compiler_messages(&self, ladder: &Ladder, language: Language) -> Vec<(u32, bool, String)> {
        let errors = self.draft.as_ref().filter(|_| self.is_editing);
        let errors = errors.map_or(&[][..], LadderDraft::errors).iter();
        let errors = errors.map(|error| (true, error));
        let warnings = ladder.warnings().iter().map(|warning| (false, warning));
        errors
            .chain(warnings)
            .map(|(error, found)| {
                (
                    found.rung,
                    error,
                    compiler_text::finding_text(found, language),
                )
            })
            .collect()
    }

    fn show_state(&self, ui: &mut Ui, language: Language, machine: &MachineView, has_side: bool) {
        let plc = &machine.plc;
        let ladder = plc.ladder();
        ui.horizontal_wrapped(|ui| {
            let (words, colour) = match (plc.fault(), machine.halted) {
                (Some(fault), _) => {
                    let words = fault.message().text(language);
                    (words, theme::ALARM_TEXT)
                }
                (None, true) => {
                    let rung = plc.next_rung().unwrap_or(0);
                    (say::ladder_halted(rung).text(language), theme::WARNING)
                }
                (None, false) => (say::ladder_running().text(language), theme::LADDER_LIVE),
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
                ui.label(RichText::new(words).color(theme::WARNING));
                let words = say::ladder_power_off_and_on().text(language);
                let hint = say::ladder_power_off_and_on_hint().text(language);
                if ui.button(words).on_hover_text(hint).clicked() {
                    self.console.send(Command::PowerCycle);
                }
            }
        });
    }
}

/// Returns the addresses that a statement uses.
fn statement_addresses(statement: &Statement) -> Vec<PlcAddress> {
    use gsk_core::plc::Operand;
    let named = |operand: &Operand| match operand {
        Operand::Bit(bit) => Some(PlcAddress::Bit(*bit)),
        Operand::Byte(byte) => Some(PlcAddress::Byte(*byte)),
        _ => None,
    };
    statement.operands.iter().filter_map(named).collect()
}
