//! A group of widgets at the right end of a row. It is drawn from left to right, so that the
//! focus of the keyboard and a screen reader come through it as it is read.

use egui::{Id, Ui};

/// How wide a group was in the last picture, points.
pub fn width(ui: &Ui, name: &str, guess: f32) -> f32 {
    ui.data(|data| data.get_temp(Id::unique(name)))
        .unwrap_or(guess)
}

/// Draws the group; `guess`: its width as long as none is known, points.
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
