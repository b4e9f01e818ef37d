//! The fields of a form with units and tips.

use std::collections::BTreeMap;

use egui::text::{CCursor, CCursorRange};
use egui::{Align, Align2, ComboBox, Layout, RichText, TextEdit, Ui, vec2};
use gsk_forms::{FieldInput, FormError, FormField, FormValue, FormValues, thread_rows};
use gsk_messages::{Language, say};

use super::keypad;
use super::outline_table::OutlineTable;
use crate::theme;

/// Width of a field, points.
const FIELD_WIDTH: f32 = 92.0;
/// Width of a name, points.
const NAME_WIDTH: f32 = 150.0;
/// The first of the fields for tool, spindle and feed.
const FIRST_MACHINE_FIELD: &str = "TOOL";
/// Width of the button that opens the list of threads, points.
const LIST_BUTTON_WIDTH: f32 = 28.0;
/// Height of the list of threads, points.
const LIST_HEIGHT: f32 = 320.0;
/// The word for a thread with its own diameter and pitch.
const FREE_THREAD: &str = "FREE";

/// What is typed in the fields, with the errors of those that cannot be read.
#[derive(Default)]
pub struct FieldDrafts {
    texts: BTreeMap<&'static str, String>,
    errors: BTreeMap<&'static str, FormError>,
    outline: OutlineTable,
    /// Whether the first field in which a value is typed gets the keyboard.
    pub focuses_first: bool,
}

impl FieldDrafts {
    /// The drafts of a form that was opened or chosen.
    pub fn new(values: &FormValues) -> Self {
        let mut drafts = Self::default();
        if let Ok(field) = values.field("POINTS")
            && let FormValue::Outline(outline) = values.get(field)
        {
            drafts.outline = OutlineTable::new(&outline);
        }
        drafts
    }

    /// The first error of a field that cannot be read; `None` if all can.
    pub fn first_error(&self) -> Option<&FormError> {
        self.errors.values().next()
    }

