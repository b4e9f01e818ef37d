//! The log of the program, for finding faults afterwards, in English. The window writes
//! one file a day; commands write to standard error on request.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use gsk_messages::{Message, say};
use tracing::level_filters::LevelFilter;
use tracing::{Subscriber, error, info, subscriber};
use tracing_subscriber::Layer;
use tracing_subscriber::filter::Targets;
use tracing_subscriber::fmt::{self, MakeWriter};
use tracing_subscriber::layer::SubscriberExt;

use crate::message_format::describe_io_error;
use crate::platform::{LogFile, LogGuard, log_file};
use crate::setup_args::OptionValueError;

/// Name of the folder for log files in the data directory.
pub const FOLDER: &str = "log";
/// Number of log files that are kept.
const MAX_FILES: usize = 14;
/// Prefix of the log targets of this program; events of libraries are dropped.
const OWN_TARGET: &str = "gsk";

/// Names of the log levels with their filters, from none to all events.
pub const LEVELS: [(&str, LevelFilter); 6] = [
    ("off", LevelFilter::OFF),
    ("error", LevelFilter::ERROR),
    ("warn", LevelFilter::WARN),
    ("info", LevelFilter::INFO),
    ("debug", LevelFilter::DEBUG),
    ("trace", LevelFilter::TRACE),
];

/// Parses the name of a log level.
///
/// # Errors
/// The word is no level.
pub fn parse_level(word: &str) -> Result<LevelFilter, OptionValueError> {
    let found = LEVELS.iter().find(|(name, _)| *name == word);
    let found = found.map(|(_, level)| *level);
    found.ok_or_else(|| OptionValueError::UnknownLogLevel(word.to_owned()))
}

/// Error: the log folder cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub struct LogError {
    /// The folder that cannot be created or written.
    folder: PathBuf,
    /// Error of the operating system.
    cause: io::Error,
}

impl LogError {
    /// Returns the message for the operator: the log folder and the reason.
    pub fn message(&self) -> Message {
        say::log_not_written(self.folder.display(), describe_io_error(&self.cause))
    }
}

/// Guard of the thread that writes the log file; dropping it writes the waiting lines.
static WRITER: Mutex<Option<LogGuard>> = Mutex::new(None);

/// A running log; the log ends when it is dropped.
#[must_use]
#[derive(Debug)]
pub struct RunningLog(());

impl Drop for RunningLog {
    fn drop(&mut self) {
        finish();
    }
}

/// Logs the end of the program and writes the waiting lines; for exits that drop no values.
pub fn finish() {
    info!("ended");
    if let Ok(mut writer) = WRITER.lock() {
        writer.take();
    }
}

/// Starts the log in today's file of a data directory; a separate thread writes it.
/// `None`: the level is off.
///
/// # Errors
/// The folder cannot be written.
pub fn start_in_data_dir(data: &Path, level: LevelFilter) -> Result<Option<RunningLog>, LogError> {
    if level == LevelFilter::OFF {
        return Ok(None);
    }
    let (writer, guard) = open_log_file(&data.join(FOLDER))?;
    if let Ok(mut writer) = WRITER.lock() {
        *writer = Some(guard);
    }
    install(subscriber(writer, level));
    log_start(Some(data));
    Ok(Some(RunningLog(())))
}

/// Starts the log on standard error. `None`: the level is off.
pub fn start_on_terminal(level: LevelFilter) -> Option<RunningLog> {
    if level == LevelFilter::OFF {
        return None;
    }
    install(subscriber(io::stderr, level));
    log_start(None);
    Some(RunningLog(()))
}

/// Opens one file a day and deletes the oldest ones. Returns an error if the folder cannot be
/// written.
fn open_log_file(folder: &Path) -> Result<(LogFile, LogGuard), LogError> {
    log_file(folder, MAX_FILES).map_err(|cause| LogError {
        folder: folder.to_owned(),
        cause,
    })
}

fn subscriber(
    writer: impl for<'a> MakeWriter<'a> + Send + Sync + 'static,
    level: LevelFilter,
) -> impl Subscriber + Send + Sync {
    let lines = fmt::layer().with_ansi(false).with_writer(writer);
    let own = Targets::new().with_target(OWN_TARGET, level);
    tracing_subscriber::registry().with(lines.with_filter(own))
}

fn install(subscriber: impl Subscriber + Send + Sync) {
    // Only the first log of a process takes effect.
    let _ = subscriber::set_global_default(subscriber);
    let before = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let thread = std::thread::current();
        error!(thread = thread.name().unwrap_or("-"), "panic: {panic}");
        before(panic);
    }));
}

fn log_start(data: Option<&Path>) {
    let data = data.map_or_else(|| "-".to_owned(), |data| data.display().to_string());
    info!(
        version = env!("CARGO_PKG_VERSION"),
        platform = format_args!("{}-{}", std::env::consts::OS, std::env::consts::ARCH),
        data,
        "started"
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_tests::test_folder;

    #[test]
    fn a_run_leaves_a_file_that_begins_with_its_start() {
        let data = test_folder("log");
        let (writer, guard) = open_log_file(&data.join(FOLDER)).expect("a log");
        subscriber::with_default(subscriber(writer, LevelFilter::INFO), || {
            log_start(Some(&data));
            tracing::debug!("not at this level");
            tracing::error!(target: "winit", "not of this program");
        });
        drop(guard);
        let mut files = std::fs::read_dir(data.join(FOLDER)).expect("folder");
        let file = files.next().expect("a file").expect("a file").path();
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        assert!(name.starts_with("gsk980td.") && name.ends_with(".log"));
        let text = std::fs::read_to_string(&file).expect("text");
        let version = format!("version=\"{}\"", env!("CARGO_PKG_VERSION"));
        assert!(
            text.contains("started") && text.contains(&version),
            "{text}"
        );
        assert_eq!(text.lines().count(), 1, "{text}");
    }

    #[test]
    fn levels_are_words() {
        assert_eq!(parse_level("off"), Ok(LevelFilter::OFF));
        let refused = parse_level("loud").expect_err("no level");
        assert!(refused.to_string().starts_with("`loud` is not a log level"));
    }
}
