//! Paints the round parts of the additional panel: mushroom button, release button, handwheel.

use tiny_skia::PathBuilder;

use super::{Painter, circle, faint, lighter, radial};
use crate::faceplate::text::opaque;
use crate::faceplate::{PanelColour, PanelPart};

/// Number of graduations in one turn of the handwheel.
pub(super) const GRADUATIONS: i32 = 100;

impl Painter {
    /// Paints the emergency stop: a red mushroom on a yellow plate, lower and smaller while
    /// latched.
    pub(super) fn mushroom(&mut self, part: &PanelPart, latched: bool) {
        let (x, y) = part.rect.center();
        let radius = part.rect.w / 2.0;
        let layers = [
            (radius + 2.0, [40, 46, 54]),
            (radius, [240, 200, 40]),
            (radius * 0.80, [96, 20, 18]),
        ];
        for (radius, colour) in layers {
            if let Some(path) = circle(x, y, radius) {
                self.fill_flat(&path, opaque(colour));
            }
        }
        let cap = radius * if latched { 0.72 } else { 0.78 };
        let rise = if latched { 0.0 } else { 3.0 };
        let base = part.colour.rgb();
        if let Some(path) = circle(x, y - rise, cap) {
            let light = (x - cap * 0.35, y - rise - cap * 0.4);
            let edge = if latched { -0.35 } else { -0.22 };
            self.fill(
                &path,
                radial(light, cap * 1.5, lighter(base, 0.34), lighter(base, edge)),
            );
            self.line(&path, faint(0, 0.35), 1.0);
        }
        for turn in 0..3 {
            self.turn_arrow(
                (x, y - rise),
                cap * 0.62,
                turn as f32 * core::f32::consts::TAU / 3.0,
            );
        }
    }

    /// Paints one of the arrows that show in which direction the mushroom button unlatches.
    /// `start` is its first angle, rad.
    fn turn_arrow(&mut self, (x, y): (f32, f32), radius: f32, start: f32) {
        let at = |angle: f32, radius: f32| (x + radius * angle.cos(), y + radius * angle.sin());
        let mut arc = PathBuilder::new();
        let first = at(start, radius);
        arc.move_to(first.0, first.1);
        for step in 1..=8 {
            let next = at(start + step as f32 * 0.14, radius);
            arc.line_to(next.0, next.1);
        }
        let tip = start + 1.45;
        let ink = faint(255, 0.85);
        if let Some(path) = arc.finish() {
            self.line(&path, ink, 2.5);
        }
        let mut head = PathBuilder::new();
        let corners = [
            at(tip, radius),
            at(start + 1.05, radius + 5.0),
            at(start + 1.05, radius - 5.0),
        ];
        head.move_to(corners[0].0, corners[0].1);
        head.line_to(corners[1].0, corners[1].1);
        head.line_to(corners[2].0, corners[2].1);
        head.close();
        if let Some(path) = head.finish() {
            self.fill_flat(&path, ink);
        }
    }

    pub(super) fn round_button(&mut self, part: &PanelPart, down: bool) {
        let (x, y) = part.rect.center();
        let radius = part.rect.w / 2.0;
        for (radius, colour) in [(radius, [150, 160, 170]), (radius * 0.84, [24, 28, 34])] {
            if let Some(path) = circle(x, y, radius) {
                self.fill_flat(&path, opaque(colour));
            }
        }
        let cap = radius * if down { 0.70 } else { 0.76 };
        let base = [58, 110, 166];
        if let Some(path) = circle(x, y, cap) {
            let light = (x - cap * 0.3, y - cap * 0.4);
            let centre = if down { 0.05 } else { 0.32 };
            self.fill(
                &path,
                radial(
                    light,
                    cap * 1.5,
                    lighter(base, centre),
                    lighter(base, -0.25),
                ),
            );
        }
    }

    pub(super) fn handwheel(&mut self, part: &PanelPart, wheel: i32) {
        let (x, y) = part.rect.center();
        let radius = part.rect.w / 2.0;
        if let Some(path) = circle(x, y, radius) {
            self.fill_flat(&path, opaque([196, 204, 211]));
            self.line(&path, faint(0, 0.4), 1.5);
        }
        let turned = wheel.rem_euclid(GRADUATIONS) as f32 / GRADUATIONS as f32;
        let turned = (turned - 0.25) * core::f32::consts::TAU;
        let at = |angle: f32, radius: f32| (x + radius * angle.cos(), y + radius * angle.sin());
        for mark in 0..GRADUATIONS {
            let angle = turned + mark as f32 / GRADUATIONS as f32 * core::f32::consts::TAU;
            let length = match mark % 10 {
                0 => 12.0,
                5 => 9.0,
                _ => 6.0,
            };
            let (from, to) = (at(angle, radius - 2.0), at(angle, radius - 2.0 - length));
            let mut path = PathBuilder::new();
            path.move_to(from.0, from.1);
            path.line_to(to.0, to.1);
            if let Some(path) = path.finish() {
                let width = if mark % 10 == 0 { 1.6 } else { 0.9 };
                self.line(&path, opaque([40, 46, 54]), width);
            }
        }
        let base = part.colour.rgb();
        let rim = radius - 17.0;
        if let Some(path) = circle(x, y, rim) {
            let light = (x - rim * 0.4, y - rim * 0.5);
            self.fill(
                &path,
                radial(light, rim * 1.7, lighter(base, 0.30), lighter(base, -0.30)),
            );
            self.line(&path, faint(0, 0.5), 1.5);
        }
        if let Some(path) = circle(x, y, rim * 0.80) {
            self.line(&path, faint(255, 0.10), 2.0);
        }
        let hub = rim * 0.32;
        if let Some(path) = circle(x, y, hub) {
            self.fill(
                &path,
                radial((x, y - hub * 0.5), hub * 1.6, [128, 140, 152], [62, 70, 80]),
            );
        }
        let (kx, ky) = at(turned, rim * 0.66);
        if let Some(path) = circle(kx, ky + 1.5, 13.0) {
            self.fill_flat(&path, faint(0, 0.4));
        }
        if let Some(path) = circle(kx, ky, 12.0) {
            self.fill(
                &path,
                radial((kx - 4.0, ky - 5.0), 20.0, [176, 186, 196], [70, 80, 92]),
            );
            self.line(&path, faint(0, 0.4), 1.0);
        }
        let mut pointer = PathBuilder::new();
        pointer.move_to(x - 6.0, part.rect.y - 7.0);
        pointer.line_to(x + 6.0, part.rect.y - 7.0);
        pointer.line_to(x, part.rect.y + 2.0);
        pointer.close();
        if let Some(path) = pointer.finish() {
            self.fill_flat(&path, opaque(PanelColour::Hold.rgb()));
        }
    }
}
