//! Reads a PNG file.

use std::io::Cursor;

use png::{ColorType, Decoder, Limits, Transformations};

/// Greatest width and height of a picture that is read, pixels.
const MAX_SIDE: u32 = 8192;
/// Greatest size in memory of a picture that is read, bytes.
const MAX_BYTES: usize = 128 * 1024 * 1024;

/// A picture that was read from a PNG file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DecodedPicture {
    /// Width and height of the picture, pixels.
    pub size: [usize; 2],
    /// Red, green, blue and opacity of each pixel, row by row; the colours are not premultiplied.
    pub rgba: Vec<u8>,
}

/// Reads a PNG file; `None` if it is none, is damaged or is too large.
pub fn decode_png(bytes: &[u8]) -> Option<DecodedPicture> {
    let limits = Limits { bytes: MAX_BYTES };
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_transformations(Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().ok()?;
    if reader.info().width > MAX_SIDE || reader.info().height > MAX_SIDE {
        return None;
    }
    let needed = reader.output_buffer_size();
    let mut pixels = vec![0; needed.filter(|needed| *needed <= MAX_BYTES)?];
    let frame = reader.next_frame(&mut pixels).ok()?;
    pixels.truncate(frame.buffer_size());
    let rgba = match frame.color_type {
        ColorType::Rgba => pixels,
        ColorType::Rgb => expand::<3>(&pixels, |[r, g, b]| [r, g, b, 255]),
        ColorType::GrayscaleAlpha => expand::<2>(&pixels, |[grey, a]| [grey, grey, grey, a]),
        ColorType::Grayscale => expand::<1>(&pixels, |[grey]| [grey, grey, grey, 255]),
        ColorType::Indexed => return None,
    };
    let size = [frame.width as usize, frame.height as usize];
    (rgba.len() == size[0] * size[1] * 4).then_some(DecodedPicture { size, rgba })
}

fn expand<const N: usize>(pixels: &[u8], to_rgba: impl Fn([u8; N]) -> [u8; 4]) -> Vec<u8> {
    let (pixels, _) = pixels.as_chunks::<N>();
    pixels.iter().flat_map(|pixel| to_rgba(*pixel)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encode(color: ColorType, pixels: &[u8], width: u32) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, 1);
        encoder.set_color(color);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header().expect("a head");
        writer.write_image_data(pixels).expect("pixels");
        writer.finish().expect("an end");
        bytes
    }

    #[test]
    fn pictures_of_every_kind_become_colours_with_opacity() {
        let read = |color, pixels: &[u8]| decode_png(&encode(color, pixels, 1)).expect("a picture");
        assert_eq!(read(ColorType::Rgba, &[1, 2, 3, 4]).rgba, [1, 2, 3, 4]);
        assert_eq!(read(ColorType::Rgb, &[1, 2, 3]).rgba, [1, 2, 3, 255]);
        assert_eq!(read(ColorType::GrayscaleAlpha, &[9, 8]).rgba, [9, 9, 9, 8]);
        let grey = decode_png(&encode(ColorType::Grayscale, &[7, 6], 2)).expect("a picture");
        assert_eq!((grey.size, grey.rgba.len()), ([2, 1], 8));
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        let whole = encode(ColorType::Rgb, &[1, 2, 3], 1);
        for length in 0..whole.len() - 16 {
            assert_eq!(decode_png(&whole[..length]), None, "{length} bytes");
        }
        assert_eq!(decode_png(b"<svg/>"), None);
        let wide = vec![0; MAX_SIDE as usize + 1];
        let wide = encode(ColorType::Grayscale, &wide, MAX_SIDE + 1);
        assert_eq!(decode_png(&wide), None);
    }
}
