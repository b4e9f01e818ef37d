//! Files of pictures: under which names one may be written.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use gsk_messages::{Message, say};
use gsk_runner::picture::{Format, NoPicture};

/// Why no picture may be written under a name.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum NameError {
    /// Its ending is none of a picture.
    Ending(#[from] NoPicture),
    /// Its ending is another one than that of a PNG.
    NoPng(PathBuf),
    /// A solid is made of pixels.
    NoLines(PathBuf),
    /// What stands there is something else.
    NotOverwritten(PathBuf),
}

impl NameError {
    /// What is said of it.
    pub fn message(&self) -> Message {
        match self {
            Self::Ending(error) => error.message(),
            Self::NoPng(path) => say::picture_ending_png(path.display()),
            Self::NoLines(path) => say::picture_solid_png(path.display()),
            Self::NotOverwritten(path) => say::picture_not_overwritten(path.display()),
        }
    }
}

/// What every PNG file begins with.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Whether a PNG may be written under this name: it ends in `.png`, behind links too,
/// and what stands there is a picture or nothing.
///
/// # Errors
/// A sentence with the name.
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

/// Whether a name can become a picture.
///
/// # Errors
/// A sentence with the name.
pub fn check_name(path: &Path) -> Result<(), NameError> {
    match (Format::of(path)?, path.canonicalize()) {
        (Format::Png, _) => check_png(path),
        // What a link leads to is a drawing as well.
        (Format::Svg, Ok(target)) => {
            Format::of(&target)?;
            Ok(())
        }
        (Format::Svg, Err(_)) => Ok(()),
    }
}
