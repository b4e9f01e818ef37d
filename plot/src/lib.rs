//! Makes picture files in memory: the toolpath as PNG or SVG, the part as a solid, the LCD and
//! the panel as PNG.

mod animation;
mod block_labels;
mod canvas;
mod clip;
mod coverage;
mod dimensions;
mod drawing;
mod extent;
mod layout;
mod legend;
pub mod mill;
mod number_placement;
mod path_pieces;
mod pens;
mod png_file;
mod png_reader;
mod scenery;
pub mod setup_sheet;
pub mod solid;
mod solid_picture;
mod svg;
mod text_width;

use std::path::{Path, PathBuf};

use gsk_messages::{Language, Message, say};
use gsk_panel::emulator::Emulator;
use gsk_panel::raster;
use gsk_panel::screen::Screen;

pub use animation::encode_animation;
pub use drawing::{DrawingOptions, PathDrawing};
pub use extent::{InvalidPictureSize, PictureSize};
pub use png_reader::{DecodedPicture, decode_png};
pub use solid_picture::encode_solid;

/// Pixels per LCD dot, along each side, in a picture of the LCD.
const LCD_SCALE: u32 = 2;
/// Pixels per panel unit in a picture of the whole panel.
const PANEL_SCALE: f32 = 1.5;

/// The reason why a picture cannot be made.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum PictureError {
    /// The picture does not fit into memory.
    Memory,
    /// The PNG encoder failed with this error.
    Encoder(#[from] png::EncodingError),
}

impl PictureError {
    /// Returns the message that explains why the picture cannot be made.
    pub fn message(&self) -> Message {
        match self {
            Self::Memory => say::picture_too_large(),
            Self::Encoder(error) => say::as_written(error),
        }
    }
}

/// Error: the extension of this file name is not that of a picture format.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub struct UnknownPictureFormat(pub PathBuf);

impl UnknownPictureFormat {
    /// Returns the message for the user, which lists the valid extensions.
    pub fn message(&self) -> Message {
        say::picture_ending(self.0.display())
    }
}

/// The file format of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// PNG format: a picture of pixels.
    Png,
    /// SVG format: lines and texts as XML.
    Svg,
}

impl PictureFormat {
    /// The format for the extension of a file name, in upper or lower case.
    ///
    /// # Errors
    /// The extension is not png or svg.
    pub fn from_file_name(name: &Path) -> Result<Self, UnknownPictureFormat> {
        let ending = name
            .extension()
            .map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        match ending.as_deref() {
            Some("png") => Ok(Self::Png),
            Some("svg") => Ok(Self::Svg),
            _ => Err(UnknownPictureFormat(name.to_owned())),
        }
    }
}

/// Draws a toolpath as a picture file and returns the bytes of the file. `language` is that of
/// its texts.
///
/// # Errors
/// There is not enough memory.
pub fn encode(
    format: PictureFormat,
    drawing: &PathDrawing,
    language: Language,
) -> Result<Vec<u8>, PictureError> {
    match format {
        PictureFormat::Svg => Ok(svg::render(drawing, language).into_bytes()),
        PictureFormat::Png => png_file::render(drawing, language),
    }
}

/// Encodes the LCD as the bytes of a PNG file. `brightness` is the value of the control's
/// brightness page.
///
/// # Errors
/// There is not enough memory.
pub fn encode_lcd(screen: &Screen, brightness: u8) -> Result<Vec<u8>, PictureError> {
    let pixels = raster::render(screen, LCD_SCALE, brightness).ok_or(PictureError::Memory)?;
    png_file::encode(&pixels)
}

/// Encodes the whole panel as the bytes of a PNG file.
///
/// # Errors
/// There is not enough memory.
pub fn encode_panel(emulator: &Emulator) -> Result<Vec<u8>, PictureError> {
    let pixels = emulator.panel_picture(PANEL_SCALE);
    png_file::encode(&pixels.ok_or(PictureError::Memory)?)
}

/// The warning that the picture does not show the whole path; `None` if it does.
pub fn missing_moves_message(drawing: &PathDrawing) -> Option<Message> {
    let left_out = drawing.omitted_moves();
    (left_out > 0).then(|| say::picture_not_complete(left_out))
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::command::{ExecutedMove, MoveConditions, MoveKind, ProgramId, SourcePosition};
    use gsk_core::units::Point;
    use gsk_runner::curves::RapidRates;

    const RATES: RapidRates = RapidRates {
        x: 1.0,
        z: 1.0,
        straight: false,
    };

    fn executed(kind: MoveKind, from: Point, to: Point) -> ExecutedMove {
        ExecutedMove {
            source: SourcePosition {
                program: ProgramId::External,
                line: 1,
                sequence: Some(30.into()),
            },
            kind,
            from,
            to,
            center: None,
            feed: None,
            start_s: 0.0,
            duration_s: 63.5,
            conditions: MoveConditions {
                tool: 2,
                offset: 12,
                ..MoveConditions::default()
            },
        }
    }

    #[test]
    fn both_kinds_of_picture_are_made() {
        let labels = DrawingOptions {
            labels: true,
            ..DrawingOptions::default()
        };
        let mut drawing = PathDrawing::new("O0001 轴", labels);
        let (near, end) = (Point::new(25.0, 0.0), Point::new(25.0, -40.0));
        drawing.add_move(&executed(MoveKind::Feed, near, end), RATES);
        drawing.add_move(&executed(MoveKind::Rapid, end, near), RATES);
        drawing.end(130.0);
        let svg = svg::render(&drawing, Language::Zh);
        for part in [
            "<svg",
            "polyline",
            "O0001 轴",
            "T0212 1:03.5",
            "快速",
            "2:10.0",
            ">N30<",
        ] {
            assert!(svg.contains(part), "{part} {svg}");
        }
        let png = png_file::render(&drawing, Language::En).expect("picture");
        assert!(png.starts_with(b"\x89PNG"));
        let empty = PathDrawing::new("<&>\u{1b}\u{0}", DrawingOptions::default());
        let svg = svg::render(&empty, Language::En);
        assert!(svg.contains("&lt;&amp;&gt;\u{fffd}\u{fffd}<"));
        assert!(png_file::render(&empty, Language::En).is_ok());
    }

    #[test]
    fn rapids_end_at_the_frame() {
        let mut drawing = PathDrawing::new("", DrawingOptions::default());
        let (near, far) = (Point::new(25.0, 0.0), Point::new(25.0, 1e6));
        drawing.add_move(
            &executed(MoveKind::Feed, near, Point::new(25.0, -40.0)),
            RATES,
        );
        drawing.add_move(&executed(MoveKind::Rapid, near, far), RATES);
        let svg = svg::render(&drawing, Language::En);
        let points = svg.split("points=\"").skip(1);
        let furthest = points
            .filter_map(|rest| rest.split('"').next())
            .flat_map(|points| points.split([' ', ',']))
            .filter_map(|value| value.parse::<f64>().ok())
            .fold(0.0, f64::max);
        assert!((1000.0..=1280.0).contains(&furthest), "{furthest}");
    }
}
