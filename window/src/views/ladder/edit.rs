//! Edits the ladder: a rung as instructions or element by element, or the whole list, with
//! undo. A saved ladder runs after the next power-on.

use std::sync::Arc;

use egui::{Button, Panel, RichText, ScrollArea, TextEdit, Ui, vec2};
use gsk_core::cnc::ControlRequest;
use gsk_core::plc::address::BitAddress;
use gsk_core::plc::{CompileError, Ladder, Network};
use gsk_host::kernel::monitor::MachineView;
use gsk_host::platform;

use super::draft::LadderDraft;
use super::element_change::{ElementChange, change_rung, format_rung};
use super::{LadderView, Tab, compiler_text};
use crate::focus;
use crate::theme;
use gsk_messages::{Language, say};

/// Number for [`LadderDraft::set_text`] of changes typed into the whole list, where rungs
/// count from 1.
const WHOLE_LIST: u32 = 0;
/// Instructions that a new rung gets.
const NEW_RUNG: &str = "LD X0.0\nOUT R0.0";

/// The state of the text field with a rung's instructions.
#[derive(Clone, Debug)]
pub struct RungEditor {
    rung_number: u32,
    /// Line of the list, from 1, at which the rung begins.
    first_line: u32,
    text: String,
    /// The ladder with which the editor was opened.
    base_ladder: Arc<Ladder>,
    /// The list after the last change in this field. If the draft has another list, the editor
    /// starts again.
    draft_text: String,
}

impl LadderView {
    /// The ladder that is drawn: the draft while editing, else the running one.
    pub(super) fn drawn_ladder(&self, machine: &MachineView) -> Arc<Ladder> {
        let draft = self.draft.as_ref().filter(|_| self.is_editing);
        let ladder = draft.map_or(machine.plc.ladder(), LadderDraft::ladder);
        Arc::clone(ladder)
    }

    pub(super) fn toggle_editing(&mut self, machine: &MachineView) {
        self.is_editing = !self.is_editing;
        if self.is_editing && self.draft.is_none() {
            let newest = machine.next_ladder.as_ref();
            self.draft = Some(LadderDraft::new(newest.unwrap_or(machine.plc.ladder())));
        }
    }

    /// Handles the keys of editing: F9 saves, Ctrl+Z undoes, Ctrl+Y redoes, Delete removes the
    /// selected element.
    pub(super) fn handle_editing_keys(&mut self, ui: &Ui) {
        if !self.is_editing {
            return;
        }
        let typing = ui.ctx().egui_wants_keyboard_input();
        let pressed = |ctrl: bool, key| {
            ui.input(|input| input.key_pressed(key) && input.modifiers.ctrl == ctrl)
        };
        if pressed(false, egui::Key::F9) {
            self.save_draft();
        } else if !typing && pressed(true, egui::Key::Z) {
            self.undo_or_redo(false);
        } else if !typing && pressed(true, egui::Key::Y) {
            self.undo_or_redo(true);
        } else if !typing && pressed(false, egui::Key::Delete) {
            self.change_element(ElementChange::Delete);
        }
    }

    fn undo_or_redo(&mut self, redo: bool) {
        if let Some(draft) = &mut self.draft {
            if redo {
                draft.redo();
            } else {
                draft.undo();
            }
        }
    }

    fn save_draft(&mut self) {
        let Some(draft) = self
            .draft
            .as_ref()
            .filter(|draft| draft.errors().is_empty())
        else {
            return;
        };
        if self.refusal.is_none() {
            let ladder = Arc::clone(draft.ladder());
            self.send_request(ControlRequest::LoadLadder(ladder));
        }
    }

    /// Marks the draft as saved once the control has stored it, and replaces its text by a
    /// list that was opened from a file.
    pub(super) fn sync_draft(&mut self, machine: &MachineView) {
        self.refusal = machine.ladder_refused;
        let Some(draft) = &mut self.draft else { return };
        if let Some(list) = self.opened_lists.pop() {
            draft.set_text(list, None);
            if !draft.errors().is_empty() {
                // The errors are shown beside the lines of the list.
                self.tab = Tab::List;
            }
        }
        let newest = machine.next_ladder.as_ref();
        let control_ladder = newest.unwrap_or(machine.plc.ladder());
        if draft.is_changed() && control_ladder.source() == draft.text() {
            draft.mark_saved();
        }
    }

