//! The file of the log on the disk.

use std::io;
use std::path::Path;

use tracing_appender::non_blocking::NonBlocking;
pub use tracing_appender::non_blocking::WorkerGuard as LogGuard;
use tracing_appender::rolling::{RollingFileAppender, Rotation};

/// A log file that a separate thread writes.
pub type LogFile = NonBlocking;

/// Opens a log with one file per day in a folder, and deletes the oldest files above `most`.
/// Dropping the guard writes the waiting lines.
///
/// # Errors
/// An error of the system.
pub fn log_file(folder: &Path, most: usize) -> io::Result<(LogFile, LogGuard)> {
    std::fs::create_dir_all(folder)?;
    let files = RollingFileAppender::builder()
        .rotation(Rotation::DAILY)
        .filename_prefix("gsk980td")
        .filename_suffix("log")
        .max_log_files(most)
        .build(folder)
        .map_err(io::Error::other)?;
    Ok(tracing_appender::non_blocking(files))
}
