//! Writes results to files, standard output and standard error, and shows progress.
//!
//! A full or closed stream never ends the process: `print!` and `eprintln!` would panic, and
//! edited data would be lost.

use std::borrow::Cow;
use std::fmt;
use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use gsk_core::preview::PreviewProgress;
use gsk_core::program::ProgramMemory;
use gsk_messages::{Message, say};
use gsk_runner::Language;
use gsk_runner::report::ProgramReport;
use gsk_runner::text_format::format_time;
use indicatif::{ProgressBar, ProgressStyle};
use web_time::{Duration, Instant};

use crate::message_format::describe_io_error;
use crate::platform;
use crate::preview::work_limit::WorkLimit;

/// The error for a file that cannot be written, with its path.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub struct WriteError {
    path: PathBuf,
    error: io::Error,
}

impl WriteError {
    pub fn new(path: &Path, error: io::Error) -> Self {
        let path = path.to_owned();
        Self { path, error }
    }

    pub fn message(&self) -> Message {
        say::file_not_written(self.path.display(), describe_io_error(&self.error))
    }
}

/// Size of the write buffers for standard output and error, bytes.
const BUFFER_BYTES: usize = 64 * 1024;

/// Opens a file to write into, replacing its contents; `-` is standard output. Returns an error if
/// it cannot be created.
pub fn open(path: &Path) -> Result<Box<dyn Write>, WriteError> {
    if path.as_os_str() == "-" {
        return Ok(Box::new(BufWriter::with_capacity(
            BUFFER_BYTES,
            io::stdout().lock(),
        )));
    }
    let file = platform::refuse_device(path).and_then(|()| File::create(path));
    let file = file.map_err(|error| WriteError::new(path, error))?;
    Ok(Box::new(BufWriter::with_capacity(BUFFER_BYTES, file)))
}

/// Whether the path is `-`, the name of standard output.
pub fn is_standard_output(path: Option<&Path>) -> bool {
    path.is_some_and(|path| path.as_os_str() == "-")
}

/// Escapes a text for a terminal: control characters and characters that change the writing
/// direction become `\uXXXX`, which JSON can read, too.
pub fn escape_for_terminal(text: &str) -> Cow<'_, str> {
    let must_escape = |letter: char| {
        let changes_direction = matches!(letter, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
        changes_direction || (letter.is_control() && !matches!(letter, '\n' | '\t'))
    };
    // Most texts are ASCII, whose bytes are checked faster.
    let is_plain = |byte: u8| matches!(byte, b' '..=b'~' | b'\n' | b'\t');
    if text.bytes().all(is_plain) || !text.contains(must_escape) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        if must_escape(letter) {
            out.push_str(&format!("\\u{:04x}", u32::from(letter)));
        } else {
            out.push(letter);
        }
    }
    Cow::Owned(out)
}

/// A file that is opened at the start of a command and written at its end: an error shows
/// before the work begins. The old contents remain until then.
pub struct ReservedFile {
    file: File,
    path: PathBuf,
}

/// Opens a file that is written at the end of a command.
///
/// # Errors
/// The file cannot be opened for writing.
pub fn reserve_file(path: &Path) -> Result<ReservedFile, WriteError> {
    let mut options = OpenOptions::new();
    options.create(true).truncate(false).write(true);
    let opened = platform::refuse_device(path).and_then(|()| options.open(path));
    let file = opened.map_err(|error| WriteError::new(path, error))?;
    Ok(ReservedFile {
        file,
        path: path.to_owned(),
    })
}

impl ReservedFile {
    /// Replaces the contents of the file.
    ///
    /// # Errors
    /// The bytes cannot be written.
    pub fn write(mut self, bytes: &[u8]) -> Result<(), WriteError> {
        // Pipes and terminals have no length to set.
        let _ = self.file.set_len(0);
        let result = self.file.write_all(bytes);
        result.map_err(|error| WriteError::new(&self.path, error))
    }
}

/// The first error of standard output; after it nothing more is written there. Empty if the
/// reader has closed the pipe.
static STDOUT_ERROR: OnceLock<String> = OnceLock::new();

/// Writes to standard output. A closed pipe (`| head`) ends the output but not the program.
/// So does a full disk; [`stdout_error`] reports it at the end.
pub fn print(text: &str) {
    if STDOUT_ERROR.get().is_some() {
        return;
    }
    let mut out = io::stdout().lock();
    if let Err(error) = out
        .write_all(escape_for_terminal(text).as_bytes())
        .and_then(|()| out.flush())
    {
        let text = match error.kind() {
            io::ErrorKind::BrokenPipe => String::new(),
            _ => error.to_string(),
        };
        // Another thread may have stored its error first.
        let _ = STDOUT_ERROR.set(text);
    }
}

