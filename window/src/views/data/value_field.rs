//! Draws the input field of a value.

use egui::{Response, Role, TextEdit, Ui, WidgetInfo};
use gsk_messages::Language;

use super::data_values::DataValues;
use super::edit::{DataField, Drafts};
use crate::theme;

/// Draws the input field for `data_field`, `width` points wide, and stores the typed text in
/// `drafts`.
pub fn show(
    ui: &mut Ui,
    language: Language,
    machine: &DataValues<'_>,
    drafts: &mut Drafts,
    data_field: DataField,
    width: f32,
) -> Response {
    let mut text = drafts.text(data_field, machine);
    let name = data_field.name().text(language);
    let colour = match (
        drafts.has_draft(data_field),
        data_field.parse(&text, machine),
    ) {
        (false, _) => theme::TEXT,
        (true, Ok(_)) => theme::UNSAVED_TEXT,
        (true, Err(_)) => theme::ERROR_TEXT,
    };
    let field = TextEdit::singleline(&mut text)
        .id(egui::Id::unique(("data", data_field)))
        .font(egui::TextStyle::Monospace)
        .text_color(colour)
        .desired_width(width);
    let field = ui.add(field);
    if field.changed() {
        drafts.set(data_field, text.clone());
    } else if field.lost_focus() {
        drafts.drop_if_unchanged(data_field, machine);
    }
    field.widget_info(|| WidgetInfo {
        current_text_value: Some(text.clone()),
        ..WidgetInfo::labeled(Role::TextInput, true, &name)
    });
    if drafts.has_draft(data_field)
        && let Err(error) = data_field.parse(&text, machine)
    {
        return field.on_hover_text(error.text(language));
    }
    field
}
