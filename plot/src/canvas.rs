//! Draws lines and texts on pixels.

use tiny_skia::{Color, ColorU8, Paint, PathBuilder, Pixmap, Stroke, StrokeDash, Transform};

use crate::PictureError;
use crate::extent::PictureSize;
use crate::pens::LinePen;
use crate::text_width::text_width;

/// Maximum number of points of a stroke. The time of a stroke grows faster than its number of
/// points.
const MAX_STROKE_POINTS: usize = 128;

/// Distance from the previous point below which a point is not drawn, picture units.
const MIN_POINT_DISTANCE: f32 = 0.5;

/// Which end of a text, or its middle, is at its reference point.
#[derive(Clone, Copy)]
pub(super) enum TextAlign {
    Left,
    Center,
    Right,
}

/// A pixel picture on which callers draw in picture units.
pub(super) struct PictureCanvas {
    pixels: Pixmap,
    /// Number of pixels per picture unit.
    unit_px: u32,
    /// Whether lines are drawn with smooth edges.
    has_smooth_edges: bool,
}

impl PictureCanvas {
    /// Creates a white picture.
    ///
    /// # Errors
    /// There is not enough memory.
    pub fn new(size: PictureSize) -> Result<Self, PictureError> {
        let pixels = Pixmap::new(size.width(), size.height());
        let mut pixels = pixels.ok_or(PictureError::Memory)?;
        pixels.fill(Color::WHITE);
        let unit = size.unit_px();
        let smooth = true;
        Ok(Self {
            pixels,
            unit_px: unit,
            has_smooth_edges: smooth,
        })
    }

    /// Turns smooth edges on or off. Without them lines are drawn a hundred times faster, and
    /// in dense lines the edges are invisible anyway.
    pub const fn set_smooth(&mut self, smooth: bool) {
        self.has_smooth_edges = smooth;
    }

    /// Returns the finished picture as pixels.
    pub fn into_pixels(self) -> Pixmap {
        self.pixels
    }

    /// Draws a line through points, in picture units. The dashes continue from piece to piece.
    pub fn draw_polyline(&mut self, pen: LinePen, points: &[(f64, f64)]) {
        if !self.has_smooth_edges {
            return self.draw_plain_polyline(pen, points);
        }
        let mut points = points
            .iter()
            .map(|(x, y)| (*x as f32, *y as f32))
            .peekable();
        let Some(mut last) = points.next() else {
            return;
        };
        let mut along = 0.0;
        while points.peek().is_some() {
            let mut builder = PathBuilder::new();
            builder.move_to(last.0, last.1);
            let begin = along;
            let mut count = 0;
            while count < MAX_STROKE_POINTS {
                let Some(point) = points.next() else { break };
                let length = libm::hypotf(point.0 - last.0, point.1 - last.1);
                if length < MIN_POINT_DISTANCE && points.peek().is_some() {
                    continue;
                }
                builder.line_to(point.0, point.1);
                along += length;
                last = point;
                count += 1;
            }
            self.stroke(builder, pen, begin);
        }
    }

    /// Draws a line through points without smooth edges.
    fn draw_plain_polyline(&mut self, pen: LinePen, points: &[(f64, f64)]) {
        let unit = f64::from(self.unit_px);
        let mut along = 0.0;
        for two in points.windows(2) {
            if let [from, to] = two {
                let [from, to] = [from, to].map(|(x, y)| (x * unit, y * unit));
                self.draw_plain_line(pen, from, to, along);
                along += libm::hypot(to.0 - from.0, to.1 - from.1);
            }
        }
    }