/// The error that ended standard output; `None` if all was written or the reader closed the
/// pipe.
pub fn stdout_error() -> Option<&'static str> {
    let error = STDOUT_ERROR.get()?;
    (!error.is_empty()).then_some(error.as_str())
}

/// The language of the messages of this module, set once from the command line.
static LANGUAGE: OnceLock<Language> = OnceLock::new();

/// Sets the language of all later messages; the default is English.
pub fn set_language(language: Language) {
    // Each process parses one command line.
    let _ = LANGUAGE.set(language);
}

/// The text of a message in the language of the command line.
pub fn localize(message: &Message) -> String {
    message.text(language())
}

/// Returns the language of messages on the command line.
pub fn language() -> Language {
    LANGUAGE.get().copied().unwrap_or(Language::En)
}

/// Writes a message and a newline to standard output.
pub fn print_message(message: &Message) {
    print(&format!("{}\n", localize(message)));
}

/// Writes a message to standard error, after the name of the program.
pub fn report_error(message: &Message) {
    complain(format_args!("gsk980td: {}", localize(message)));
}

/// Writes a line to standard error. Errors of the stream are ignored: there is no other
/// place to report them.
pub fn complain(text: fmt::Arguments<'_>) {
    let _ = writeln!(
        io::stderr().lock(),
        "{}",
        escape_for_terminal(&text.to_string())
    );
}

/// Writes a line to standard error like `eprintln!`, but does not panic if the stream fails.
#[macro_export]
macro_rules! complain {
    ($($text:tt)*) => {
        $crate::output::complain(format_args!($($text)*))
    };
}

/// Prints a report, as one JSON object or in words. `to_stderr` selects standard error, for
/// use when the moves are on standard output.
///
/// # Errors
/// The report cannot be converted to JSON.
pub fn print_report(
    report: &ProgramReport,
    json: bool,
    to_stderr: bool,
    language: Option<Language>,
) -> Result<(), serde_json::Error> {
    let text = if json {
        report.to_json()?
    } else {
        report.to_text(language)
    };
    print_or_report(&text, to_stderr);
    Ok(())
}

/// Writes to standard output or, with `to_stderr`, to standard error.
pub fn print_or_report(text: &str, to_stderr: bool) {
    if to_stderr {
        complain!("{}", text.trim_end());
    } else {
        print(text);
    }
}

/// Watches the preview of a program: shows a progress line if it takes long, and cancels it
/// at its work limit.
pub struct PreviewWatch {
    limit: WorkLimit,
    bar: Option<ProgressBar>,
    line_count: u64,
    /// Time at which the progress line appears; `None` if it is off or already shown.
    progress_from: Option<Instant>,
}

/// Starts to watch a preview of the selected program. `shows_progress` permits a progress
/// line; it must be false if several programs are previewed at once.
pub fn watch_preview(
    programs: &ProgramMemory,
    limit: WorkLimit,
    shows_progress: bool,
) -> PreviewWatch {
    const PROGRESS_DELAY: Duration = Duration::from_millis(500);
    let selected = programs.selected().and_then(|number| programs.get(number));
    PreviewWatch {
        limit,
        bar: None,
        line_count: selected.map_or(0, |program| u64::from(program.line_count())),
        progress_from: shows_progress.then(|| Instant::now() + PROGRESS_DELAY),
    }
}

impl PreviewWatch {
    /// Updates the progress line. Returns false if the preview must be cancelled.
    pub fn update_progress(&mut self, progress: &PreviewProgress) -> bool {
        if self.progress_from.is_some_and(|from| Instant::now() > from) {
            self.progress_from = None;
            self.bar = Some(create_progress_bar(self.line_count));
        }
        if let Some(bar) = &self.bar {
            bar.set_position(u64::from(progress.line));
            let time = format_time(progress.time_s);
            let message = say::report_progress(progress.blocks, progress.moves, time);
            bar.set_message(message.to_string());
        }
        self.limit.allows(progress)
    }
}

impl Drop for PreviewWatch {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Creates a progress line of `lines` steps on standard error; hidden if that is not a
/// terminal.
pub fn create_progress_bar(lines: u64) -> ProgressBar {
    if !io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(lines);
    let style = ProgressStyle::with_template("{bar:30} line {pos}/{len}  {msg}");
    if let Ok(style) = style {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_escaped() {
        assert!(matches!(
            escape_for_terminal("G00 X1\n\t车"),
            Cow::Borrowed(_)
        ));
        let hostile = "\u{1b}[31m \u{9b} \u{7f} \u{202e} \r";
        assert_eq!(
            escape_for_terminal(hostile),
            "\\u001b[31m \\u009b \\u007f \\u202e \\u000d"
        );
    }
}
