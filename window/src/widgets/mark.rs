//! The mark of a step or a criterion: a circle, with a tick if it is done.

use egui::{Color32, Sense, Stroke, Ui, vec2};

/// Diameter of a status mark, points.
const MARK_DIAMETER: f32 = 12.0;

/// Draws a status mark; if `done`, with a tick in it.
pub fn draw(ui: &mut Ui, colour: Color32, done: bool) {
    let (rect, _) =
        ui.allocate_exact_size(vec2(MARK_DIAMETER + 2.0, MARK_DIAMETER + 4.0), Sense::HOVER);
    let (centre, radius) = (rect.center(), MARK_DIAMETER / 2.0);
    let painter = ui.painter();
    painter.circle_stroke(centre, radius, Stroke::new(1.5, colour));
    if done {
        let stroke = Stroke::new(2.0, colour);
        let corner = centre + vec2(-0.1, 0.5) * radius;
        painter.line_segment([centre + vec2(-0.55, 0.0) * radius, corner], stroke);
        painter.line_segment([corner, centre + vec2(0.6, -0.5) * radius], stroke);
    }
}
