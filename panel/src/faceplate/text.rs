//! Printed text: Unifont's dots, smoothed where they are enlarged.

use tiny_skia::{Color, FilterQuality, Pixmap, PixmapPaint, PremultipliedColorU8, Transform};

use super::Rect;
use crate::glyphs;

/// A text as a grid of dots, 16 high.
struct Mask {
    width: usize,
    height: usize,
    dots: Vec<bool>,
}

impl Mask {
    fn of(text: &str) -> Self {
        let width = glyphs::text_columns(text) * 8;
        let height = glyphs::GLYPH_HEIGHT;
        let mut mask = Self {
            width,
            height,
            dots: vec![false; width * height],
        };
        let mut left = 0;
        for character in text.chars() {
            let glyph = glyphs::dots(character);
            for (y, row) in glyph.rows.iter().enumerate() {
                for x in 0..glyph.columns * 8 {
                    if row & (0x8000 >> x) != 0 {
                        mask.dots[y * width + left + x] = true;
                    }
                }
            }
            left += glyph.columns * 8;
        }
        mask
    }

    fn get(&self, x: usize, y: usize) -> bool {
        x < self.width && y < self.height && self.dots[y * self.width + x]
    }

    /// Twice the size with the steps of slanted strokes rounded (Scale2x).
    fn doubled(&self) -> Self {
        let (width, height) = (self.width * 2, self.height * 2);
        let mut dots = vec![false; width * height];
        for y in 0..self.height {
            for x in 0..self.width {
                let own = self.get(x, y);
                let up = self.get(x, y.wrapping_sub(1));
                let down = self.get(x, y + 1);
                let left = self.get(x.wrapping_sub(1), y);
                let right = self.get(x + 1, y);
                let slanted = up != down && left != right;
                let corner = |a: bool, b: bool| if slanted && a == b { a } else { own };
                let at = 2 * y * width + 2 * x;
                dots[at] = corner(left, up);
                dots[at + 1] = corner(up, right);
                dots[at + width] = corner(left, down);
                dots[at + width + 1] = corner(down, right);
            }
        }
        Self {
            width,
            height,
            dots,
        }
    }

    fn pixmap(&self, ink: [u8; 3]) -> Option<Pixmap> {
        let mut pixmap = Pixmap::new(self.width as u32, self.height as u32)?;
        let [red, green, blue] = ink;
        let ink = PremultipliedColorU8::from_rgba(red, green, blue, u8::MAX)?;
        for (pixel, dot) in pixmap.pixels_mut().iter_mut().zip(&self.dots) {
            if *dot {
                *pixel = ink;
            }
        }
        Some(pixmap)
    }
}

/// Draws a text centred in a rectangle of panel units; `size` is its height. The
/// target begins at a `corner` of the whole picture, pixels.
pub(super) fn draw(
    target: &mut Pixmap,
    corner: (f32, f32),
    scale: f32,
    text: &str,
    size: f32,
    rect: Rect,
    ink: [u8; 3],
) {
    let mut mask = Mask::of(text);
    let dot = size * scale / 16.0;
    let mut left = dot;
    while left > 1.0 && mask.height < 256 {
        mask = mask.doubled();
        left /= 2.0;
    }
    let Some(picture) = mask.pixmap(ink) else {
        return;
    };
    let (cx, cy) = rect.center();
    let x = (cx * scale - mask.width as f32 * left / 2.0).round();
    let y = (cy * scale - mask.height as f32 * left / 2.0).round();
    let crisp = left.fract() == 0.0;
    let paint = PixmapPaint {
        quality: if crisp {
            FilterQuality::Nearest
        } else {
            FilterQuality::Bilinear
        },
        ..PixmapPaint::default()
    };
    let place = Transform::from_row(left, 0.0, 0.0, left, x - corner.0, y - corner.1);
    target.draw_pixmap(0, 0, picture.as_ref(), &paint, place, None);
}

/// An opaque colour.
pub(super) fn opaque([red, green, blue]: [u8; 3]) -> Color {
    Color::from_rgba8(red, green, blue, u8::MAX)
}
