//! A path of very many pieces as dots of a picture: what it costs is the picture's size
//! and a few instructions a piece, however many lie on the same dot.

use std::sync::Arc;

use egui::{Color32, ColorImage, Painter, Pos2, Rect, TextureHandle, TextureOptions, pos2};

use super::camera::Camera;
use super::lines::{FEED, MadeFor, RAPID, THREAD};
use super::path::{Path, Way};

/// The dots that were made for a view.
#[derive(Default)]
pub struct Dots {
    texture: Option<TextureHandle>,
    made_for: MadeFor,
}

impl Dots {
    /// Draws the path.
    pub fn draw(&mut self, painter: &Painter, camera: &Camera, path: &Arc<Path>) {
        if self.made_for.changes(camera, path) {
            let image = image(camera, path, painter.pixels_per_point());
            match &mut self.texture {
                Some(texture) => texture.set(image, TextureOptions::NEAREST),
                None => {
                    let context = painter.ctx();
                    let options = TextureOptions::NEAREST;
                    self.texture = Some(context.load_texture("path", image, options));
                }
            }
        }
        if let Some(texture) = &self.texture {
            let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
            painter.image(texture.id(), camera.room, whole, Color32::WHITE);
        }
    }
}

/// The picture: transparent where no piece lies; cuts over rapids.
fn image(camera: &Camera, path: &Path, pixels_per_point: f32) -> ColorImage {
    let size = camera.room.size() * pixels_per_point;
    let size = [
        size.x.ceil().max(1.0) as usize,
        size.y.ceil().max(1.0) as usize,
    ];
    let mut image = ColorImage::filled(size, Color32::TRANSPARENT);
    let corner = camera.room.min;
    let edge = pos2(size[0] as f32 - 1.0, size[1] as f32 - 1.0);
    let at = |point: Pos2| ((camera.screen(point) - corner) * pixels_per_point).to_pos2();
    for (from, piece) in path.pieces() {
        let color = match piece.way {
            Way::Jump => continue,
            Way::Rapid => RAPID,
            Way::Feed => FEED,
            Way::Thread => THREAD,
        };
        let Some([from, to]) = within([at(from), at(piece.end)], edge) else {
            continue;
        };
        let steps = (to - from).abs().max_elem().ceil().max(1.0);
        let step = (to - from) / steps;
        for count in 0..=steps as u32 {
            let dot = from + step * count as f32;
            let index = dot.y as usize * size[0] + dot.x as usize;
            if let Some(pixel) = image.pixels.get_mut(index)
                && (piece.way != Way::Rapid || *pixel == Color32::TRANSPARENT)
            {
                *pixel = color;
            }
        }
    }
    image
}

/// What of a line lies between the corner and the edge of a picture.
///
/// ```text
///   from + t (to − from):  each side of the picture bounds t from below or above
/// ```
fn within([from, to]: [Pos2; 2], edge: Pos2) -> Option<[Pos2; 2]> {
    let way = to - from;
    if !(way.x.is_finite() && way.y.is_finite()) {
        return None;
    }
    let (mut first, mut last) = (0.0_f32, 1.0_f32);
    for (begin, way, edge) in [(from.x, way.x, edge.x), (from.y, way.y, edge.y)] {
        if way == 0.0 {
            if !(0.0..=edge).contains(&begin) {
                return None;
            }
            continue;
        }
        let (low, high) = (-begin / way, (edge - begin) / way);
        first = first.max(low.min(high));
        last = last.min(low.max(high));
    }
    (first <= last).then(|| {
        let clamped = |part: f32| {
            let point = from + way * part;
            pos2(point.x.clamp(0.0, edge.x), point.y.clamp(0.0, edge.y))
        };
        [clamped(first), clamped(last)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_cut_off_at_the_picture() {
        let edge = pos2(9.0, 9.0);
        let inside = |from, to| within([from, to], edge);
        assert_eq!(
            inside(pos2(-5.0, 3.0), pos2(20.0, 3.0)),
            Some([pos2(0.0, 3.0), pos2(9.0, 3.0)])
        );
        assert_eq!(
            inside(pos2(2.0, 2.0), pos2(4.0, 5.0)),
            Some([pos2(2.0, 2.0), pos2(4.0, 5.0)])
        );
        assert_eq!(inside(pos2(-5.0, -1.0), pos2(20.0, -1.0)), None);
        assert_eq!(inside(pos2(-4.0, 4.0), pos2(4.0, -5.0)), None);
        assert_eq!(inside(pos2(f32::NAN, 0.0), pos2(1.0, 1.0)), None);
    }
}
