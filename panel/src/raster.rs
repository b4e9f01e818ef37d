//! Converts a [`Screen`] to dots and colours.

use tiny_skia::{FilterQuality, Pixmap, PixmapMut, PixmapPaint, Transform};

use crate::bitmap::Bitmap;
use crate::glyphs::{self, GLYPH_HEIGHT};
use crate::lcd::LcdColours;
use crate::screen::{BigText, COLUMNS, Cell, CellStyle, HEIGHT, ROWS, Screen, WIDTH};

/// Number of bytes of an RGBA picture of 320×240 dots.
pub(crate) const RGBA_BYTES: usize = WIDTH * HEIGHT * 4;

/// Greatest scale of [`render`], pixels per dot.
pub(crate) const MAX_SCALE: u32 = 16;

/// A colour: red, green, blue, 0 to 255 each.
pub type Rgb = [u8; 3];

/// Dot rows of a cell that the bar of [`CellStyle::Underline`] covers.
const BAR: core::ops::Range<usize> = 14..16;

/// The two colours of the LCD at its current brightness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Palette {
    /// Colour of the lit background of the LCD.
    pub background: Rgb,
    /// Colour of text and lines on the LCD.
    pub text: Rgb,
}

/// Returns an LCD's colours for a brightness of 0 (darkest, still readable) to 15.
pub fn palette(colours: LcdColours, brightness: u8) -> Palette {
    let level = u32::from(brightness.min(15));
    // Dim the background more than the text.
    let background = 40 + 4 * level;
    let text = 70 + 2 * level;
    let dim = |colour: Rgb, percent: u32| {
        colour.map(|part| u8::try_from(u32::from(part) * percent / 100).unwrap_or(u8::MAX))
    };
    Palette {
        background: dim(colours.background, background),
        text: dim(colours.text, text),
    }
}

/// Returns the dots of a screen: cells, double-size texts and graphic combined.
pub fn bitmap(screen: &Screen) -> Bitmap {
    let mut dots = screen.graphic().cloned().unwrap_or_default();
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let cell = screen.cell(row, column);
            if cell.character != '\0' {
                draw_cell(&mut dots, row, column, cell);
            }
        }
    }
    for text in screen.big_texts() {
        draw_big(&mut dots, text);
    }
    dots
}

fn draw_cell(dots: &mut Bitmap, row: usize, column: usize, cell: Cell) {
    let nothing = match cell.style {
        CellStyle::Big | CellStyle::Dark => true,
        CellStyle::Plain => cell.character == ' ',
        CellStyle::Inverse | CellStyle::Underline => false,
    };
    if nothing {
        return;
    }
    let glyph = glyphs::dots(cell.character);
    for (line, bits) in glyph.rows.into_iter().enumerate() {
        let bar = cell.style == CellStyle::Underline && BAR.contains(&line);
        let bits = if bar { u16::MAX } else { bits };
        let y = row * GLYPH_HEIGHT + line;
        let [left, right] = bits.to_be_bytes();
        let inverse = cell.style == CellStyle::Inverse;
        dots.combine(column, y, left, inverse);
        if glyph.columns == 2 {
            dots.combine(column + 1, y, right, inverse);
        }
    }
}

fn draw_big(dots: &mut Bitmap, text: &BigText) {
    let mut column = text.column;
    for character in text.text.chars() {
        let glyph = glyphs::dots(character);
        for (line, bits) in glyph.rows.into_iter().enumerate() {
            let wide = double(bits).to_be_bytes();
            for copy in 0..2 {
                let y = text.row * GLYPH_HEIGHT + 2 * line + copy;
                for (offset, byte) in wide.into_iter().take(2 * glyph.columns).enumerate() {
                    dots.combine(column + offset, y, byte, false);
                }
            }
        }
        column += 2 * glyph.columns;
    }
}

/// Returns the bits with each one doubled, for a double-size dot row.
fn double(bits: u16) -> u32 {
    (0..16)
        .filter(|bit| bits & (1 << bit) != 0)
        .fold(0, |wide, bit| wide | 0b11 << (2 * bit))
}

/// Returns the LCD's 320x240 picture as RGBA bytes, top row first. `brightness` is 0 to 15.
pub fn rgba(screen: &Screen, brightness: u8) -> Vec<u8> {
    let mut pixels = vec![0; RGBA_BYTES];
    let palette = palette(screen.colours(), brightness);
    paint_rgba(&bitmap(screen), palette, 1, &mut pixels);
    pixels
}

/// Returns the LCD's picture with `scale` (1 to 16) pixels a dot. `brightness` is 0 to 15.
///
/// `None` if the picture does not fit into memory.
pub fn render(screen: &Screen, scale: u32, brightness: u8) -> Option<Pixmap> {
    let scale = scale.clamp(1, MAX_SCALE);
    let mut pixmap = Pixmap::new(WIDTH as u32 * scale, HEIGHT as u32 * scale)?;
    paint_rgba(
        &bitmap(screen),
        palette(screen.colours(), brightness),
        scale as usize,
        pixmap.data_mut(),
    );
    Some(pixmap)
}

