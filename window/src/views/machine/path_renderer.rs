//! Draws the path on the picture: as lines, or as dots where it has a great number of
//! segments.

use std::sync::Arc;

use egui::Painter;

use super::camera::Camera;
use super::path::DrawnPath;
use super::path_dots::PathDots;
use super::path_lines::PathLines;

/// Number of segments above which a path is drawn as dots instead of lines.
const MAX_LINES: usize = 50_000;

/// Draws a path as lines or, if it is long, as dots.
#[derive(Default)]
pub struct PathRenderer {
    lines: PathLines,
    dots: PathDots,
}

impl PathRenderer {
    pub fn draw(&mut self, painter: &Painter, camera: &Camera, path: &Arc<DrawnPath>) {
        if path.segment_count() > MAX_LINES {
            self.dots.draw(painter, camera, path);
        } else {
            self.lines.draw(painter, camera, path);
        }
    }
}
