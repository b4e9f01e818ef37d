//! Draws the coarse half section of a part, mirrored at the spindle axis.

use egui::{Painter, Pos2, Rect, Shape, Stroke, pos2};
use gsk_host::network::class::part_outline::CoarseOutline;

use crate::theme;

/// Draws the part as large as the room permits; nothing without a part.
pub fn draw(painter: &Painter, room: Rect, part: &CoarseOutline) {
    let points = || part.lines.iter().flatten();
    let least = points().map(|[z, _]| *z).fold(f32::INFINITY, f32::min);
    let greatest = points().map(|[z, _]| *z).fold(f32::NEG_INFINITY, f32::max);
    let radius = points().map(|[_, x]| *x).fold(0.0, f32::max);
    if greatest <= least || radius <= 0.0 {
        return;
    }
    let scale = (room.width() / (greatest - least)).min(room.height() / (2.0 * radius));
    let axis = room.center().y;
    let left = room.center().x - (greatest - least) * scale / 2.0;
    let edge = Stroke::new(1.0, theme::PART_EDGE);
    for line in &part.lines {
        for side in [-1.0, 1.0] {
            let place =
                |[z, x]: &[f32; 2]| pos2(left + (z - least) * scale, axis + side * x * scale);
            let outline: Vec<Pos2> = line.iter().map(place).collect();
            painter.add(Shape::closed_line(outline, edge));
        }
    }
    let ends = [room.left_center(), room.right_center()];
    painter.line_segment(ends, Stroke::new(1.0, theme::SPINDLE_AXIS));
}
