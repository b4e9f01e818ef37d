//! Checks the file names of pictures before they are written.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use gsk_messages::{Message, say};
use gsk_runner::picture::{Format, NoPicture};

/// Why a picture cannot be written under a name.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum NameError {
    /// The extension is not that of a picture.
    Ending(#[from] NoPicture),
    /// The extension is not that of a PNG.
    NoPng(PathBuf),
    /// A solid view is made of pixels, not of lines.
    NoLines(PathBuf),
    /// The existing file is not a picture.
    NotOverwritten(PathBuf),
}

impl NameError {
    /// Returns the message for the operator.
    pub fn message(&self) -> Message {
        match self {
            Self::Ending(error) => error.message(),
            Self::NoPng(path) => say::picture_ending_png(path.display()),
            Self::NoLines(path) => say::picture_solid_png(path.display()),
            Self::NotOverwritten(path) => say::picture_not_overwritten(path.display()),
        }
    }
}

/// First bytes of every PNG file.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Checks that a PNG may be written under this name: it ends in `.png`, links followed,
/// and an existing file is a picture.
///
/// # Errors
/// The extension or the existing file forbids it; the message has the name.
pub fn check_png(path: &Path) -> Result<(), NameError> {
    let target = path.canonicalize();
    let named = |path: &Path| matches!(Format::of(path), Ok(Format::Png));
    if !named(path) || !target.as_ref().map_or(true, |target| named(target)) {
        return Err(NameError::NoPng(path.to_owned()));
    }
    let mut head = Vec::new();
    if path.is_file()
        && let Ok(file) = File::open(path)
        && file.take(PNG.len() as u64).read_to_end(&mut head).is_ok()
        && !head.is_empty()
        && head != PNG
    {
        return Err(NameError::NotOverwritten(path.to_owned()));
    }
    Ok(())
}

/// Checks that a PNG or SVG may be written under this name.
///
/// # Errors
/// The extension or the existing file forbids it; the message has the name.
pub fn check_name(path: &Path) -> Result<(), NameError> {
    match (Format::of(path)?, path.canonicalize()) {
        (Format::Png, _) => check_png(path),
        // The target of a link must be a picture, too.
        (Format::Svg, Ok(target)) => {
            Format::of(&target)?;
            Ok(())
        }
        (Format::Svg, Err(_)) => Ok(()),
    }
}
