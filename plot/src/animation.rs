//! Writes pictures as an animated PNG.

use crate::{PictureError, PictureSize};

/// Encodes pictures of one size as an animation that repeats. `draw` returns red, green, blue
/// and opacity of each pixel of a picture, row by row from above. `interval_ms`: time from one
/// picture to the next.
///
/// # Errors
/// The encoder refuses a picture, because `draw` returns another number of pixels.
pub fn encode_animation(
    size: PictureSize,
    count: u32,
    interval_ms: u16,
    mut draw: impl FnMut(u32) -> Vec<u8>,
) -> Result<Vec<u8>, PictureError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size.width(), size.height());
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    if count > 1 {
        encoder.set_animated(count, 0)?;
        encoder.set_frame_delay(interval_ms, 1000)?;
    }
    let mut writer = encoder.write_header()?;
    for picture in 0..count.max(1) {
        writer.write_image_data(&draw(picture))?;
    }
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reader_finds_all_pictures_and_their_interval() {
        let size: PictureSize = "480x320".parse().unwrap();
        let draw = |picture: u32| vec![picture as u8 * 40; 480 * 320 * 4];
        let bytes = encode_animation(size, 3, 80, draw).unwrap();
        let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info();
        let mut reader = reader.unwrap();
        let control = reader.info().animation_control.unwrap();
        assert_eq!((control.num_frames, control.num_plays), (3, 0));
        for picture in 0..3 {
            let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut pixels).unwrap();
            assert!(pixels.iter().all(|it| *it == picture * 40));
            let frame = reader.info().frame_control.unwrap();
            assert_eq!((frame.delay_num, frame.delay_den), (80, 1000));
        }
    }
}
