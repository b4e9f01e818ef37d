//! The drawing as PNG.

use tiny_skia::{Color, Paint, PathBuilder, Pixmap, Stroke, StrokeDash, Transform};

use super::{Drawing, HEIGHT, Layout, WIDTH};

/// The whole file.
pub fn render(drawing: &Drawing) -> Result<Vec<u8>, String> {
    let layout = Layout::new(drawing);
    let mut picture = Pixmap::new(WIDTH, HEIGHT).ok_or("no memory for the picture")?;
    picture.fill(Color::WHITE);
    grid(&mut picture, &layout);
    path(&mut picture, drawing, &layout, true);
    path(&mut picture, drawing, &layout, false);
    text(&mut picture, 20, 22, &drawing.title, Align::Left);
    encode(&picture)
}

/// An opaque picture as a PNG file.
pub fn encode(picture: &Pixmap) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, picture.width(), picture.height());
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().map_err(|error| error.to_string())?;
    // All pixels are opaque: premultiplied and plain colours are the same.
    writer
        .write_image_data(picture.data())
        .map_err(|error| error.to_string())?;
    writer.finish().map_err(|error| error.to_string())?;
    Ok(bytes)
}

fn paint(red: u8, green: u8, blue: u8) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(red, green, blue, 255);
    paint
}

/// All strokes of one kind as one path.
fn path(picture: &mut Pixmap, drawing: &Drawing, layout: &Layout, rapid: bool) {
    let mut builder = PathBuilder::new();
    for stroke in drawing
        .strokes
        .iter()
        .filter(|stroke| stroke.rapid == rapid)
    {
        for (index, point) in stroke.points.iter().enumerate() {
            let (x, y) = layout.place(*point);
            match index {
                0 => builder.move_to(x as f32, y as f32),
                _ => builder.line_to(x as f32, y as f32),
            }
        }
    }
    let Some(path) = builder.finish() else { return };
    let (paint, stroke) = if rapid {
        let dash = StrokeDash::new(vec![6.0, 4.0], 0.0);
        (
            paint(0xC0, 0x50, 0x20),
            Stroke {
                width: 1.0,
                dash,
                ..Stroke::default()
            },
        )
    } else {
        (
            paint(0x10, 0x40, 0xB0),
            Stroke {
                width: 2.0,
                ..Stroke::default()
            },
        )
    };
    picture.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
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