    /// Draws a straight line between two points, pixel by pixel, in pixels. `along` is the
    /// length of the line before `from`, which shifts its dashes.
    /// ```text
    /// a step a pixel along the longer side, as many across it as the pen is wide
    /// ```
    fn draw_plain_line(&mut self, pen: LinePen, from: (f64, f64), to: (f64, f64), along: f64) {
        let (across, down) = (to.0 - from.0, to.1 - from.1);
        let steps = across.abs().max(down.abs()).ceil().max(1.0);
        let (step_x, step_y) = (across / steps, down / steps);
        let step = libm::hypot(step_x, step_y);
        let flat = across.abs() >= down.abs();
        let width = (pen.width * self.unit_px as f32).round().max(1.0) as usize;
        let unit = self.unit_px as f32;
        let period = f64::from(pen.dash.iter().sum::<f32>() * unit);
        let drawn = f64::from(pen.dash.first().map_or(0.0, |dash| dash * unit));
        let [red, green, blue] = pen.color;
        let color = ColorU8::from_rgba(red, green, blue, 255).premultiply();
        let row = self.pixels.width() as usize;
        let pixels = self.pixels.pixels_mut();
        let beside = if flat { row } else { 1 };
        for index in 0..=steps as u32 {
            let index = f64::from(index);
            if period > 0.0 && (along + index * step) % period >= drawn {
                continue;
            }
            // The frame is within the picture, so coordinates are not negative.
            let (x, y) = (from.0 + step_x * index, from.1 + step_y * index);
            let first = y as usize * row + x as usize;
            for offset in 0..width {
                if let Some(pixel) = pixels.get_mut(first + offset * beside) {
                    *pixel = color;
                }
            }
        }
    }

    /// Draws a straight line between two points, in picture units.
    pub fn draw_line(&mut self, pen: LinePen, from: (f64, f64), to: (f64, f64)) {
        let mut builder = PathBuilder::new();
        builder.move_to(from.0 as f32, from.1 as f32);
        builder.line_to(to.0 as f32, to.1 as f32);
        self.stroke(builder, pen, 0.0);
    }

    /// Fills polygons, in picture units. The corners of holes go in the opposite direction.
    pub fn fill_polygons(&mut self, color: [u8; 3], polygons: &[Vec<(f64, f64)>]) {
        let mut builder = PathBuilder::new();
        for polygon in polygons {
            for (index, (x, y)) in polygon.iter().enumerate() {
                match index {
                    0 => builder.move_to(*x as f32, *y as f32),
                    _ => builder.line_to(*x as f32, *y as f32),
                }
            }
            builder.close();
        }
        let Some(path) = builder.finish() else { return };
        let rule = tiny_skia::FillRule::Winding;
        let scale = self.transform();
        self.pixels
            .fill_path(&path, &paint(color), rule, scale, None);
    }

    /// Fills the picture with a gradient from the first colour at the top to the second at the
    /// bottom; red, green, blue, 0 to 255.
    pub fn fill_gradient(&mut self, [above, below]: [[f32; 3]; 2]) {
        let (width, height) = (self.pixels.width() as usize, self.pixels.height());
        let rows = self.pixels.pixels_mut().chunks_exact_mut(width.max(1));
        for (row, pixels) in rows.enumerate() {
            let share = row as f32 / height.max(1) as f32;
            let mixed: [u8; 3] = core::array::from_fn(|index| {
                (above[index] + (below[index] - above[index]) * share).round() as u8
            });
            let [red, green, blue] = mixed;
            pixels.fill(ColorU8::from_rgba(red, green, blue, 255).premultiply());
        }
    }

    /// Blends a picture of the same size over this one. The pixels are premultiplied RGBA.
    pub fn blend(&mut self, picture: &[[u8; 4]]) {
        let own = self.pixels.data_mut().chunks_exact_mut(4);
        for (own, pixel) in own.zip(picture) {
            let left = 255 - u32::from(pixel[3]);
            for (own, over) in own.iter_mut().zip(pixel) {
                let through = (u32::from(*own) * left + 127) / 255;
                *own = (u32::from(*over) + through).min(255) as u8;
            }
        }
    }

    /// Draws a filled dark circle, in picture units.
    pub fn draw_dot(&mut self, at: (f64, f64), radius: f32) {
        let Some(path) = PathBuilder::from_circle(at.0 as f32, at.1 as f32, radius) else {
            return;
        };
        let paint = paint([0x20; 3]);
        let rule = tiny_skia::FillRule::Winding;
        let scale = self.transform();
        self.pixels.fill_path(&path, &paint, rule, scale, None);
    }

    /// Writes a text in Unifont glyphs. `x` is the point of its alignment, `y` its upper edge,
    /// in picture units.
    pub fn draw_text(&mut self, x: f64, y: f64, text: &str, align: TextAlign) {
        self.draw_glyphs(x, y, text, align, [0x20; 3]);
    }

