//! Checks the file names of pictures before they are written.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use gsk_messages::{Message, say};
use gsk_plot::{PictureFormat, UnknownPictureFormat};

/// The reason why a picture cannot be written to a path.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum PictureNameError {
    /// The file extension is not that of a picture format.
    Ending(#[from] UnknownPictureFormat),
    /// The file extension of this path is not `.png`.
    NotPng(PathBuf),
    /// A solid view can only be written as a PNG, because it consists of pixels.
    SolidNotPng(PathBuf),
    /// The existing file at this path is not a picture and is kept.
    NotOverwritten(PathBuf),
}

impl PictureNameError {
    /// Returns the message for the operator: why the picture cannot be written to the path.
    pub fn message(&self) -> Message {
        match self {
            Self::Ending(error) => error.message(),
            Self::NotPng(path) => say::picture_ending_png(path.display()),
            Self::SolidNotPng(path) => say::picture_solid_png(path.display()),
            Self::NotOverwritten(path) => say::picture_not_overwritten(path.display()),
        }
    }
}

/// The bytes with which every PNG file begins.
const PNG_SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Checks that a PNG may be written under this name: it ends in `.png`, links followed,
/// and an existing file is a picture.
///
/// # Errors
/// The extension or the existing file forbids it; the message has the name.
pub fn check_png(path: &Path) -> Result<(), PictureNameError> {
    let target = path.canonicalize();
    let named = |path: &Path| matches!(PictureFormat::from_file_name(path), Ok(PictureFormat::Png));
    if !named(path) || !target.as_ref().map_or(true, |target| named(target)) {
        return Err(PictureNameError::NotPng(path.to_owned()));
    }
    let mut head = Vec::new();
    if path.is_file()
        && let Ok(file) = File::open(path)
        && file
            .take(PNG_SIGNATURE.len() as u64)
            .read_to_end(&mut head)
            .is_ok()
        && !head.is_empty()
        && head != PNG_SIGNATURE
    {
        return Err(PictureNameError::NotOverwritten(path.to_owned()));
    }
    Ok(())
}

/// Checks that a PNG or SVG may be written under this name.
///
/// # Errors
/// The extension or the existing file forbids it; the message has the name.
pub fn check_name(path: &Path) -> Result<(), PictureNameError> {
    match (PictureFormat::from_file_name(path)?, path.canonicalize()) {
        (PictureFormat::Png, _) => check_png(path),
        // The target of a link must be a picture, too.
        (PictureFormat::Svg, Ok(target)) => {
            PictureFormat::from_file_name(&target)?;
            Ok(())
        }
        (PictureFormat::Svg, Err(_)) => Ok(()),
    }
}
