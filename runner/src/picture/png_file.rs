//! The drawing as PNG.

use tiny_skia::{Color, Paint, PathBuilder, Pixmap, Stroke, StrokeDash, Transform};

use gsk_core::units::Point;

use super::PictureError;
use super::drawing::Drawing;
use super::extent::{HEIGHT, WIDTH};
use super::layout::Layout;

/// The whole file.
pub fn render(drawing: &Drawing) -> Result<Vec<u8>, PictureError> {
    let layout = Layout::new(drawing.extent());
    let mut picture = Pixmap::new(WIDTH, HEIGHT).ok_or(PictureError::Memory)?;
    picture.fill(Color::WHITE);
    grid(&mut picture, &layout);
    path(&mut picture, drawing, &layout, true);
    path(&mut picture, drawing, &layout, false);
    text(&mut picture, 20, 22, &drawing.title, Align::Left);
    encode(&picture)
}

/// An opaque picture as a PNG file.
pub fn encode(picture: &Pixmap) -> Result<Vec<u8>, PictureError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, picture.width(), picture.height());
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    // All pixels are opaque: premultiplied and plain colours are the same.
    writer.write_image_data(picture.data())?;
    writer.finish()?;
    Ok(bytes)
}

fn paint(red: u8, green: u8, blue: u8) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(red, green, blue, 255);
    paint
}

/// Points that are stroked at a time: the time of a stroke grows faster than its
/// number of points.
const POINTS_A_STROKE: usize = 128;

/// Points nearer to the one before than this add nothing that is seen, pixels.
const NEAR: f32 = 0.5;

/// Length of a dash, and of the gap after it, pixels.
const DASH: [f32; 2] = [6.0, 4.0];

/// Draws all strokes of one kind.
fn path(picture: &mut Pixmap, drawing: &Drawing, layout: &Layout, rapid: bool) {
    let pen = if rapid {
        Pen {
            paint: paint(0xC0, 0x50, 0x20),
            width: 1.0,
            dashed: true,
        }
    } else {
        Pen {
            paint: paint(0x10, 0x40, 0xB0),
            width: 2.0,
            dashed: false,
        }
    };
    for (is_rapid, points) in drawing.strokes() {
        if is_rapid == rapid {
            pen.stroke(picture, layout, points);
        }
    }
}

struct Pen {
    paint: Paint<'static>,
    width: f32,
    dashed: bool,
}

impl Pen {
    /// Draws a stroke in pieces; its dashes go on from piece to piece.
    fn stroke(&self, picture: &mut Pixmap, layout: &Layout, points: impl Iterator<Item = Point>) {
        let mut points = points
            .map(|point| {
                let (x, y) = layout.place(point);
                (x as f32, y as f32)
            })
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
            while count < POINTS_A_STROKE {
                let Some(point) = points.next() else { break };
                let length = (point.0 - last.0).hypot(point.1 - last.1);
                if length < NEAR && points.peek().is_some() {
                    continue;
                }
                builder.line_to(point.0, point.1);
                along += length;
                last = point;
                count += 1;
            }
            if let Some(path) = builder.finish() {
                let stroke = self.style(begin);
                picture.stroke_path(&path, &self.paint, &stroke, Transform::identity(), None);
            }
        }
    }

    /// The style of a piece that begins `along` pixels after the begin of its stroke.
    fn style(&self, along: f32) -> Stroke {
        let period: f32 = DASH.iter().sum();
        let dash = self
            .dashed
            .then(|| StrokeDash::new(DASH.to_vec(), along % period))
            .flatten();
        Stroke {
            width: self.width,
            dash,
            ..Stroke::default()
        }
    }
}

fn line(picture: &mut Pixmap, from: (f64, f64), to: (f64, f64), paint: &Paint<'_>, dash: &[f32]) {
    let mut builder = PathBuilder::new();
    builder.move_to(from.0 as f32, from.1 as f32);
    builder.line_to(to.0 as f32, to.1 as f32);
    let Some(path) = builder.finish() else { return };
    let dash = (!dash.is_empty())
        .then(|| StrokeDash::new(dash.to_vec(), 0.0))
        .flatten();
    let stroke = Stroke {
        width: 1.0,
        dash,
        ..Stroke::default()
    };
    picture.stroke_path(&path, paint, &stroke, Transform::identity(), None);
}

fn grid(picture: &mut Pixmap, layout: &Layout) {
    let (left, right) = Layout::across();
    let (top, bottom) = Layout::down();
    let pale = paint(0xE0, 0xE0, 0xE0);
    for tick in &layout.z_ticks {
        let at = tick.at.round() + 0.5;
        line(picture, (at, top), (at, bottom), &pale, &[]);
        text(
            picture,
            tick.at as i32,
            bottom as i32 + 8,
            &tick.label,
            Align::Center,
        );
    }
    for tick in &layout.x_ticks {
        let at = tick.at.round() + 0.5;
        line(picture, (left, at), (right, at), &pale, &[]);
        text(
            picture,
            left as i32 - 8,
            tick.at as i32 - 8,
            &tick.label,
            Align::Right,
        );
    }
    if let Some(at) = layout.spindle_axis {
        let grey = paint(0x80, 0x80, 0x80);
        line(
            picture,
            (left, at),
            (right, at),
            &grey,
            &[16.0, 4.0, 3.0, 4.0],
        );
    }
    text(
        picture,
        right as i32 + 8,
        bottom as i32 + 8,
        "Z mm",
        Align::Left,
    );
    text(
        picture,
        left as i32 - 60,
        top as i32 - 26,
        "X ⌀ mm",
        Align::Left,
    );
}

#[derive(Clone, Copy)]
enum Align {
    Left,
    Center,
    Right,
}

/// Writes a text in Unifont dots; `y` is the upper edge.
fn text(picture: &mut Pixmap, x: i32, y: i32, text: &str, align: Align) {
    let glyphs: Vec<_> = text.chars().filter_map(unifont::get_glyph).collect();
    let width: usize = glyphs.iter().map(|glyph| glyph.get_width()).sum();
    let mut left = match align {
        Align::Left => x,
        Align::Center => x - width as i32 / 2,
        Align::Right => x - width as i32,
    };
    for glyph in glyphs {
        for dot_y in 0..16 {
            for dot_x in 0..glyph.get_width() {
                if glyph.get_pixel(dot_x, dot_y) {
                    dot(picture, left + dot_x as i32, y + dot_y as i32);
                }
            }
        }
        left += glyph.get_width() as i32;
    }
}

fn dot(picture: &mut Pixmap, x: i32, y: i32) {
    let width = picture.width() as i32;
    if !(0..width).contains(&x) || !(0..picture.height() as i32).contains(&y) {
        return;
    }
    let index = (y * width + x) as usize;
    if let Some(pixel) = picture.pixels_mut().get_mut(index) {
        *pixel = tiny_skia::ColorU8::from_rgba(0x20, 0x20, 0x20, 255).premultiply();
    }
}
