//! Draws a tool to scale: insert, holder, the imaginary tip and the circle of the tool nose.

use egui::{Pos2, Rect, Role, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, pos2, vec2};
use gsk_core::units::Point;
use gsk_messages::{Language, say};
use gsk_workpiece::grid::{GridPoint, from_grid};
use gsk_workpiece::tool::{Tool, ToolShape};

use crate::theme;
use crate::views::machine::camera::Camera;
use crate::views::machine::{grid, section_drawing, to_pos2};

/// Height of the tool drawing, points.
const HEIGHT: f32 = 170.0;
/// Margin around the insert that shows the holder, as a share of the insert's size.
const MARGIN_SHARE: f32 = 0.35;

/// Draws the picture of a tool as the machine view shows it; for an invalid tool the area stays
/// empty. `rear`: the tool post is on the far side of the spindle.
pub fn show(ui: &mut Ui, tool: &Tool, rear: bool, language: Language) {
    let size = vec2(ui.available_width(), HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::HOVER);
    response.widget_info(|| {
        let name = say::tool_picture().text(language);
        WidgetInfo::labeled(Role::Image, true, name)
    });
    if tool.check().is_err() {
        return;
    }
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 2.0, theme::PICTURE_LABEL_GROUND);
    let shape = ToolShape::from_tool(tool);
    let bounds_mm = bounding_box(&section_drawing::insert_contour(&shape));
    let camera = Camera::fit(
        bounds_mm.expand(bounds_mm.size().max_elem() * MARGIN_SHARE),
        rear,
        rect,
    );
    grid::draw_lines(&painter, &camera);
    section_drawing::draw_tool(&painter, &camera, tool);
    let center = camera.screen_position(to_pos2(tool.center()));
    let nose = tool.nose() as f32 * camera.points_per_mm;
    let stroke = Stroke::new(1.5, theme::JOB_ERROR);
    if nose > 1.0 {
        painter.add(Shape::circle_stroke(center, nose, stroke));
    }
    let tip = camera.screen_position(to_pos2(Point::default()));
    for arm in [Vec2::new(6.0, 0.0), Vec2::new(0.0, 6.0)] {
        painter.line_segment([tip - arm, tip + arm], stroke);
    }
}

/// The bounding box of a contour in part coordinates (x is Z, y is X as a radius), mm.
fn bounding_box(contour: &[GridPoint]) -> Rect {
    let points = contour.iter().map(|point| {
        let at = from_grid(*point);
        pos2(at.z as f32, at.x as f32)
    });
    let none = Rect::from_min_size(Pos2::ZERO, Vec2::ZERO);
    points.fold(none, |around, at| {
        around.union(Rect::from_min_size(at, Vec2::ZERO))
    })
}