    /// Draws the bar with the editing tools.
    pub(super) fn show_edit_bar(&mut self, ui: &mut Ui, language: Language) {
        let Some(draft) = &self.draft else { return };
        let (can_undo, can_redo) = draft.can_undo_redo();
        let compiles = draft.errors().is_empty();
        let is_changed = draft.is_changed();
        ui.horizontal_wrapped(|ui| {
            for (word, hint, on, redo) in [
                (say::ladder_undo().text(language), "Ctrl+Z", can_undo, false),
                (say::ladder_redo().text(language), "Ctrl+Y", can_redo, true),
            ] {
                if ui
                    .add_enabled(on, Button::new(word))
                    .on_hover_text(hint)
                    .clicked()
                {
                    self.undo_or_redo(redo);
                }
            }
            if self.tab == Tab::Rungs {
                ui.separator();
                self.show_element_tools(ui, language, compiles);
                ui.separator();
                self.show_rung_tools(ui, language, compiles);
                self.show_clipboard_tools(ui, language);
            }
            ui.separator();
            let hint = say::ladder_save_hint().text(language);
            let save = Button::new(say::window_save().text(language));
            let can_save = self.refusal.is_none();
            if ui
                .add_enabled(compiles && is_changed && can_save, save)
                .on_hover_text(hint)
                .clicked()
            {
                self.save_draft();
            }
            if let Some(refusal) = self.refusal.filter(|_| is_changed) {
                let words = compiler_text::refusal_message(refusal).text(language);
                ui.label(RichText::new(words).color(theme::WARNING));
            }
            let discard = Button::new(say::ladder_discard().text(language));
            if ui.add_enabled(is_changed, discard).clicked() {
                self.draft = None;
                self.is_editing = false;
            }
            ui.menu_button(say::ladder_file_menu().text(language), |ui| {
                self.show_file_menu(ui, language);
            });
            if platform::has_ports() {
                self.show_line_button(ui, language);
            }
        });
    }

