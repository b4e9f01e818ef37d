//! The log of the program on the disk.

use std::io;
use std::path::Path;

use tracing_appender::non_blocking::NonBlocking;
pub use tracing_appender::non_blocking::WorkerGuard as LogGuard;
use tracing_appender::rolling::{RollingFileAppender, Rotation};

/// A log that a thread of its own writes.
pub type LogFile = NonBlocking;

/// A file a day in a folder, so many of them, the oldest go. Dropped, the second value
/// has written what waits.
///
/// # Errors
/// What the system says.
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
