//! Draws a path with a great number of segments as dots of an image. The cost is the size of
//! the image and a few instructions a segment, however many segments cover the same dot.

use std::sync::Arc;

use egui::{ColorImage, Painter, Pos2, Rect, TextureHandle, TextureOptions, pos2};

use super::camera::Camera;
use super::path::{DrawnPath, SegmentKind};
use super::path_lines::DrawingKey;
use crate::theme;

/// Number of bits of the index in the hash table of segments.
const SLOT_BITS: u32 = 18;

/// Draws a path as an image, which it keeps with the view it was made for.
#[derive(Default)]
pub struct PathDots {
    texture: Option<TextureHandle>,
    drawn_for: DrawingKey,
    thinned_path: ThinnedPath,
}

/// Those segments of a path that differ on the screen at a scale. They stay the same when the
/// picture is moved.
#[derive(Default)]
struct ThinnedPath {
    thinned_for: Option<(Camera, f32, Arc<DrawnPath>)>,
    segments: Vec<([Pos2; 2], SegmentKind)>,
}

impl PathDots {
    /// Draws the path; the image is made again when view or path have changed.
    pub fn draw(&mut self, painter: &Painter, camera: &Camera, path: &Arc<DrawnPath>) {
        if self.drawn_for.replace_if_changed(camera, path) {
            let pixels_per_point = painter.pixels_per_point();
            self.thinned_path.update(camera, path, pixels_per_point);
            let image = render_image(camera, &self.thinned_path.segments, pixels_per_point);
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
            let full_uv = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
            painter.image(texture.id(), camera.rect, full_uv, theme::NO_TINT);
        }
    }
}

impl ThinnedPath {
    /// Thins out the path, unless only the centre of the camera has changed.
    fn update(&mut self, camera: &Camera, path: &Arc<DrawnPath>, pixels_per_point: f32) {
        // The segments must be the same for every position of the camera.
        let camera = camera.with_centre(Pos2::ZERO).with_rect(Rect::ZERO);
        let known = self.thinned_for.as_ref();
        if known.is_some_and(|(made, pixels, of)| {
            *made == camera && *pixels == pixels_per_point && Arc::ptr_eq(of, path)
        }) {
            return;
        }
        self.segments.clear();
        let pixel = |point: Pos2| {
            let at = camera.screen_position(point) * pixels_per_point;
            let [x, y] = [at.x, at.y].map(|it| u64::from(it.floor() as i32 as u32));
            x << 32 | y
        };
        let mut seen = vec![(0, 0, SegmentKind::Jump); 1 << SLOT_BITS];
        for (from, piece) in path.segments() {
            let key = (pixel(from), pixel(piece.end), piece.kind);
            let mixed = key.0.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ key.1;
            let slot =
                (mixed.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (u64::BITS - SLOT_BITS)) as usize;
            if seen.get(slot) != Some(&key) {
                self.segments.push(([from, piece.end], piece.kind));
                if let Some(slot) = seen.get_mut(slot) {
                    *slot = key;
                }
            }
        }
        self.thinned_for = Some((camera, pixels_per_point, Arc::clone(path)));
    }
}

/// Renders the image of the segments: transparent where there is no segment, cuts over rapids.
fn render_image(
    camera: &Camera,
    pieces: &[([Pos2; 2], SegmentKind)],
    pixels_per_point: f32,
) -> ColorImage {
    let size = camera.rect.size() * pixels_per_point;
    let size = [
        size.x.ceil().max(1.0) as usize,
        size.y.ceil().max(1.0) as usize,
    ];
    let mut image = ColorImage::filled(size, theme::NO_FILL);
    let corner = camera.rect.min;
    let edge = pos2(size[0] as f32 - 1.0, size[1] as f32 - 1.0);
    let at = |point: Pos2| ((camera.screen_position(point) - corner) * pixels_per_point).to_pos2();
    for (ends, way) in pieces {
        let color = match way {
            SegmentKind::Jump => continue,
            SegmentKind::Rapid => theme::RAPID_PATH,
            SegmentKind::Feed => theme::FEED_PATH,
            SegmentKind::Thread => theme::THREAD_PATH,
        };
        let Some([from, to]) = clip_line(ends.map(at), edge) else {
            continue;
        };
        let steps = (to - from).abs().max_elem().ceil().max(1.0);
        let step = (to - from) / steps;
        for count in 0..=steps as u32 {
            let dot = from + step * count as f32;
            let index = dot.y as usize * size[0] + dot.x as usize;
            if let Some(pixel) = image.pixels.get_mut(index)
                && (*way != SegmentKind::Rapid || *pixel == theme::NO_FILL)
            {
                *pixel = color;
            }
        }
    }
    image
}

/// Clips a line at the edges of the image from (0, 0) to `edge`; `None` if the line is
/// outside.
///
/// ```text
///   from + t (to − from):  each side of the picture bounds t from below or above
/// ```
fn clip_line([from, to]: [Pos2; 2], edge: Pos2) -> Option<[Pos2; 2]> {
    let direction = to - from;
    if !(direction.x.is_finite() && direction.y.is_finite()) {
        return None;
    }
    let (mut first, mut last) = (0.0_f32, 1.0_f32);
    for (begin, delta, edge) in [(from.x, direction.x, edge.x), (from.y, direction.y, edge.y)] {
        if delta == 0.0 {
            if !(0.0..=edge).contains(&begin) {
                return None;
            }
            continue;
        }
        let (low, high) = (-begin / delta, (edge - begin) / delta);
        first = first.max(low.min(high));
        last = last.min(low.max(high));
    }
    (first <= last).then(|| {
        let clamped = |share: f32| {
            let point = from + direction * share;
            pos2(point.x.clamp(0.0, edge.x), point.y.clamp(0.0, edge.y))
        };
        [clamped(first), clamped(last)]
    })
}

#[cfg(test)]
mod tests {
    use super::super::path::tests::preview_path;
    use super::*;

    #[test]
    fn what_is_cut_again_is_drawn_once_and_moving_the_picture_costs_nothing() {
        let again = "G01 Z-30 F100\nG00 X42\nZ2\nX40\n".repeat(100);
        let path = Arc::new(preview_path(&format!("G00 X40 Z2\n{again}M30\n")));
        let room = Rect::from_min_size(Pos2::ZERO, egui::vec2(400.0, 300.0));
        let bounds = Rect::from_min_max(pos2(-35.0, 0.0), pos2(5.0, 25.0));
        let camera = Camera::fit(bounds, true, room);
        let mut thinned = ThinnedPath::default();
        thinned.update(&camera, &path, 1.0);
        assert!(path.segment_count() > 400);
        assert!(thinned.segments.len() < 8, "{}", thinned.segments.len());
        let all = path.segments();
        let all: Vec<_> = all.map(|(at, to)| ([at, to.end], to.kind)).collect();
        let whole = render_image(&camera, &all, 1.0);
        assert_eq!(
            render_image(&camera, &thinned.segments, 1.0).pixels,
            whole.pixels
        );
        assert!(whole.pixels.contains(&theme::FEED_PATH));

        thinned.segments.clear();
        thinned.update(&camera.with_centre(pos2(3.0, 1.0)), &path, 1.0);
        assert!(thinned.segments.is_empty(), "moved only");
        thinned.update(&camera, &path, 2.0);
        assert!(!thinned.segments.is_empty());
    }

    #[test]
    fn a_line_is_cut_off_at_the_picture() {
        let edge = pos2(9.0, 9.0);
        let inside = |from, to| clip_line([from, to], edge);
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
