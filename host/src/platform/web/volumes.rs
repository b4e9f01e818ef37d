//! Drives of other devices: a page in a browser reaches none.

use std::io;
use std::path::{Path, PathBuf};

/// Returns the folders of all mounted drives: none.
pub const fn mounted_volumes() -> Vec<PathBuf> {
    Vec::new()
}

/// Writes a file to a drive.
///
/// # Errors
/// Always: a page has no drives.
pub fn write_to_drive(_path: &Path, _bytes: &[u8], _mark: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}
