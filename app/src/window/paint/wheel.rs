//! The handwheel.

use egui::{Stroke, vec2};
use gsk_panel::faceplate::{Colour, Part};

use super::{Faceplate, faint, lighter, opaque};

/// Graduations of one turn.
pub const GRADUATIONS: i32 = 100;

impl Faceplate<'_> {
    pub(super) fn handwheel(&self, part: &Part, wheel: i32) {
        let rect = self.view.rect(part.rect);
        let (middle, radius) = (rect.center(), rect.width() / 2.0);
        let unit = self.view.scale;
        self.painter
            .circle_filled(middle, radius, opaque([196, 204, 211]));
        self.painter
            .circle_stroke(middle, radius, Stroke::new(1.5 * unit, faint(0, 0.4)));
        let turned = wheel.rem_euclid(GRADUATIONS) as f32 / GRADUATIONS as f32;
        let turned = (turned - 0.25) * std::f32::consts::TAU;
        let at = |angle: f32, radius: f32| middle + radius * vec2(angle.cos(), angle.sin());
        for mark in 0..GRADUATIONS {
            let angle = turned + mark as f32 / GRADUATIONS as f32 * std::f32::consts::TAU;
            let (length, width) = match mark % 10 {
                0 => (12.0, 1.6),
                5 => (9.0, 0.9),
                _ => (6.0, 0.9),
            };
            let ends = [
                at(angle, radius - 2.0 * unit),
                at(angle, radius - (2.0 + length) * unit),
            ];
            self.painter
                .line_segment(ends, Stroke::new(width * unit, opaque([40, 46, 54])));
        }
        let base = part.colour.rgb();
        let rim = radius - 17.0 * unit;
        self.painter
            .circle_filled(middle, rim, opaque(lighter(base, -0.25)));
        for step in 1..=24u8 {
            let share = f32::from(step) / 24.0;
            let centre = middle - vec2(0.18, 0.24) * rim * share * 0.5;
            let colour = lighter(base, 0.26 * share);
            self.painter
                .circle_filled(centre, rim * (1.0 - 0.45 * share), opaque(colour));
        }
        self.painter
            .circle_stroke(middle, rim, Stroke::new(1.5 * unit, faint(0, 0.5)));
        let hub = rim * 0.32;
        self.painter
            .circle_filled(middle, hub, opaque([84, 94, 106]));
        self.painter.circle_filled(
            middle - vec2(0.0, hub * 0.2),
            hub * 0.7,
            opaque([112, 124, 136]),
        );
        let knob = at(turned, rim * 0.66);
        self.painter
            .circle_filled(knob + vec2(0.0, 1.5 * unit), 13.0 * unit, faint(0, 0.4));
        self.painter
            .circle_filled(knob, 12.0 * unit, opaque([104, 116, 128]));
        let light = knob - vec2(3.0, 3.5) * unit;
        self.painter
            .circle_filled(light, 6.0 * unit, opaque([158, 170, 180]));
        let top = rect.center_top();
        let pointer = vec![
            top + vec2(-6.0, -7.0) * unit,
            top + vec2(6.0, -7.0) * unit,
            top + vec2(0.0, 2.0) * unit,
        ];
        let colour = opaque(Colour::Hold.rgb());
        self.painter
            .add(egui::Shape::convex_polygon(pointer, colour, Stroke::NONE));
    }
}
