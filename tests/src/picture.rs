//! The LCD as a picture of two colours, two pixels a dot, as stored in a case.

use gsk_panel::raster::{self, Palette};
use gsk_panel::screen::{HEIGHT, Screen, WIDTH};
use png::{BitDepth, ColorType, Compression, Decoder, Encoder};

/// Width and height of a dot in the picture, pixels.
const DOT_PIXELS: usize = 2;

/// Returns the pixels of the LCD, one bit each, in rows of whole bytes.
fn pack_pixels(screen: &Screen) -> Vec<u8> {
    let dots = raster::bitmap(screen);
    let mut pixels = Vec::with_capacity(WIDTH * HEIGHT * DOT_PIXELS * DOT_PIXELS / 8);
    for y in 0..HEIGHT {
        let row: Vec<u8> = dots
            .row(y)
            .iter()
            .flat_map(|byte| double_bits(*byte))
            .collect();
        for _ in 0..DOT_PIXELS {
            pixels.extend_from_slice(&row);
        }
    }
    pixels
}

/// Returns a byte with each bit doubled, as two bytes.
fn double_bits(byte: u8) -> [u8; 2] {
    let wide = (0..8)
        .filter(|bit| byte >> bit & 1 == 1)
        .fold(0u16, |wide, bit| wide | 0b11 << (2 * bit));
    wide.to_be_bytes()
}

fn palette_bytes(palette: Palette) -> Vec<u8> {
    [palette.background, palette.text].concat()
}

/// Returns the picture of the LCD as the bytes of a PNG file.
///
/// # Errors
/// Returns the error of the PNG encoder.
pub(crate) fn encode(screen: &Screen, brightness: u8) -> Result<Vec<u8>, String> {
    let mut file = Vec::new();
    let (width, height) = ((WIDTH * DOT_PIXELS) as u32, (HEIGHT * DOT_PIXELS) as u32);
    let mut encoder = Encoder::new(&mut file, width, height);
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::One);
    encoder.set_palette(palette_bytes(raster::palette(screen.colours(), brightness)));
    encoder.set_compression(Compression::High);
    let mut writer = encoder.write_header().map_err(|error| error.to_string())?;
    writer
        .write_image_data(&pack_pixels(screen))
        .map_err(|error| error.to_string())?;
    writer.finish().map_err(|error| error.to_string())?;
    Ok(file)
}

/// Returns whether a PNG file shows this screen at this brightness (0 to 15), with the same
/// dots and colours.
pub(crate) fn is_same_picture(file: &[u8], screen: &Screen, brightness: u8) -> bool {
    decode(file).is_some_and(|(palette, stored)| {
        palette == palette_bytes(raster::palette(screen.colours(), brightness))
            && stored == pack_pixels(screen)
    })
}

/// Returns palette and pixels of a PNG file; `None` if it cannot be decoded.
fn decode(file: &[u8]) -> Option<(Vec<u8>, Vec<u8>)> {
    let mut reader = Decoder::new(std::io::Cursor::new(file)).read_info().ok()?;
    let mut pixels = vec![0; reader.output_buffer_size()?];
    reader.next_frame(&mut pixels).ok()?;
    let palette = reader.info().palette.as_ref()?.to_vec();
    Some((palette, pixels))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_read_as_it_was_written() {
        let mut screen = Screen::new();
        screen.put(3, 7, "余移动量 U");
        let file = encode(&screen, 8).unwrap_or_default();
        assert!(is_same_picture(&file, &screen, 8));
        assert!(!is_same_picture(&file, &screen, 9));
        screen.put(14, 39, ".");
        assert!(!is_same_picture(&file, &screen, 8));
        assert!(!is_same_picture(b"no picture", &screen, 8));
    }
}
