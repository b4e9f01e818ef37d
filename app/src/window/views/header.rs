//! The line above a view: its name, and signs that dock it, give it a window of its own,
//! or close it.

use egui::{
    Align, Color32, CornerRadius, Layout, Rect, RichText, Role, Sense, Stroke, StrokeKind, Ui,
    UiBuilder, WidgetInfo, vec2,
};

use crate::window::view::{ViewRow, key_name};
use gsk_messages::{Language, say};

/// Height of the line, points.
pub const HEIGHT: f32 = 22.0;
/// Side of a sign, points.
const SIGN: f32 = 10.0;
const GROUND: Color32 = Color32::from_gray(40);

/// Where the view is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// In a pane.
    Docked,
    /// In a pane of the only window there is.
    Only,
    /// In a window of its own, which has a name and closes by itself.
    Floating,
}

/// What was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// Into the window.
    Dock,
    /// Into a window of its own.
    Float,
    /// Close it.
    Close,
}

/// Draws the line.
pub fn show(ui: &mut Ui, row: &ViewRow, language: Language, place: Place) -> Option<Asked> {
    let size = vec2(ui.available_width(), HEIGHT);
    let (line, _) = ui.allocate_exact_size(size, Sense::HOVER);
    ui.painter().rect_filled(line, 0.0, GROUND);
    let inside = UiBuilder::new()
        .max_rect(line.shrink2(vec2(8.0, 0.0)))
        .layout(Layout::right_to_left(Align::Center));
    let signs: &[(Asked, gsk_messages::Message)] = &match place {
        Place::Docked => vec![
            (Asked::Close, say::window_view_close((row.name)())),
            (Asked::Float, say::window_view_float((row.name)())),
        ],
        Place::Only => vec![(Asked::Close, say::window_view_close((row.name)()))],
        Place::Floating => vec![(Asked::Dock, say::window_view_dock((row.name)()))],
    };
    let asked = ui.scope_builder(inside, |ui| {
        let mut asked = None;
        for (what, name) in signs {
            if sign(ui, *what, &name.text(language)) {
                asked = Some(*what);
            }
        }
        if place != Place::Floating {
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                let name = (row.name)().text(language);
                ui.label(RichText::new(name).color(Color32::from_gray(200)));
                if let Some(key) = row.key {
                    ui.label(RichText::new(key_name(key)).weak().small());
                }
            });
        }
        asked
    });
    asked.inner
}

/// A sign that can be clicked; its name stands in the tip.
fn sign(ui: &mut Ui, what: Asked, name: &str) -> bool {
    let size = vec2(SIGN + 10.0, HEIGHT);
    let (place, response) = ui.allocate_exact_size(size, Sense::CLICK);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    let ink = if response.hovered() {
        Color32::WHITE
    } else {
        Color32::from_gray(170)
    };
    let stroke = Stroke::new(1.4, ink);
    let square = Rect::from_center_size(place.center(), vec2(SIGN, SIGN));
    let painter = ui.painter();
    match what {
        Asked::Close => {
            painter.line_segment([square.left_top(), square.right_bottom()], stroke);
            painter.line_segment([square.left_bottom(), square.right_top()], stroke);
        }
        Asked::Float | Asked::Dock => {
            let outer = CornerRadius::same(1);
            painter.rect_stroke(square, outer, stroke, StrokeKind::Inside);
            let half = match what {
                Asked::Float => Rect::from_min_max(square.center_top(), square.right_center()),
                _ => Rect::from_min_max(square.center_top(), square.right_bottom()),
            };
            painter.rect_filled(half, 0.0, ink);
        }
    }
    response.on_hover_text(name).clicked()
}