    /// Draws the tools that change the selected contact or coil.
    fn show_element_tools(&mut self, ui: &mut Ui, language: Language, compiles: bool) {
        let on = compiles && self.selected.is_some();
        if ui
            .add_enabled(on, Button::new(say::ladder_open_or_closed().text(language)))
            .on_hover_text(say::ladder_open_or_closed_hint().text(language))
            .clicked()
        {
            self.change_element(ElementChange::ToggleKind);
        }
        let field = TextEdit::singleline(&mut self.address_entry)
            .desired_width(70.0)
            .hint_text("R30.5");
        let response = ui.add(field);
        let name = say::ladder_element_address().text(language);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, &name));
        let bit: Option<BitAddress> = self.address_entry.trim().to_ascii_uppercase().parse().ok();
        type MakeChange = fn(BitAddress) -> ElementChange;
        let tools: [(String, String, MakeChange); 3] = [
            (
                say::ladder_change_address().text(language),
                say::ladder_change_address_hint().text(language),
                ElementChange::SetAddress,
            ),
            (
                say::ladder_series().text(language),
                say::ladder_series_hint().text(language),
                ElementChange::AddSeries,
            ),
            (
                say::ladder_parallel().text(language),
                say::ladder_parallel_hint().text(language),
                ElementChange::AddParallel,
            ),
        ];
        for (word, hint, make) in tools {
            let button = Button::new(word);
            let clicked = ui
                .add_enabled(on && bit.is_some(), button)
                .on_hover_text(hint)
                .clicked();
            if let Some(bit) = bit.filter(|_| clicked) {
                self.change_element(make(bit));
            }
        }
        let delete = Button::new(say::ladder_delete_element().text(language));
        if ui.add_enabled(on, delete).on_hover_text("Delete").clicked() {
            self.change_element(ElementChange::Delete);
        }
    }

    fn show_rung_tools(&mut self, ui: &mut Ui, language: Language, compiles: bool) {
        let on = compiles && self.selected.is_some();
        let insert = Button::new(say::ladder_insert_rung().text(language));
        if ui.add_enabled(on, insert).clicked() {
            self.replace_rung(|network| {
                let mut rung = format_rung(network);
                rung.push(NEW_RUNG.to_owned());
                Some(rung)
            });
            // Select the new rung.
            let rung = self.selected_network().map(|network| network.number + 1);
            let next = rung.and_then(|rung| self.draft.as_ref()?.ladder().network(rung));
            if let Some(next) = next {
                self.selected = Some(next.first);
                self.pending_rung = Some(next.number);
            }
        }
        let delete = Button::new(say::ladder_delete_rung().text(language));
        if ui.add_enabled(on, delete).clicked() {
            self.replace_rung(|_| Some(Vec::new()));
        }
    }

    /// The rung of the selected statement in the draft; `None` without a selection or draft.
    fn selected_network(&self) -> Option<Network> {
        let ladder = self.draft.as_ref()?.ladder();
        let statement = ladder.statements().get(self.selected?)?;
        ladder.network(statement.rung)
    }

    fn change_element(&mut self, change: ElementChange) {
        let Some(at) = self.selected else { return };
        self.replace_rung(|network| change_rung(network, at.checked_sub(network.first)?, change));
    }

    /// Replaces the instructions of the selected rung with those that `lines` returns; `None`
    /// leaves the rung unchanged. Does nothing while the draft has errors.
    fn replace_rung(&mut self, lines: impl Fn(&Network) -> Option<Vec<String>>) {
        let Some(network) = self.selected_network() else {
            return;
        };
        let Some(draft) = self
            .draft
            .as_mut()
            .filter(|draft| draft.errors().is_empty())
        else {
            return;
        };
        if let Some(lines) = lines(&network) {
            let text = draft
                .ladder()
                .source_with_rung(network.number, &lines.join("\n"));
            draft.set_text(text, None);
        }
    }

    /// Draws the text field with the selected rung's instructions, and the messages of the
    /// compiler.
    pub(super) fn show_rung_editor(&mut self, ui: &mut Ui, language: Language) {
        let Some(draft) = &self.draft else { return };
        let network = self.selected_network();
        let current = self.editor.as_ref();
        let is_stale = current.is_none_or(|editor| {
            editor.draft_text != draft.text()
                || (draft.errors().is_empty()
                    && network
                        .as_ref()
                        .is_none_or(|network| network.number != editor.rung_number))
        });
        if is_stale {
            let line = |network: &Network| {
                let first = draft.ladder().statements().get(network.first);
                first.map_or(0, |statement| statement.line)
            };
            self.editor = network.as_ref().map(|network| RungEditor {
                rung_number: network.number,
                first_line: line(network),
                text: format_rung(network).join("\n"),
                base_ladder: Arc::clone(draft.ladder()),
                draft_text: draft.text().to_owned(),
            });
        }
        let Some(mut editor) = self.editor.take() else {
            let words = say::ladder_click_rung_to_edit().text(language);
            ui.label(RichText::new(words).weak());
            return;
        };
        let panel = Panel::right("rung errors")
            .exact_size((ui.available_width() * 0.5).max(200.0))
            .resizable(false)
            .show_separator_line(false)
            .frame(egui::Frame::new().inner_margin(egui::Margin::symmetric(10, 0)));
        let mut clicked_line = None;
        panel.show(ui, |ui| {
            let errors = self.draft.as_ref().map_or(&[][..], LadderDraft::findings);
            clicked_line =
                show_compiler_messages(ui, language, errors, editor.first_line, editor.rung_number);
        });
        ScrollArea::vertical()
            .auto_shrink([false, false])
            .show(ui, |ui| {
                let field = TextEdit::multiline(&mut editor.text)
                    .font(egui::TextStyle::Monospace)
                    .desired_rows(5)
                    .desired_width(f32::INFINITY);
                let response = ui.add(field);
                response.widget_info(|| {
                    let name = say::ladder_rung_instructions().text(language);
                    egui::WidgetInfo::labeled(egui::Role::MultilineTextInput, true, name)
                });
                if response.changed()
                    && let Some(draft) = &mut self.draft
                {
                    let text = editor
                        .base_ladder
                        .source_with_rung(editor.rung_number, &editor.text);
                    draft.set_text(text, Some(editor.rung_number));
                    draft.text().clone_into(&mut editor.draft_text);
                }
                focus::scroll_to_focus(ui);
            });
        self.editor = Some(editor);
        if let Some(line) = clicked_line {
            self.select_line(line);
        }
    }

    /// Draws the instruction list of the whole ladder, with line numbers.
    pub(super) fn show_list(&mut self, ui: &mut Ui, language: Language, machine: &MachineView) {
        let mut clicked_line = None;
        let editing = self.is_editing;
        if let Some(draft) = self.draft.as_ref().filter(|_| editing)
            && !draft.errors().is_empty()
        {
            let panel = Panel::bottom("list errors")
                .default_size(110.0)
                .frame(crate::views::side_frame());
            panel.show(ui, |ui| {
                clicked_line = show_compiler_messages(ui, language, draft.errors(), 1, WHOLE_LIST);
            });
        }
        if clicked_line.is_some() {
            self.pending_line = clicked_line;
        }
        let mut text = match self.draft.as_ref().filter(|_| editing) {
            Some(draft) => draft.text().to_owned(),
            None => machine.plc.ladder().source().to_owned(),
        };
        let mut area = ScrollArea::both().auto_shrink([false, false]);
        let height = ui.text_style_height(&egui::TextStyle::Monospace);
        if let Some(line) = self.pending_line.take() {
            let offset = (f64::from(line) * f64::from(height)) as f32 - ui.available_height() * 0.4;
            area = area.vertical_scroll_offset(offset.max(0.0));
        }
        area.show(ui, |ui| {
            ui.horizontal_top(|ui| {
                ui.spacing_mut().item_spacing = vec2(4.0, 0.0);
                let numbers: Vec<String> = (1..=text.lines().count().max(1))
                    .map(|line| format!("{line:4}"))
                    .collect();
                let numbers = RichText::new(numbers.join("\n")).monospace().weak();
                // The text field has a margin.
                ui.vertical(|ui| {
                    ui.add_space(2.0);
                    ui.label(numbers);
                });
                let field = TextEdit::multiline(&mut text)
                    .font(egui::TextStyle::Monospace)
                    .desired_width(f32::INFINITY)
                    .interactive(editing);
                let response = ui.add(field);
                response.widget_info(|| {
                    let name = say::ladder_instruction_list().text(language);
                    egui::WidgetInfo::labeled(egui::Role::MultilineTextInput, editing, name)
                });
                if response.changed()
                    && let Some(draft) = self.draft.as_mut().filter(|_| editing)
                {
                    draft.set_text(text, Some(WHOLE_LIST));
                }
            });
            focus::scroll_to_focus(ui);
        });
    }

    /// Selects the first statement of a line of the list, from 1.
    fn select_line(&mut self, line: u32) {
        let Some(draft) = &self.draft else { return };
        let ladder = draft.ladder();
        let at = ladder
            .statements()
            .partition_point(|statement| statement.line < line);
        if let Some(statement) = ladder.statements().get(at) {
            self.selected = Some(at);
            self.pending_rung = Some(statement.rung);
        }
    }
}

