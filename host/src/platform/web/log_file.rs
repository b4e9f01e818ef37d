//! The file of the log: a page has none.

use std::io::{self, ErrorKind, Sink};
use std::path::Path;

/// The log file of a page: a writer that discards all lines.
pub type LogFile = fn() -> Sink;
/// The guard of a log that has no waiting lines.
pub type LogGuard = ();

/// Does not open a log, because a page has no files.
///
/// # Errors
///
/// Always returns an error.
pub fn log_file(_folder: &Path, _most: usize) -> io::Result<(LogFile, LogGuard)> {
    Err(ErrorKind::Unsupported.into())
}
