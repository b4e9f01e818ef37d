//! Animates the turning spindle and the coolant.

use std::f32::consts::TAU;

use egui::{Painter, Pos2, Stroke, pos2, vec2};
use gsk_host::kernel::part::PartView;
use gsk_workpiece::stock::Stock;

use super::camera::Camera;
use crate::theme;

/// Angles of the jaws on the chuck, at whose middle a mark is drawn, radians.
const JAW_ANGLES: [f32; 3] = [0.0, TAU / 3.0, 2.0 * TAU / 3.0];
/// Maximum speed at which the spindle is drawn, r/min, at which the eye still sees the
/// direction.
const MAX_DRAWN_RPM: f32 = 90.0;
/// Time between two frames while the spindle turns, s.
const FRAME_INTERVAL_S: f32 = 1.0 / 30.0;
/// Position of the coolant nozzle relative to the tool tip, Z and X, mm.
const NOZZLE_OFFSET_MM: (f32, f32) = (14.0, 34.0);
/// Half width of the coolant jets at the tool tip, mm.
const JET_SPREAD_MM: f32 = 2.5;
const JETS: i8 = 2;

/// Angle at which the spindle is drawn, radians.
#[derive(Default)]
pub struct SpindleAnimation(f32);

impl SpindleAnimation {
    /// Draws the marks of the jaws on the outside of the chuck, on the half that is not cut
    /// open:
    ///
    /// ```text
    ///   axis  -.-.-.-.-    a quarter turn is seen: from the edge ...
    ///         |-------|
    ///         |       |
    ///         +-------+    ... at angle 0 to the axis
    /// ```
    pub fn draw(&mut self, painter: &Painter, camera: &Camera, part: &PartView) {
        let rpm = part.spindle_rpm as f32;
        if rpm != 0.0 {
            let elapsed_s = painter.ctx().input(|input| input.stable_dt).min(0.1);
            self.0 =
                (self.0 + rpm.clamp(-MAX_DRAWN_RPM, MAX_DRAWN_RPM) / 60.0 * TAU * elapsed_s) % TAU;
            let pause = std::time::Duration::from_secs_f32(FRAME_INTERVAL_S);
            painter.ctx().request_repaint_after(pause);
        }
        for (from, to, radius) in marked_cylinders(&part.job.stock) {
            for jaw in JAW_ANGLES {
                let angle = (self.0 + jaw).rem_euclid(TAU);
                if angle > TAU / 4.0 {
                    continue;
                }
                let height = -radius * angle.cos();
                let ends = [from, to].map(|z| camera.screen_position(pos2(z, height)));
                painter.line_segment(ends, Stroke::new(2.0, theme::SPINDLE_MARK));
            }
        }
    }
}

/// The cylinders of chuck and jaws, each with first Z, last Z and radius, mm.
fn marked_cylinders(stock: &Stock) -> impl Iterator<Item = (f32, f32, f32)> {
    let (body, jaws) = stock.chuck_section();
    let bounds = [body.bounds(), jaws.bounds()];
    bounds.into_iter().flatten().map(|bounds| {
        let [low, high] = [bounds.low, bounds.high].map(gsk_workpiece::grid::from_grid);
        (low.z as f32, high.z as f32, high.x as f32)
    })
}

/// Draws the jets of coolant onto the tool tip at `tip`.
pub fn draw_coolant(painter: &Painter, camera: &Camera, tip: Pos2) {
    let nozzle = camera.screen_position(tip + vec2(NOZZLE_OFFSET_MM.0, NOZZLE_OFFSET_MM.1));
    for jet in -JETS..=JETS {
        let offset_mm = f32::from(jet) / f32::from(JETS) * JET_SPREAD_MM;
        let end = camera.screen_position(tip + vec2(offset_mm, -offset_mm.abs() / 2.0));
        painter.line_segment([nozzle, end], Stroke::new(2.0, theme::COOLANT));
    }
    painter.circle_filled(nozzle, 3.0, theme::SPINDLE_MARK);
}
