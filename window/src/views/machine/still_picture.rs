//! A picture of a finished part with the path that cut it, fitted into a rectangle.

use std::sync::Arc;

use egui::{Painter, Rect, pos2};
use gsk_workpiece::grid::from_grid;
use gsk_workpiece::region::Region;
use gsk_workpiece::trapezoid::{SectionFill, Trapezoid, trapezoids};

use super::camera::Camera;
use super::path::DrawnPath;
use super::path_lines::PathLines;
use super::section_drawing::{draw_outline, draw_silhouette, fill_trapezoids, hatch_trapezoids};
use crate::theme;

/// Length of the part beyond the cuts that is shown, mm.
const SHOWN_BEYOND_MM: f32 = 12.0;

/// A part and a path.
pub struct StillPicture {
    path: Arc<DrawnPath>,
    section: Region,
    material: Vec<Trapezoid>,
    outside: Vec<Trapezoid>,
    lines: PathLines,
}

impl StillPicture {
    /// A picture of the half section of a part.
    pub fn new(path: DrawnPath, section: Region) -> Self {
        Self {
            path: Arc::new(path),
            material: trapezoids(&section, SectionFill::Material),
            outside: trapezoids(&section, SectionFill::Outside),
            lines: PathLines::default(),
            section,
        }
    }

    /// Draws the picture into `rect`. `rear`: the tool post is on the far side of the spindle.
    pub fn draw(&mut self, painter: &Painter, rect: Rect, rear: bool) {
        let painter = painter.with_clip_rect(rect);
        painter.rect_filled(rect, 0.0, theme::DRAWING_GROUND);
        let camera = Camera::fit(self.bounds(), rear, rect);
        fill_trapezoids(&painter, &camera, &self.outside, true, theme::PART_OUTSIDE);
        draw_silhouette(&painter, &camera, &self.outside);
        fill_trapezoids(&painter, &camera, &self.material, false, theme::SECTION);
        hatch_trapezoids(&painter, &camera, &self.material);
        let contours = self.section.contours();
        draw_outline(&painter, &camera, contours, false, theme::PART_EDGE);
        self.lines.draw(&painter, &camera, &self.path);
    }

    /// The box around the cuts and the part beside them, part coordinates.
    fn bounds(&self) -> Rect {
        let mut bounds = self.path.bounds.unwrap_or(Rect::ZERO);
        bounds.extend_with_x(bounds.left() - SHOWN_BEYOND_MM);
        if let Some(part) = self.section.bounds() {
            let [low, high] = [part.low, part.high].map(from_grid);
            let (high_z, high_x) = (high.z as f32, high.x as f32);
            let low_z = (low.z as f32).max(bounds.left());
            bounds.extend_with(pos2(high_z.max(low_z), high_x));
            bounds.extend_with(pos2(low_z, -high_x));
        }
        bounds
    }
}
