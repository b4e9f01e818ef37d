//! Completes egui's data for screen readers: the rows of the LCD as text, and the state of a
//! lamp as words after its name.
//!
//! Both are in the value of their widgets, too. Narrator reads it; the screen readers of Linux
//! read a value only if it is a number.

use egui::emath::TSTransform;
use egui::text_selection::accesskit_text::update_accesskit_for_text_widget;
use egui::{FontId, Rect, Response, Ui};
use gsk_panel::screen::{ROWS, Screen};

use crate::theme;

/// Adds the 15 rows of the LCD as texts for screen readers.
pub fn add_lcd_rows(ui: &Ui, lcd: &Response, bounds: Rect, screen: &Screen) {
    if !ui.ctx().has_accesskit_node(lcd.id) {
        return;
    }
    // The text is never drawn. It only carries the rows, scaled to the height of the LCD.
    let font = FontId::monospace(bounds.height() / ROWS as f32);
    let text = ui
        .painter()
        .layout_no_wrap(screen.text(), font, theme::TEXT);
    let scaling = bounds.height() / text.rect.height().max(1.0);
    let transform = TSTransform::new(bounds.min.to_vec2(), scaling);
    update_accesskit_for_text_widget(ui.ctx(), lcd.id, None, transform, &text);
}

/// Adds the state of a part in words for screen readers: `on`, `off`, `kept for the next key`.
pub fn add_state(ui: &Ui, part: &Response, description: &str) {
    ui.ctx()
        .accesskit_node_builder(part.id, |node| node.set_description(description));
}
