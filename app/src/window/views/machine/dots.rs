//! Draws a path with a great number of segments as dots of an image. The cost is the size of
//! the image and a few instructions a segment, however many segments cover the same dot.

use std::sync::Arc;

use egui::{Color32, ColorImage, Painter, Pos2, Rect, TextureHandle, TextureOptions, pos2};

use super::camera::Camera;
use super::lines::{FEED, MadeFor, RAPID, THREAD};
use super::path::{Path, Way};

/// Bits of the index in the hash table of segments.
const SLOT_BITS: u32 = 18;

/// The image of a path, and the view it was made for.
#[derive(Default)]
pub struct Dots {
    texture: Option<TextureHandle>,
    made_for: MadeFor,
    thinned: Thinned,
}

/// The segments of a path that differ on the screen at a scale. Moving the picture does not
/// change them.
#[derive(Default)]
struct Thinned {
    made_for: Option<(Camera, f32, Arc<Path>)>,
    pieces: Vec<([Pos2; 2], Way)>,
}

impl Dots {
    /// Draws the path; the image is made again when view or path have changed.
    pub fn draw(&mut self, painter: &Painter, camera: &Camera, path: &Arc<Path>) {
        if self.made_for.changes(camera, path) {
            let pixels_per_point = painter.pixels_per_point();
            self.thinned.follow(camera, path, pixels_per_point);
            let image = image(camera, &self.thinned.pieces, pixels_per_point);
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

impl Thinned {
    /// Thins out a path, unless only the centre of the camera has changed.
    fn follow(&mut self, camera: &Camera, path: &Arc<Path>, pixels_per_point: f32) {
        // The segments must be the same for every position of the camera.
        let camera = camera.centred(Pos2::ZERO).within(Rect::ZERO);
        let known = self.made_for.as_ref();
        if known.is_some_and(|(made, pixels, of)| {
            *made == camera && *pixels == pixels_per_point && Arc::ptr_eq(of, path)
        }) {
            return;
        }
        self.pieces.clear();
        let pixel = |point: Pos2| {
            let at = camera.screen(point) * pixels_per_point;
            let [x, y] = [at.x, at.y].map(|it| u64::from(it.floor() as i32 as u32));
            x << 32 | y
        };
        let mut met = vec![(0, 0, Way::Jump); 1 << SLOT_BITS];
        for (from, piece) in path.pieces() {
            let key = (pixel(from), pixel(piece.end), piece.way);
            let mixed = key.0.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ key.1;
            let slot =
                (mixed.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (u64::BITS - SLOT_BITS)) as usize;
            if met.get(slot) != Some(&key) {
                self.pieces.push(([from, piece.end], piece.way));
                if let Some(slot) = met.get_mut(slot) {
                    *slot = key;
                }
            }
        }
        self.made_for = Some((camera, pixels_per_point, Arc::clone(path)));
    }
}

/// Makes the image: transparent where there is no segment, cuts over rapids.
fn image(camera: &Camera, pieces: &[([Pos2; 2], Way)], pixels_per_point: f32) -> ColorImage {
    let size = camera.room.size() * pixels_per_point;
    let size = [
        size.x.ceil().max(1.0) as usize,
        size.y.ceil().max(1.0) as usize,
    ];
    let mut image = ColorImage::filled(size, Color32::TRANSPARENT);
    let corner = camera.room.min;
    let edge = pos2(size[0] as f32 - 1.0, size[1] as f32 - 1.0);
    let at = |point: Pos2| ((camera.screen(point) - corner) * pixels_per_point).to_pos2();
    for (ends, way) in pieces {
        let color = match way {
            Way::Jump => continue,
            Way::Rapid => RAPID,
            Way::Feed => FEED,
            Way::Thread => THREAD,
        };
        let Some([from, to]) = within(ends.map(at), edge) else {
            continue;
        };
        let steps = (to - from).abs().max_elem().ceil().max(1.0);
        let step = (to - from) / steps;
        for count in 0..=steps as u32 {
            let dot = from + step * count as f32;
            let index = dot.y as usize * size[0] + dot.x as usize;
            if let Some(pixel) = image.pixels.get_mut(index)
                && (*way != Way::Rapid || *pixel == Color32::TRANSPARENT)
            {
                *pixel = color;
            }
        }
    }
    image
}

/// Clips a line at the edges of the image; `None` if the line is outside.
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
    use super::super::path::tests::path;
    use super::*;

    #[test]
    fn what_is_cut_again_is_drawn_once_and_moving_the_picture_costs_nothing() {
        let again = "G01 Z-30 F100\nG00 X42\nZ2\nX40\n".repeat(100);
        let path = Arc::new(path(&format!("G00 X40 Z2\n{again}M30\n")));
        let room = Rect::from_min_size(Pos2::ZERO, egui::vec2(400.0, 300.0));
        let bounds = Rect::from_min_max(pos2(-35.0, 0.0), pos2(5.0, 25.0));
        let camera = Camera::fit(bounds, true, room);
        let mut thinned = Thinned::default();
        thinned.follow(&camera, &path, 1.0);
        assert!(path.count() > 400);
        assert!(thinned.pieces.len() < 8, "{}", thinned.pieces.len());
        let all = path.pieces();
        let all: Vec<_> = all.map(|(at, to)| ([at, to.end], to.way)).collect();
        let whole = image(&camera, &all, 1.0);
        assert_eq!(image(&camera, &thinned.pieces, 1.0).pixels, whole.pixels);
        assert!(whole.pixels.contains(&FEED));

        thinned.pieces.clear();
        thinned.follow(&camera.centred(pos2(3.0, 1.0)), &path, 1.0);
        assert!(thinned.pieces.is_empty(), "moved only");
        thinned.follow(&camera, &path, 2.0);
        assert!(!thinned.pieces.is_empty());
    }

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
