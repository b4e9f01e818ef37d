//! Draws the grid and the spindle axis with their figures: Z in mm, X as a diameter in mm.

use egui::{Align2, Color32, FontId, Painter, Pos2, Shape, Stroke, pos2, vec2};

use super::camera::Camera;

const LINE: Color32 = Color32::from_gray(34);
const FIGURES: Color32 = Color32::from_gray(150);
const AXIS: Color32 = Color32::from_rgb(176, 120, 120);
/// Background of words over the picture.
pub const GROUND: Color32 = Color32::from_rgba_premultiplied(12, 12, 12, 170);
/// Least distance of two lines, points.
const APART: f32 = 56.0;

/// Draws the grid lines below the picture.
pub fn lines(painter: &Painter, camera: &Camera) {
    let (room, seen) = (camera.room, camera.seen());
    let stroke = Stroke::new(1.0, LINE);
    let step = step(APART / camera.scale);
    for z in multiples(seen.left(), seen.right(), step) {
        let x = camera.screen(pos2(z, 0.0)).x;
        painter.vline(x, room.y_range(), stroke);
    }
    for x in multiples(seen.top(), seen.bottom(), step / 2.0) {
        let y = camera.screen(pos2(0.0, x)).y;
        painter.hline(room.x_range(), y, stroke);
    }
}

/// Draws the axis of the spindle and the figures over the picture.
pub fn figures(painter: &Painter, camera: &Camera) {
    let (room, seen) = (camera.room, camera.seen());
    let axis = camera.screen(Pos2::ZERO).y;
    let ends = [pos2(room.left(), axis), pos2(room.right(), axis)];
    for (dash, gap, at) in [(18.0, 10.0, 0.0), (3.0, 25.0, 21.5)] {
        let ends = [ends[0] + vec2(at, 0.0), ends[1]];
        let stroke = Stroke::new(1.0, AXIS);
        painter.extend(Shape::dashed_line(&ends, stroke, dash, gap));
    }
    let step = step(APART / camera.scale);
    let font = FontId::monospace(11.0);
    let text = |at: Pos2, align: Align2, value: f32| {
        let text = figure(value, step);
        let galley = painter.layout_no_wrap(text, font.clone(), FIGURES);
        let place = align.anchor_size(at, galley.size());
        painter.rect_filled(place.expand2(vec2(2.0, 0.0)), 2.0, GROUND);
        painter.galley(place.min, galley, FIGURES);
    };
    for z in multiples(seen.left(), seen.right(), step) {
        let x = camera.screen(pos2(z, 0.0)).x;
        if x > room.left() + 44.0 {
            text(pos2(x, room.bottom() - 2.0), Align2::CENTER_BOTTOM, z);
        }
    }
    // X figures are diameters: they have the step of Z, on both sides of the axis.
    for x in multiples(seen.top(), seen.bottom(), step / 2.0) {
        let y = camera.screen(pos2(0.0, x)).y;
        if y < room.bottom() - 22.0 {
            text(
                pos2(room.left() + 4.0, y),
                Align2::LEFT_CENTER,
                (x * 2.0).abs(),
            );
        }
    }
}

/// The smallest step of 1, 2 or 5 times a power of ten that is at least `least`.
fn step(least: f32) -> f32 {
    let decade = 10_f32.powf(least.max(1e-6).log10().floor());
    let of = |times: f32| decade * times;
    [1.0, 2.0, 5.0]
        .map(of)
        .into_iter()
        .find(|step| *step >= least)
        .unwrap_or(of(10.0))
}

/// The multiples of a step within a range, at most 201.
fn multiples(from: f32, to: f32, step: f32) -> impl Iterator<Item = f32> {
    const MOST: f32 = 200.0;
    let first = (from / step).ceil();
    let count = ((to / step).floor() - first).clamp(-1.0, MOST) as i32;
    (0..=count).map(move |index| (first + index as f32) * step)
}

fn figure(value: f32, step: f32) -> String {
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
        assert_eq!([0.7, 1.0, 3.0, 7.0].map(step), [1.0, 1.0, 5.0, 10.0]);
        assert_eq!(multiples(-21.0, 11.0, 10.0).count(), 4);
        assert_eq!(figure(-0.0, 10.0), "0");
        assert_eq!(figure(-2.5, 0.5), "-2.5");
    }
}
