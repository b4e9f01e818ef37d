//! Right-aligns a group of widgets in a row. The group is drawn from left to right: keyboard
//! focus and screen readers follow the reading order.

use egui::{Id, Ui};

/// Width of the group in the last frame, points; `guess` before the first one.
pub fn width(ui: &Ui, name: &str, guess: f32) -> f32 {
    ui.data(|data| data.get_temp(Id::unique(name)))
        .unwrap_or(guess)
}

/// Draws the group `add` at the right end of the row. `guess`: its width before the first
/// frame, points.
pub fn show(ui: &mut Ui, name: &str, guess: f32, add: impl FnOnce(&mut Ui)) {
    let known = width(ui, name, guess);
    let free = ui.available_width() - known - ui.spacing().item_spacing.x;
    ui.add_space(free.max(0.0));
    let drawn = ui.horizontal(add).response.rect.width();
    if (drawn - known).abs() > 0.5 {
        ui.data_mut(|data| data.insert_temp(Id::unique(name), drawn));
        ui.ctx().request_discard("width");
    }
}
