//! Draws printed text with the outlines of the program's fonts.

use skrifa::outline::OutlinePen;
use tiny_skia::{Color, FillRule, Paint, PathBuilder, Pixmap, PixmapPaint, Shader, Transform};

use super::Rect;
use crate::fonts;

/// Em size of printed text as a fraction of the line height. Chinese characters leave a
/// margin.
const EM: f32 = 0.94;
/// Height above the base line of the middle of capitals and of Chinese characters, ems.
const MIDDLE: f32 = 0.37;

/// Returns the width of a printed text whose line height is `line`, in the same unit.
pub(crate) fn width(text: &str, line: f32) -> f32 {
    let size = line * EM;
    text.chars().map(|it| fonts::advance(it, size)).sum()
}

/// Adds the outline of a character to a path, y downwards.
struct Pen {
    path: PathBuilder,
    /// Horizontal origin of the character on the base line, pixels.
    x: f32,
    y: f32,
}

impl Pen {
    const fn at(&self, x: f32, y: f32) -> (f32, f32) {
        (self.x + x, self.y - y)
    }
}

impl OutlinePen for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        let [(cx, cy), (x, y)] = [self.at(cx, cy), self.at(x, y)];
        self.path.quad_to(cx, cy, x, y);
    }

    fn curve_to(&mut self, cx: f32, cy: f32, dx: f32, dy: f32, x: f32, y: f32) {
        let [(cx, cy), (dx, dy), (x, y)] = [self.at(cx, cy), self.at(dx, dy), self.at(x, y)];
        self.path.cubic_to(cx, cy, dx, dy, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

/// Draws a text centred in `rect` (panel units). `size` is the line height in panel units,
/// `corner` the pixel of the whole panel's picture where `target` begins.
pub(super) fn draw(
    target: &mut Pixmap,
    corner: (f32, f32),
    scale: f32,
    text: &str,
    size: f32,
    rect: Rect,
    ink: [u8; 3],
) {
    let em = size * scale * EM;
    let wide = width(text, size * scale);
    let (cx, cy) = rect.center();
    // The base line is between two pixels, so that horizontal strokes stay sharp.
    let (x, y) = (
        (cx * scale - wide / 2.0).round(),
        (cy * scale + MIDDLE * em).round(),
    );
    // Use a separate picture, because outlines that cross the edge of a pixmap are drawn
    // wrongly.
    let (left, top) = (x - 2.0, (y - 1.1 * em).floor());
    let size_px = [wide + 4.0, 1.5 * em].map(|side| side.ceil().max(1.0) as u32);
    let Some(mut picture) = Pixmap::new(size_px[0], size_px[1]) else {
        return;
    };
    let mut pen = Pen {
        path: PathBuilder::new(),
        x: x - left,
        y: y - top,
    };
    for character in text.chars() {
        fonts::outline(character, em, &mut pen);
        pen.x += fonts::advance(character, em);
    }
    // A text of spaces has no path.
    let Some(path) = pen.path.finish() else {
        return;
    };
    let paint = Paint {
        shader: Shader::SolidColor(opaque(ink)),
        anti_alias: true,
        ..Paint::default()
    };
    picture.fill_path(
        &path,
        &paint,
        FillRule::Winding,
        Transform::identity(),
        None,
    );
    let (x, y) = ((left - corner.0) as i32, (top - corner.1) as i32);
    let (plain, transform) = (PixmapPaint::default(), Transform::identity());
    target.draw_pixmap(x, y, picture.as_ref(), &plain, transform, None);
}

/// Returns a colour without transparency, from red, green and blue.
pub(super) fn opaque([red, green, blue]: [u8; 3]) -> Color {
    Color::from_rgba8(red, green, blue, u8::MAX)
}