/// Paints the LCD's picture into another one, at any position and scale. `brightness` is 0 to
/// 15.
pub fn paint(screen: &Screen, brightness: u8, target: &mut PixmapMut, transform: Transform) {
    let Some(picture) = render(screen, 1, brightness) else {
        return;
    };
    let whole = transform.sx.fract() == 0.0 && transform.sy.fract() == 0.0;
    let paint = PixmapPaint {
        quality: if whole {
            FilterQuality::Nearest
        } else {
            FilterQuality::Bilinear
        },
        ..PixmapPaint::default()
    };
    target.draw_pixmap(0, 0, picture.as_ref(), &paint, transform, None);
}

/// Writes every dot to `pixels` (RGBA) as a square of `scale` pixels.
fn paint_rgba(dots: &Bitmap, palette: Palette, scale: usize, pixels: &mut [u8]) {
    let opaque = |[red, green, blue]: Rgb| [red, green, blue, u8::MAX];
    let colours = [opaque(palette.background), opaque(palette.text)];
    let line_bytes = WIDTH * scale * 4;
    for (y, band) in pixels.chunks_exact_mut(line_bytes * scale).enumerate() {
        let (first, copies) = band.split_at_mut(line_bytes);
        let bits = dots
            .row(y)
            .iter()
            .flat_map(|byte| (0..8).map(move |bit| byte >> (7 - bit) & 1));
        for (square, bit) in first.chunks_exact_mut(4 * scale).zip(bits) {
            for pixel in square.chunks_exact_mut(4) {
                pixel.copy_from_slice(&colours[usize::from(bit)]);
            }
        }
        for copy in copies.chunks_exact_mut(line_bytes) {
            copy.copy_from_slice(first);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_and_underline_change_only_their_cells() {
        let mut screen = Screen::new();
        screen.put_as(0, 1, " ", CellStyle::Inverse);
        screen.put_as(0, 3, " ", CellStyle::Underline);
        let dots = bitmap(&screen);
        let lit = |column: i32| {
            (0..16)
                .map(|y| i32::from(dots.get(column * 8, y)))
                .sum::<i32>()
        };
        assert_eq!([lit(0), lit(1), lit(2), lit(3), lit(4)], [0, 16, 0, 2, 0]);
    }

    #[test]
    fn big_text_is_the_glyph_at_double_size() {
        let mut screen = Screen::new();
        screen.put_big(3, 4, 4, "U");
        let dots = bitmap(&screen);
        let glyph = glyphs::dots('U');
        for y in 0..32 {
            for x in 0..16 {
                let expected = glyph.rows[y / 2] & (0x8000 >> (x / 2)) != 0;
                assert_eq!(dots.get(32 + x, 48 + y as i32), expected, "{x} {y}");
            }
        }
        assert!(screen.row(3).starts_with("    U  "));
    }

    #[test]
    fn a_larger_scale_repeats_the_dots() {
        let mut screen = Screen::new();
        screen.put(7, 7, "余");
        let small = rgba(&screen, 8);
        let large = render(&screen, 3, 8).unwrap();
        assert_eq!((large.width(), large.height()), (960, 720));
        for (x, y) in [(0, 0), (60, 113), (65, 118), (319, 239)] {
            let at = (y * WIDTH + x) * 4;
            let pixel = large.pixel(x as u32 * 3 + 2, y as u32 * 3 + 1).unwrap();
            assert_eq!(
                small[at..at + 3],
                [pixel.red(), pixel.green(), pixel.blue()]
            );
        }
    }

    #[test]
    fn every_brightness_step_is_brighter_and_the_darkest_stays_readable() {
        let sum = |colour: Rgb| colour.iter().map(|part| u32::from(*part)).sum::<u32>();
        let blue = |level| palette(LcdColours::BLUE, level);
        for level in 1..16 {
            assert!(sum(blue(level).background) > sum(blue(level - 1).background));
            assert!(sum(blue(level).text) > sum(blue(level - 1).text));
        }
        let dark = blue(0);
        assert!(sum(dark.text) > sum(dark.background) + 300);
        assert_eq!(blue(200), blue(15));
    }
    #[test]
    fn a_green_lcd_has_dark_text_at_every_brightness() {
        let sum = |colour: Rgb| colour.iter().map(|part| u32::from(*part)).sum::<u32>();
        for level in 0..16 {
            let green = palette(LcdColours::GREEN, level);
            assert!(sum(green.background) > sum(green.text) + 100, "{level}");
            assert!(
                green.background[1] > green.background[0]
                    && green.background[1] > green.background[2]
            );
        }
    }
}
