//! Right-aligns a group of widgets in a row. The group is drawn from left to right: keyboard
//! focus and screen readers follow the reading order.

use egui::{Id, Ui};

/// Width of the group `name` in the last frame, points; `initial_width` before the first one.
pub fn last_width(ui: &Ui, name: &str, initial_width: f32) -> f32 {
    ui.data(|data| data.get_temp(Id::unique(name)))
        .unwrap_or(initial_width)
}

/// Draws the group of widgets `add` at the right end of the row. `initial_width`: estimated
/// width for the first frame, points.
pub fn show(ui: &mut Ui, name: &str, initial_width: f32, add: impl FnOnce(&mut Ui)) {
    let last_width = last_width(ui, name, initial_width);
    let free = ui.available_width() - last_width - ui.spacing().item_spacing.x;
    ui.add_space(free.max(0.0));
    let drawn_width = ui.horizontal(add).response.rect.width();
    if (drawn_width - last_width).abs() > 0.5 {
        ui.data_mut(|data| data.insert_temp(Id::unique(name), drawn_width));
        ui.ctx().request_discard("width");
    }
}