    /// Draws all fields that matter; returns whether a value was changed.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        values: &mut FormValues,
        broken: Option<&FormError>,
        language: Language,
    ) -> bool {
        let mut is_changed = false;
        let fields: Vec<&'static FormField> = values.shown_fields().collect();
        for field in fields {
            if field.id == FIRST_MACHINE_FIELD {
                ui.separator();
            }
            let broken = broken.filter(|it| it.field == field.id);
            is_changed |= self.show_field(ui, field, values, broken, language);
            let error = self.errors.get(field.id).or(broken);
            if let Some(error) = error {
                let text = RichText::new(error.rule.text(language)).color(theme::ERROR_TEXT);
                ui.label(text);
            }
        }
        let shown: Vec<&'static str> = values.shown_fields().map(|field| field.id).collect();
        self.errors.retain(|id, _| shown.contains(id));
        is_changed
    }

    fn show_field(
        &mut self,
        ui: &mut Ui,
        field: &'static FormField,
        values: &mut FormValues,
        broken: Option<&FormError>,
        language: Language,
    ) -> bool {
        let tip = (field.tip)().text(language);
        if matches!(field.input, FieldInput::Outline { .. }) {
            ui.label((field.name)().text(language)).on_hover_text(tip);
            let point = broken.and_then(|error| error.rule.find_value("number"));
            let point = point.and_then(|number| number.parse().ok());
            let text = self.outline.show(ui, point, language);
            return text.is_some_and(|text| self.set(field, values, &text));
        }
        ui.horizontal(|ui| {
            let name = (field.name)().text(language);
            let size = vec2(NAME_WIDTH, ui.spacing().interact_size.y);
            let label =
                ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
                    ui.set_min_width(NAME_WIDTH);
                    ui.add(egui::Label::new(&name).truncate())
                });
            let label = label.inner.on_hover_text(&tip);
            match &field.input {
                FieldInput::Number { unit, range, .. } => {
                    let sign = values.unit_sign(*unit);
                    let range = say::form_range(range.0, range.1, sign).text(language);
                    let tip = format!("{tip}\n{} · {range}", field.id);
                    let is_changed = self.show_typed(ui, field, values, label.id, &tip);
                    ui.weak(sign);
                    is_changed
                }
                FieldInput::Choice { options, .. } => {
                    let chosen = values.text(field);
                    let shown = options.iter().find(|it| it.word == chosen);
                    let shown = shown.map(|it| (it.name)().text(language));
                    let mut picked = None;
                    let combo = ComboBox::from_id_salt(field.id)
                        .width(FIELD_WIDTH)
                        .selected_text(shown.unwrap_or_default())
                        .show_ui(ui, |ui| {
                            for option in *options {
                                let text = (option.name)().text(language);
                                if ui.selectable_label(option.word == chosen, text).clicked() {
                                    picked = Some(option.word);
                                }
                            }
                        });
                    combo.response.labelled_by(label.id).on_hover_text(tip);
                    picked.is_some_and(|word| self.set(field, values, word))
                }
                FieldInput::Thread { .. } => {
                    let is_typed = self.show_typed(ui, field, values, label.id, &tip);
                    let picked = show_threads(ui, &values.text(field), language);
                    is_typed || picked.is_some_and(|word| self.set(field, values, &word))
                }
                FieldInput::Outline { .. } => false,
            }
        })
        .inner
    }

    /// Draws a field in which the value is typed.
    fn show_typed(
        &mut self,
        ui: &mut Ui,
        field: &'static FormField,
        values: &mut FormValues,
        label: egui::Id,
        tip: &str,
    ) -> bool {
        let id = egui::Id::unique(("form field", field.id));
        let has_focus = ui.memory(|memory| memory.has_focus(id));
        let is_typed = has_focus || keypad::is_typed(ui, id);
        let draft = self.texts.entry(field.id).or_default();
        if !is_typed && !self.errors.contains_key(field.id) {
            *draft = values.text(field);
        }
        let length = draft.chars().count();
        let edit = TextEdit::singleline(draft)
            .id(id)
            .align(Align2::LEFT_CENTER)
            .desired_width(FIELD_WIDTH);
        let mut output = edit.show(ui);
        let response = output.response.response.clone();
        let response = response.labelled_by(label).on_hover_text(tip);
        let is_first = std::mem::take(&mut self.focuses_first);
        if is_first {
            response.request_focus();
        }
        let is_back_from_key = keypad::register_field(ui, &response);
        if is_first || (response.gained_focus() && !is_back_from_key) {
            // What is typed next replaces the value.
            let all = CCursorRange::two(CCursor::new(0), CCursor::new(length));
            output.state.cursor.set_char_range(Some(all));
            output.state.store(ui.ctx(), id);
        }
        if !response.changed() {
            return false;
        }
        let text = draft.clone();
        if text.trim().is_empty() {
            values.clear(field.id);
            self.errors.remove(field.id);
            return true;
        }
        self.set(field, values, &text)
    }

    /// Sets a value; the fields whose units change with it return to their defaults.
    fn set(&mut self, field: &'static FormField, values: &mut FormValues, text: &str) -> bool {
        match values.set_text(field.id, text) {
            Ok(()) => {
                self.errors.remove(field.id);
                let dependent: &[&str] = match field.id {
                    "FEED" => &["F", "FF"],
                    "SPIN" => &["S"],
                    "SIDE" => &["D", "DB"],
                    _ => &[],
                };
                for id in dependent {
                    values.clear(id);
                    self.errors.remove(id);
                }
                true
            }
            Err(error) => {
                self.errors.insert(field.id, error);
                true
            }
        }
    }
}

/// Draws the list of threads beside the field; returns the designation that was chosen.
fn show_threads(ui: &mut Ui, chosen: &str, language: Language) -> Option<String> {
    let mut picked = None;
    let combo = ComboBox::from_id_salt("thread")
        .width(LIST_BUTTON_WIDTH)
        .height(LIST_HEIGHT)
        .selected_text("")
        .show_ui(ui, |ui| {
            ui.set_min_width(FIELD_WIDTH);
            let own = say::form_thread_free().text(language);
            if ui.selectable_label(chosen == FREE_THREAD, own).clicked() {
                picked = Some(FREE_THREAD.to_owned());
            }
            let mut source = "";
            for row in thread_rows() {
                if row.standard.source() != source {
                    source = row.standard.source();
                    ui.weak(source);
                }
                let is_chosen = row.designation.eq_ignore_ascii_case(chosen);
                if ui.selectable_label(is_chosen, row.designation).clicked() {
                    picked = Some(row.designation.to_owned());
                }
            }
        });
    let name = say::form_thread_list().text(language);
    combo
        .response
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, &name));
    combo.response.on_hover_text(name);
    picked
}
