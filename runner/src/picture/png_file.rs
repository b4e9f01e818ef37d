//! Writes the drawing as PNG.

use gsk_messages::Language;
use tiny_skia::Pixmap;

use super::PictureError;
use super::canvas::{Align, Canvas};
use super::clip::clipped;
use super::drawing::Drawing;
use super::layout::Layout;
use super::legend::{EDGE, GAP, SAMPLE};
use super::pens::{ARM, DIMENSION, MARK, Pen};
use super::pieces::Made;

/// Lines of the grid, of its frame, of the spindle axis.
const GRID: Pen = grey(0xE0, &[]);
const FRAME: Pen = grey(0xB0, &[]);
const SPINDLE_AXIS: Pen = grey(0x80, &[16.0, 4.0, 3.0, 4.0]);

/// Number of pieces up to which a path is drawn with smooth edges: a second of work.
const MOST_SMOOTH: usize = 30_000;

/// Draws the whole picture.
pub fn render(drawing: &Drawing, language: Language) -> Result<Vec<u8>, PictureError> {
    let layout = Layout::new(drawing, language);
    let mut canvas = Canvas::new(drawing.look().size)?;
    grid(&mut canvas, &layout);
    scenery(&mut canvas, drawing, &layout);
    canvas.set_smooth(drawing.pieces().len() <= MOST_SMOOTH);
    path(&mut canvas, drawing, &layout, |made| made == Made::Rapid);
    path(&mut canvas, drawing, &layout, |made| made != Made::Rapid);
    canvas.set_smooth(true);
    for mark in drawing
        .scenery()
        .marks
        .iter()
        .filter(|it| layout.shows(**it))
    {
        let (x, y) = layout.place(*mark);
        canvas.line(MARK, (x - ARM, y - ARM), (x + ARM, y + ARM));
        canvas.line(MARK, (x - ARM, y + ARM), (x + ARM, y - ARM));
    }
    for dimension in &layout.dimensions {
        if let Some([from, to]) = dimension.line {
            canvas.line(DIMENSION, from, to);
        }
        canvas.text_over_lines(dimension.at.0, dimension.at.1, &dimension.words);
    }
    for number in &layout.numbers {
        canvas.dot(number.end, 2.0);
        canvas.text_over_lines(number.at.0, number.at.1, &number.words);
    }
    head(&mut canvas, &layout);
    encode(&canvas.into_pixels())
}

/// Encodes an opaque picture as a PNG file.
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

const fn grey(shade: u8, dash: &'static [f32]) -> Pen {
    Pen {
        color: [shade; 3],
        width: 1.0,
        dash,
    }
}

/// Draws part and clamping.
fn scenery(canvas: &mut Canvas, drawing: &Drawing, layout: &Layout) {
    let (low, high) = layout.window();
    for (look, polygons) in drawing.scenery().within(low, high) {
        let placed = |polygon: &Vec<_>| polygon.iter().map(|it| layout.place(*it)).collect();
        let polygons: Vec<Vec<(f64, f64)>> = polygons.iter().map(placed).collect();
        if let Some(color) = look.fill {
            canvas.fill(color, &polygons);
        }
        for mut polygon in polygons {
            polygon.extend(polygon.first().copied());
            canvas.polyline(look.edge, &polygon);
        }
    }
}

/// Draws the lines of the wanted kinds inside the frame.
fn path(canvas: &mut Canvas, drawing: &Drawing, layout: &Layout, wanted: impl Fn(Made) -> bool) {
    let strokes = drawing.pieces().strokes();
    for (made, points) in strokes.filter(|(made, _)| wanted(*made)) {
        let points = points.map(|point| layout.place(point));
        clipped(points, layout.frame, |part| {
            canvas.polyline(Pen::of(made), part);
        });
    }
}

fn head(canvas: &mut Canvas, layout: &Layout) {
    let head = &layout.head;
    canvas.text(EDGE, 16.0, &head.title, Align::Left);
    canvas.text(layout.size.0 - EDGE, 16.0, &head.summary, Align::Right);
    for entry in &head.entries {
        let (x, y) = entry.at;
        canvas.line(entry.pen, (x, y), (x + SAMPLE, y));
        canvas.text(x + SAMPLE + GAP, y - 8.0, &entry.words, Align::Left);
    }
}

fn grid(canvas: &mut Canvas, layout: &Layout) {
    let (left, top, right, bottom) = layout.frame;
    for tick in &layout.z_ticks {
        let at = tick.at.round() + 0.5;
        canvas.line(GRID, (at, top), (at, bottom));
        canvas.text(tick.at, bottom + 8.0, &tick.label, Align::Center);
    }
    for tick in &layout.x_ticks {
        let at = tick.at.round() + 0.5;
        canvas.line(GRID, (left, at), (right, at));
        canvas.text(left - 8.0, tick.at - 8.0, &tick.label, Align::Right);
    }
    let (west, north) = (left.round() + 0.5, top.round() + 0.5);
    let (east, south) = (right.round() + 0.5, bottom.round() + 0.5);
    let corners = [(west, north), (east, north), (east, south), (west, south)];
    for (index, corner) in corners.into_iter().enumerate() {
        canvas.line(FRAME, corner, corners[(index + 1) % 4]);
    }
    if let Some(at) = layout.spindle_axis {
        canvas.line(SPINDLE_AXIS, (left, at), (right, at));
    }
    canvas.text(right + 8.0, bottom + 8.0, "Z mm", Align::Left);
    canvas.text(left - 60.0, top - 26.0, "X ⌀ mm", Align::Left);
}
