//! Pictures as bytes of a file: the toolpath as PNG or SVG, the LCD and the panel as PNG.

mod drawing;
mod extent;
mod layout;
mod png_file;
mod svg;

use std::path::{Path, PathBuf};

use gsk_messages::{Message, say};
use gsk_panel::emulator::Emulator;
use gsk_panel::raster;
use gsk_panel::screen::Screen;

pub use drawing::{Drawing, RapidRates};
pub use extent::{HEIGHT, WIDTH};

/// Pixels of an LCD dot in a picture of the LCD.
const LCD_SCALE: u32 = 2;
/// Pixels of a panel unit in a picture of the whole panel.
const PANEL_SCALE: f32 = 1.5;

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum PictureError {
    /// It is too large for the memory.
    Memory,
    /// The encoder refuses it.
    Encoder(#[from] png::EncodingError),
}

impl PictureError {
    /// What is said of it.
    pub fn message(&self) -> Message {
        match self {
            Self::Memory => say::picture_too_large(),
            Self::Encoder(error) => say::as_written(error),
        }
    }
}

/// A name whose ending is none of a picture.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub struct NoPicture(pub PathBuf);

impl NoPicture {
    /// What is said of it.
    pub fn message(&self) -> Message {
        say::picture_ending(self.0.display())
    }
}

/// What kind of file a picture is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Pixels.
    Png,
    /// Lines, as text.
    Svg,
}

impl Format {
    /// By the ending of a name.
    ///
    /// # Errors
    /// It is another one.
    pub fn of(name: &Path) -> Result<Self, NoPicture> {
        let ending = name
            .extension()
            .map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        match ending.as_deref() {
            Some("png") => Ok(Self::Png),
            Some("svg") => Ok(Self::Svg),
            _ => Err(NoPicture(name.to_owned())),
        }
    }
}

/// The bytes of a picture file.
///
/// # Errors
/// There is no memory for it.
pub fn encode(format: Format, drawing: &Drawing) -> Result<Vec<u8>, PictureError> {
    match format {
        Format::Svg => Ok(svg::render(drawing).into_bytes()),
        Format::Png => png_file::render(drawing),
    }
}

/// The LCD as the bytes of a PNG file, at a brightness of its page.
///
/// # Errors
/// There is no memory for it.
pub fn of_lcd(screen: &Screen, brightness: u8) -> Result<Vec<u8>, PictureError> {
    let pixels = raster::render(screen, LCD_SCALE, brightness).ok_or(PictureError::Memory)?;
    png_file::encode(&pixels)
}

/// The whole panel as the bytes of a PNG file.
///
/// # Errors
/// There is no memory for it.
pub(crate) fn of_panel(emulator: &Emulator) -> Result<Vec<u8>, PictureError> {
    let pixels = emulator.panel_picture(PANEL_SCALE);
    png_file::encode(&pixels.ok_or(PictureError::Memory)?)
}

/// What has to be said of a picture that does not show the whole path.
pub fn shortfall(drawing: &Drawing) -> Option<Message> {
    let left_out = drawing.left_out();
    (left_out > 0).then(|| say::picture_not_complete(left_out))
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::command::{Conditions, ExecutedMove, MoveKind, ProgramId, Source};
    use gsk_core::units::Point;

    #[test]
    fn both_kinds_of_picture_are_made() {
        let mut drawing = Drawing::new("O0001 轴");
        drawing.push(
            &ExecutedMove {
                source: Source {
                    program: ProgramId::External,
                    line: 1,
                    sequence: None,
                },
                kind: MoveKind::Feed,
                from: Point::new(25.0, 0.0),
                to: Point::new(25.0, -40.0),
                center: None,
                feed: None,
                start_s: 0.0,
                duration_s: 1.0,
                conditions: Conditions::default(),
            },
            RapidRates { x: 1.0, z: 1.0 },
        );
        let svg = svg::render(&drawing);
        assert!(svg.starts_with("<svg") && svg.contains("polyline") && svg.contains("O0001 轴"));
        let png = png_file::render(&drawing).expect("picture");
        assert!(png.starts_with(b"\x89PNG"));
        let empty = Drawing::new("<&>\u{1b}\u{0}");
        assert!(svg::render(&empty).contains("&lt;&amp;&gt;\u{fffd}\u{fffd}<"));
        assert!(png_file::render(&empty).is_ok());
    }
}
