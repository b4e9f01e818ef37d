//! The path on the picture, as lines or, where there are very many, as dots.

use std::sync::Arc;

use egui::Painter;

use super::camera::Camera;
use super::dots::Dots;
use super::lines::Lines;
use super::path::Path;

/// A path of more pieces than that is drawn dot by dot.
const MANY: usize = 50_000;

/// What was drawn of a path.
#[derive(Default)]
pub struct Trail {
    lines: Lines,
    dots: Dots,
}

impl Trail {
    /// Draws a path.
    pub fn draw(&mut self, painter: &Painter, camera: &Camera, path: &Arc<Path>) {
        if path.count() > MANY {
            self.dots.draw(painter, camera, path);
        } else {
            self.lines.draw(painter, camera, path);
        }
    }
}