    /// Writes a text with a white outline that keeps it readable over lines. `x` and `y` are
    /// its upper left corner, in picture units.
    pub fn draw_outlined_text(&mut self, x: f64, y: f64, text: &str) {
        for (right, down) in [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0)] {
            self.draw_glyphs(x + right, y + down, text, TextAlign::Left, [0xFF; 3]);
        }
        self.draw_text(x, y, text, TextAlign::Left);
    }

    fn draw_glyphs(&mut self, x: f64, y: f64, text: &str, align: TextAlign, color: [u8; 3]) {
        let mut left = match align {
            TextAlign::Left => x,
            TextAlign::Center => x - text_width(text) / 2.0,
            TextAlign::Right => x - text_width(text),
        }
        .round() as i32;
        let top = y.round() as i32;
        for glyph in text.chars().filter_map(gsk_panel::glyphs::glyph) {
            for down in 0..16 {
                for right in 0..glyph.get_width() {
                    if glyph.get_pixel(right, down) {
                        self.fill_unit(left + right as i32, top + down as i32, color);
                    }
                }
            }
            left += glyph.get_width() as i32;
        }
    }

    /// Fills the pixels of one picture unit with a colour.
    fn fill_unit(&mut self, x: i32, y: i32, [red, green, blue]: [u8; 3]) {
        let unit = self.unit_px as i32;
        let (width, height) = (self.pixels.width() as i32, self.pixels.height() as i32);
        let color = ColorU8::from_rgba(red, green, blue, 255).premultiply();
        for down in y * unit..(y + 1) * unit {
            for right in x * unit..(x + 1) * unit {
                let inside = (0..width).contains(&right) && (0..height).contains(&down);
                let index = (down * width + right) as usize;
                if let Some(pixel) = self.pixels.pixels_mut().get_mut(index).filter(|_| inside) {
                    *pixel = color;
                }
            }
        }
    }

    /// Draws a path with a pen. The path begins `along` units after the beginning of its line,
    /// which shifts its dashes.
    fn stroke(&mut self, builder: PathBuilder, pen: LinePen, along: f32) {
        let Some(path) = builder.finish() else { return };
        let period: f32 = pen.dash.iter().sum();
        let dash = (!pen.dash.is_empty())
            .then(|| StrokeDash::new(pen.dash.to_vec(), along % period))
            .flatten();
        let stroke = Stroke {
            width: pen.width,
            dash,
            ..Stroke::default()
        };
        let paint = paint(pen.color);
        let scale = self.transform();
        self.pixels.stroke_path(&path, &paint, &stroke, scale, None);
    }

    fn transform(&self) -> Transform {
        let unit = self.unit_px as f32;
        Transform::from_scale(unit, unit)
    }
}

fn paint([red, green, blue]: [u8; 3]) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(red, green, blue, 255);
    paint
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path_pieces::PathLine;

    /// Returns column and row of every pixel that is not white.
    fn drawn_pixels(canvas: &PictureCanvas) -> Vec<(u32, u32)> {
        let width = canvas.pixels.width();
        let pixels = canvas.pixels.pixels().iter().zip(0..);
        pixels
            .filter(|(pixel, _)| (pixel.red(), pixel.green(), pixel.blue()) != (255, 255, 255))
            .map(|(_, index)| (index % width, index / width))
            .collect()
    }

    #[test]
    fn lines_with_and_without_smooth_edges_lie_on_each_other() {
        let pen = LinePen::for_line(PathLine::Cut(0));
        let points = [(100.0, 100.0), (300.0, 100.0), (350.0, 250.0), (20.0, 40.0)];
        let drawn = |smooth: bool| {
            let mut canvas = PictureCanvas::new("480x320".parse().expect("size")).expect("canvas");
            canvas.set_smooth(smooth);
            canvas.draw_polyline(pen, &points);
            drawn_pixels(&canvas)
        };
        let (smooth, plain) = (drawn(true), drawn(false));
        assert!(plain.len() > 1000, "{}", plain.len());
        let near = |(x, y): &(u32, u32)| {
            let close = |other: &(u32, u32)| x.abs_diff(other.0) <= 1 && y.abs_diff(other.1) <= 1;
            smooth.iter().any(close)
        };
        assert!(plain.iter().all(near));
    }

    #[test]
    fn dashes_leave_gaps() {
        let mut canvas = PictureCanvas::new("480x320".parse().expect("size")).expect("canvas");
        canvas.set_smooth(false);
        canvas.draw_polyline(
            LinePen::for_line(PathLine::Rapid),
            &[(100.0, 100.0), (200.0, 100.0)],
        );
        let inked = drawn_pixels(&canvas).len();
        assert!((55..70).contains(&inked), "{inked}");
    }
}
