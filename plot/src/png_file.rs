//! Writes the drawing as PNG.

use gsk_messages::Language;
use tiny_skia::Pixmap;

use crate::PictureError;
use crate::canvas::{PictureCanvas, TextAlign};
use crate::clip::clip_to_frame;
use crate::drawing::PathDrawing;
use crate::layout::PathLayout;
use crate::legend::{EDGE, GAP, SAMPLE};
use crate::path_pieces::PathLine;
use crate::pens::{COLLISION_MARK, DIMENSION, LinePen, MARK_ARM};

/// Style of the grid lines.
const GRID: LinePen = grey_pen(0xE0, &[]);
const FRAME: LinePen = grey_pen(0xB0, &[]);
const SPINDLE_AXIS: LinePen = grey_pen(0x80, &[16.0, 4.0, 3.0, 4.0]);

/// Maximum number of pieces of a path that is drawn with smooth edges, which takes a second.
const MAX_SMOOTH_PIECES: usize = 30_000;

/// Draws a toolpath and returns the bytes of the PNG file. `language` is the language of its
/// texts.
pub fn render(drawing: &PathDrawing, language: Language) -> Result<Vec<u8>, PictureError> {
    let layout = PathLayout::new(drawing, language);
    let mut canvas = PictureCanvas::new(drawing.options().size)?;
    draw_grid(&mut canvas, &layout);
    draw_scenery(&mut canvas, drawing, &layout);
    canvas.set_smooth(drawing.pieces().len() <= MAX_SMOOTH_PIECES);
    draw_path(&mut canvas, drawing, &layout, |made| {
        made == PathLine::Rapid
    });
    draw_path(&mut canvas, drawing, &layout, |made| {
        made != PathLine::Rapid
    });
    canvas.set_smooth(true);
    for mark in drawing
        .scenery()
        .marks
        .iter()
        .filter(|it| layout.contains(**it))
    {
        let (x, y) = layout.to_units(*mark);
        canvas.draw_line(
            COLLISION_MARK,
            (x - MARK_ARM, y - MARK_ARM),
            (x + MARK_ARM, y + MARK_ARM),
        );
        canvas.draw_line(
            COLLISION_MARK,
            (x - MARK_ARM, y + MARK_ARM),
            (x + MARK_ARM, y - MARK_ARM),
        );
    }
    for dimension in &layout.dimensions {
        if let Some([from, to]) = dimension.line {
            canvas.draw_line(DIMENSION, from, to);
        }
        canvas.draw_outlined_text(dimension.corner.0, dimension.corner.1, &dimension.text);
    }
    for number in &layout.numbers {
        canvas.draw_dot(number.end, 2.0);
        canvas.draw_outlined_text(number.corner.0, number.corner.1, &number.text);
    }
    draw_head(&mut canvas, &layout);
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

const fn grey_pen(shade: u8, dash: &'static [f32]) -> LinePen {
    LinePen {
        color: [shade; 3],
        width: 1.0,
        dash,
    }
}

/// Draws the part and its clamping under the path.
fn draw_scenery(canvas: &mut PictureCanvas, drawing: &PathDrawing, layout: &PathLayout) {
    let (low, high) = layout.visible_range();
    for (look, polygons) in drawing.scenery().clip_to(low, high) {
        let placed = |polygon: &Vec<_>| polygon.iter().map(|it| layout.to_units(*it)).collect();
        let polygons: Vec<Vec<(f64, f64)>> = polygons.iter().map(placed).collect();
        if let Some(color) = look.fill {
            canvas.fill_polygons(color, &polygons);
        }
        for mut polygon in polygons {
            polygon.extend(polygon.first().copied());
            canvas.draw_polyline(look.edge, &polygon);
        }
    }
}

/// Draws the lines of the kinds that `is_wanted` accepts, clipped to the frame.
fn draw_path(
    canvas: &mut PictureCanvas,
    drawing: &PathDrawing,
    layout: &PathLayout,
    is_wanted: impl Fn(PathLine) -> bool,
) {
    let strokes = drawing.pieces().strokes();
    for (made, points) in strokes.filter(|(made, _)| is_wanted(*made)) {
        let points = points.map(|point| layout.to_units(point));
        clip_to_frame(points, layout.frame, |part| {
            canvas.draw_polyline(LinePen::for_line(made), part);
        });
    }
}

fn draw_head(canvas: &mut PictureCanvas, layout: &PathLayout) {
    let head = &layout.head;
    canvas.draw_text(EDGE, 16.0, &head.title, TextAlign::Left);
    canvas.draw_text(layout.size.0 - EDGE, 16.0, &head.summary, TextAlign::Right);
    for entry in &head.entries {
        let (x, y) = entry.line_start;
        canvas.draw_line(entry.pen, (x, y), (x + SAMPLE, y));
        canvas.draw_text(x + SAMPLE + GAP, y - 8.0, &entry.text, TextAlign::Left);
    }
}

fn draw_grid(canvas: &mut PictureCanvas, layout: &PathLayout) {
    let (left, top, right, bottom) = layout.frame;
    for tick in &layout.z_ticks {
        let at = tick.position.round() + 0.5;
        canvas.draw_line(GRID, (at, top), (at, bottom));
        canvas.draw_text(tick.position, bottom + 8.0, &tick.label, TextAlign::Center);
    }
    for tick in &layout.x_ticks {
        let at = tick.position.round() + 0.5;
        canvas.draw_line(GRID, (left, at), (right, at));
        canvas.draw_text(
            left - 8.0,
            tick.position - 8.0,
            &tick.label,
            TextAlign::Right,
        );
    }
    let (west, north) = (left.round() + 0.5, top.round() + 0.5);
    let (east, south) = (right.round() + 0.5, bottom.round() + 0.5);
    let corners = [(west, north), (east, north), (east, south), (west, south)];
    for (index, corner) in corners.into_iter().enumerate() {
        canvas.draw_line(FRAME, corner, corners[(index + 1) % 4]);
    }
    if let Some(at) = layout.spindle_axis {
        canvas.draw_line(SPINDLE_AXIS, (left, at), (right, at));
    }
    canvas.draw_text(right + 8.0, bottom + 8.0, "Z mm", TextAlign::Left);
    canvas.draw_text(left - 60.0, top - 26.0, "X ⌀ mm", TextAlign::Left);
}
