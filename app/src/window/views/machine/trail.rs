//! Draws the path on the picture: as lines, or as dots where it has a great number of
//! segments.

use std::sync::Arc;

use egui::Painter;

use super::camera::Camera;
use super::dots::Dots;
use super::lines::Lines;
use super::path::Path;

/// A path with more segments is drawn as dots.
const MANY: usize = 50_000;

/// The drawings of a path.
#[derive(Default)]
pub struct Trail {
    lines: Lines,
    dots: Dots,
}

impl Trail {
    pub fn draw(&mut self, painter: &Painter, camera: &Camera, path: &Arc<Path>) {
        if path.count() > MANY {
            self.dots.draw(painter, camera, path);
        } else {
            self.lines.draw(painter, camera, path);
        }
    }
}