/// Draws the messages of the compiler. Lines of the edited rung `rung` count from its first line.
/// Returns the line in the list of a message that was clicked; `None` without one.
fn show_compiler_messages(
    ui: &mut Ui,
    language: Language,
    errors: &[CompileError],
    first_line: u32,
    rung: u32,
) -> Option<u32> {
    let mut clicked_line = None;
    ScrollArea::vertical()
        .id_salt("complaints")
        .auto_shrink([false, false])
        .show(ui, |ui| {
            let compiles = errors.iter().all(|found| found.code.is_warning());
            if compiles {
                let words = compiler_text::compiled_text(errors.len(), language);
                ui.label(RichText::new(words).color(theme::LADDER_LIVE));
            }
            let ink = if compiles {
                theme::WARNING
            } else {
                theme::LADDER_ERROR_TEXT
            };
            for error in errors {
                let is_own_rung = rung == WHOLE_LIST || error.rung == rung;
                let finding = compiler_text::finding_text(error, language);
                let text = if is_own_rung {
                    let line = error.line.saturating_sub(first_line) + 1;
                    say::ladder_at_line(line, finding)
                } else {
                    say::ladder_at_rung(error.rung, finding)
                };
                let text = text.text(language);
                let label = egui::Label::new(RichText::new(text).color(ink))
                    .wrap()
                    .sense(egui::Sense::click());
                if ui.add(label).clicked() {
                    clicked_line = Some(error.line);
                }
            }
            focus::scroll_to_focus(ui);
        });
    clicked_line
}
