//! A tool to scale: insert, holder, the imaginary tip and the circle of the nose.

use egui::{Pos2, Rect, Role, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, pos2, vec2};
use gsk_core::units::Point;
use gsk_messages::{Language, say};
use gsk_workpiece::grid::{GridPoint, from_grid};
use gsk_workpiece::tool::{Tool, ToolShape};

use crate::window::views::machine::camera::Camera;
use crate::window::views::machine::{grid, place, solids};

/// Height of the drawing, points.
const HEIGHT: f32 = 170.0;
/// How much of a holder is shown beside the insert, share of its size.
const AROUND: f32 = 0.35;

/// Draws it.
pub fn show(ui: &mut Ui, tool: &Tool, language: Language) {
    let size = vec2(ui.available_width(), HEIGHT);
    let (room, response) = ui.allocate_exact_size(size, Sense::HOVER);
    response.widget_info(|| {
        let name = say::tool_picture().text(language);
        WidgetInfo::labeled(Role::Image, true, name)
    });
    if tool.check().is_err() {
        return;
    }
    let painter = ui.painter_at(room);
    painter.rect_filled(room, 2.0, grid::GROUND);
    let shape = ToolShape::from_tool(tool);
    let bounds = around(&shape.cutting);
    let camera = Camera::fit(bounds.expand(bounds.size().max_elem() * AROUND), true, room);
    grid::lines(&painter, &camera);
    solids::draw_tool(&painter, &camera, tool);
    let center = camera.screen(place(tool.center()));
    let nose = tool.nose() as f32 * camera.scale;
    let stroke = Stroke::new(1.5, super::WRONG);
    if nose > 1.0 {
        painter.add(Shape::circle_stroke(center, nose, stroke));
    }
    let tip = camera.screen(place(Point::default()));
    for arm in [Vec2::new(6.0, 0.0), Vec2::new(0.0, 6.0)] {
        painter.line_segment([tip - arm, tip + arm], stroke);
    }
}

/// The box around a contour, as the camera has it.
fn around(contour: &[GridPoint]) -> Rect {
    let points = contour.iter().map(|point| {
        let at = from_grid(*point);
        pos2(at.z as f32, at.x as f32)
    });
    let none = Rect::from_min_size(Pos2::ZERO, Vec2::ZERO);
    points.fold(none, |around, at| {
        around.union(Rect::from_min_size(at, Vec2::ZERO))
    })
}
