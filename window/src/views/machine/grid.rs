//! Draws the grid and the spindle axis with their figures: Z in mm, X as a diameter in mm.

use egui::{Align2, FontId, Painter, Pos2, Shape, Stroke, pos2, vec2};

use super::camera::Camera;
use crate::theme;
use gsk_messages::{Language, say};

/// Minimum distance between two grid lines, points.
const MIN_LINE_DISTANCE: f32 = 56.0;
/// Width of the scale of X at the left edge of the picture, points.
const X_SCALE_WIDTH: f32 = 48.0;
/// Height of the name of X above its scale, points.
const X_NAME_HEIGHT: f32 = 18.0;

/// Draws the grid lines below the picture.
pub fn draw_lines(painter: &Painter, camera: &Camera) {
    let (room, seen) = (camera.rect, camera.visible_bounds());
    let stroke = Stroke::new(1.0, theme::GRID_LINE);
    let step = round_step(MIN_LINE_DISTANCE / camera.points_per_mm);
    for z in multiples(seen.left(), seen.right(), step) {
        let x = camera.screen_position(pos2(z, 0.0)).x;
        painter.vline(x, room.y_range(), stroke);
    }
    for x in multiples(seen.top(), seen.bottom(), step / 2.0) {
        let y = camera.screen_position(pos2(0.0, x)).y;
        painter.hline(room.x_range(), y, stroke);
    }
}

/// Draws the axis of the spindle, the coordinates of the grid lines and the names of both axes,
/// over the picture.
pub fn draw_figures(painter: &Painter, camera: &Camera, language: Language) {
    let (room, seen) = (camera.rect, camera.visible_bounds());
    let axis = camera.screen_position(Pos2::ZERO).y;
    let ends = [pos2(room.left(), axis), pos2(room.right(), axis)];
    for (dash, gap, at) in [(18.0, 10.0, 0.0), (3.0, 25.0, 21.5)] {
        let ends = [ends[0] + vec2(at, 0.0), ends[1]];
        let stroke = Stroke::new(1.0, theme::SPINDLE_AXIS);
        painter.extend(Shape::dashed_line(&ends, stroke, dash, gap));
    }
    let step = round_step(MIN_LINE_DISTANCE / camera.points_per_mm);
    let font = FontId::monospace(theme::SCALE_SIZE);
    let label = |at: Pos2, align: Align2, text: String, font: &FontId| {
        let galley = painter.layout_no_wrap(text, font.clone(), theme::GRID_TEXT);
        let rect = align.anchor_size(at, galley.size());
        painter.rect_filled(
            rect.expand2(vec2(2.0, 0.0)),
            2.0,
            theme::PICTURE_LABEL_GROUND,
        );
        painter.galley(rect.min, galley, theme::GRID_TEXT);
        rect
    };
    let name_font = FontId::proportional(theme::SCALE_SIZE);
    let name = say::lathe_axis_x().text(language);
    label(
        room.left_top() + vec2(4.0, 2.0),
        Align2::LEFT_TOP,
        name,
        &name_font,
    );
    let name = say::lathe_axis_z().text(language);
    let corner = room.right_bottom() + vec2(-6.0, -2.0);
    let z_name = label(corner, Align2::RIGHT_BOTTOM, name, &name_font);
    for z in multiples(seen.left(), seen.right(), step) {
        let x = camera.screen_position(pos2(z, 0.0)).x;
        if x > room.left() + X_SCALE_WIDTH && x < z_name.left() - 24.0 {
            let at = pos2(x, room.bottom() - 2.0);
            label(at, Align2::CENTER_BOTTOM, format_figure(z, step), &font);
        }
    }
    // X figures are diameters: they have the step of Z, and are negative beyond the axis, where
    // a tool has a negative X.
    for x in multiples(seen.top(), seen.bottom(), step / 2.0) {
        let y = camera.screen_position(pos2(0.0, x)).y;
        if y < room.bottom() - 22.0 && y > room.top() + X_NAME_HEIGHT + 6.0 {
            let at = pos2(room.left() + 4.0, y);
            let figure = format_figure(x * 2.0, step);
            label(at, Align2::LEFT_CENTER, figure, &font);
        }
    }
}

/// The smallest step of 1, 2 or 5 times a power of ten that is at least `min_step`.
fn round_step(min_step: f32) -> f32 {
    let decade = 10_f32.powf(min_step.max(1e-6).log10().floor());
    let multiple = |times: f32| decade * times;
    [1.0, 2.0, 5.0]
        .map(multiple)
        .into_iter()
        .find(|step| *step >= min_step)
        .unwrap_or(multiple(10.0))
}

/// The multiples of a step between `from` and `to`, at most 201.
fn multiples(from: f32, to: f32, step: f32) -> impl Iterator<Item = f32> {
    const MAX_INDEX: f32 = 200.0;
    let first = (from / step).ceil();
    let count = ((to / step).floor() - first).clamp(-1.0, MAX_INDEX) as i32;
    (0..=count).map(move |index| (first + index as f32) * step)
}

fn format_figure(value: f32, step: f32) -> String {
    let decimals = (-step.log10()).ceil().clamp(0.0, 3.0) as usize;
    // No minus sign before a zero.
    let value = if value.abs() < step / 10.0 {
        0.0
    } else {
        value
    };
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round_and_figures_as_fine_as_they() {
        assert_eq!([0.7, 1.0, 3.0, 7.0].map(round_step), [1.0, 1.0, 5.0, 10.0]);
        assert_eq!(multiples(-21.0, 11.0, 10.0).count(), 4);
        assert_eq!(format_figure(-0.0, 10.0), "0");
        assert_eq!(format_figure(-2.5, 0.5), "-2.5");
    }
}
