//! The round buttons: emergency stop and overtravel release.

use egui::{Stroke, pos2, vec2};
use gsk_panel::faceplate::Part;

use super::{Faceplate, faint, lighter, opaque};

impl Faceplate<'_> {
    /// The emergency stop: a red mushroom on a yellow plate.
    pub(super) fn mushroom(&self, part: &Part, latched: bool) {
        let rect = self.view.rect(part.rect);
        let (middle, radius) = (rect.center(), rect.width() / 2.0);
        let layers = [
            (1.02, [40, 46, 54]),
            (1.0, [240, 200, 40]),
            (0.80, [96, 20, 18]),
        ];
        for (share, colour) in layers {
            self.painter
                .circle_filled(middle, radius * share, opaque(colour));
        }
        let cap = radius * if latched { 0.72 } else { 0.78 };
        let rise = if latched { 0.0 } else { self.view.length(3.0) };
        let top = middle - vec2(0.0, rise);
        let base = part.colour.rgb();
        let edge = if latched { -0.35 } else { -0.18 };
        self.painter
            .circle_filled(top, cap, opaque(lighter(base, edge)));
        // Rings that grow lighter towards the light above.
        for step in 1..=8u8 {
            let share = f32::from(step) / 8.0;
            let centre = top - vec2(0.10, 0.16) * cap * share;
            let colour = lighter(base, edge + (0.22 - edge) * share);
            self.painter
                .circle_filled(centre, cap * (1.0 - 0.7 * share), opaque(colour));
        }
        for turn in 0..3u8 {
            let start = f32::from(turn) * std::f32::consts::TAU / 3.0;
            self.turn_arrow(top, cap * 0.66, start);
        }
    }

    /// One of the arrows that show which way the mushroom is turned free.
    fn turn_arrow(&self, middle: egui::Pos2, radius: f32, start: f32) {
        let at = |angle: f32, radius: f32| middle + radius * vec2(angle.cos(), angle.sin());
        let ink = faint(255, 0.85);
        let arc = (0..=8u8)
            .map(|step| at(start + f32::from(step) * 0.13, radius))
            .collect();
        self.painter
            .line(arc, Stroke::new(self.view.length(2.5), ink));
        let reach = self.view.length(5.0);
        let head = vec![
            at(start + 1.45, radius),
            at(start + 1.05, radius + reach),
            at(start + 1.05, radius - reach),
        ];
        self.painter
            .add(egui::Shape::convex_polygon(head, ink, Stroke::NONE));
    }

    pub(super) fn round_button(&self, part: &Part, down: bool) {
        let rect = self.view.rect(part.rect);
        let (middle, radius) = (rect.center(), rect.width() / 2.0);
        self.painter
            .circle_filled(middle, radius, opaque([150, 160, 170]));
        self.painter
            .circle_filled(middle, radius * 0.84, opaque([24, 28, 34]));
        let cap = radius * if down { 0.70 } else { 0.76 };
        let base = if down { [44, 86, 130] } else { [62, 116, 174] };
        self.painter.circle_filled(middle, cap, opaque(base));
        let light = pos2(middle.x - cap * 0.2, middle.y - cap * 0.25);
        self.painter
            .circle_filled(light, cap * 0.6, faint(255, if down { 0.05 } else { 0.12 }));
    }
}
