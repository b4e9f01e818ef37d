//! Draws the input field of a value.

use egui::{Color32, Response, Role, TextEdit, Ui, WidgetInfo};
use gsk_messages::Language;

use super::edit::{Drafts, Spot};
use super::values::Values;
use super::{TYPED, WRONG};

/// Draws a field of `width` points and stores what is typed into it in `drafts`.
pub fn show(
    ui: &mut Ui,
    language: Language,
    machine: &Values<'_>,
    drafts: &mut Drafts,
    spot: Spot,
    width: f32,
) -> Response {
    let mut text = drafts.text(spot, machine);
    let name = spot.name().text(language);
    let colour = match (drafts.has(spot), spot.read(&text, machine)) {
        (false, _) => Color32::from_gray(225),
        (true, Ok(_)) => TYPED,
        (true, Err(_)) => WRONG,
    };
    let field = TextEdit::singleline(&mut text)
        .id(egui::Id::unique(("data", spot)))
        .font(egui::TextStyle::Monospace)
        .text_color(colour)
        .desired_width(width);
    let field = ui.add(field);
    if field.changed() {
        drafts.set(spot, text.clone());
    } else if field.lost_focus() {
        drafts.left(spot, machine);
    }
    field.widget_info(|| WidgetInfo {
        current_text_value: Some(text.clone()),
        ..WidgetInfo::labeled(Role::TextInput, true, &name)
    });
    if drafts.has(spot)
        && let Err(said) = spot.read(&text, machine)
    {
        return field.on_hover_text(said.text(language));
    }
    field
}
