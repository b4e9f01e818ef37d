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

use gsk_core::preview::Progress;
use gsk_core::program::ProgramMemory;
use gsk_messages::{Message, say};
use gsk_runner::Language;
use gsk_runner::report::Report;
use gsk_runner::words::clock;
use indicatif::{ProgressBar, ProgressStyle};
use web_time::{Duration, Instant};

use crate::platform;
use crate::saying::of_system;
use crate::work_limit::WorkLimit;

/// An error of a file that cannot be written, with its path.
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
        say::file_not_written(self.path.display(), of_system(&self.error))
    }
}

/// Size of the write buffers, bytes.
const AT_ONCE: usize = 64 * 1024;

/// Opens a file to write into, replacing its contents; `-` is standard output.
pub fn open(path: &Path) -> Result<Box<dyn Write>, WriteError> {
    if path.as_os_str() == "-" {
        return Ok(Box::new(BufWriter::with_capacity(
            AT_ONCE,
            io::stdout().lock(),
        )));
    }
    let file = platform::refuse_device(path).and_then(|()| File::create(path));
    let file = file.map_err(|error| WriteError::new(path, error))?;
    Ok(Box::new(BufWriter::with_capacity(AT_ONCE, file)))
}

/// Whether the path is `-`, the name of standard output.
pub fn is_standard(path: Option<&Path>) -> bool {
    path.is_some_and(|path| path.as_os_str() == "-")
}

/// Escapes a text for a terminal: control characters and characters that change the writing
/// direction become `\uXXXX`, which JSON can read, too.
pub fn shown(text: &str) -> Cow<'_, str> {
    let hidden = |letter: char| {
        let turns = matches!(letter, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
        turns || (letter.is_control() && !matches!(letter, '\n' | '\t'))
    };
    if !text.contains(hidden) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        if hidden(letter) {
            out.push_str(&format!("\\u{:04x}", u32::from(letter)));
        } else {
            out.push(letter);
        }
    }
    Cow::Owned(out)
}

/// A file that is opened at the start of a command and written at its end: an error shows
/// before the work begins. The old contents remain until then.
pub struct Reserved {
    file: File,
    path: PathBuf,
}

/// Opens a file that is written at the end of a command.
///
/// # Errors
/// The file cannot be opened for writing.
pub fn reserve(path: &Path) -> Result<Reserved, WriteError> {
    let mut options = OpenOptions::new();
    options.create(true).truncate(false).write(true);
    let opened = platform::refuse_device(path).and_then(|()| options.open(path));
    let file = opened.map_err(|error| WriteError::new(path, error))?;
    Ok(Reserved {
        file,
        path: path.to_owned(),
    })
}

impl Reserved {
    /// Replaces the contents of the file.
    ///
    /// # Errors
    /// The bytes cannot be written.
    pub fn write(mut self, bytes: &[u8]) -> Result<(), WriteError> {
        // Pipes and terminals have no length to set.
        let _ = self.file.set_len(0);
        let written = self.file.write_all(bytes);
        written.map_err(|error| WriteError::new(&self.path, error))
    }
}

/// The first error of standard output; after it nothing more is written there. Empty if the
/// reader has closed the pipe.
static LOST: OnceLock<String> = OnceLock::new();

/// Writes to standard output. A closed pipe (`| head`) ends the output but not the program.
/// So does a full disk; [`lost`] reports it at the end.
pub fn print(text: &str) {
    if LOST.get().is_some() {
        return;
    }
    let mut out = io::stdout().lock();
    if let Err(error) = out
        .write_all(shown(text).as_bytes())
        .and_then(|()| out.flush())
    {
        let told = match error.kind() {
            io::ErrorKind::BrokenPipe => String::new(),
            _ => error.to_string(),
        };
        // Another thread may have stored its error first.
        let _ = LOST.set(told);
    }
}

/// The error that ended standard output; `None` if all was written or the reader closed the
/// pipe.
pub fn lost() -> Option<&'static str> {
    let why = LOST.get()?;
    (!why.is_empty()).then_some(why.as_str())
}

/// The language of the messages of this module, set once from the command line.
static LANGUAGE: OnceLock<Language> = OnceLock::new();

/// Sets the language of all later messages; the default is English.
pub fn speak(language: Language) {
    // Each process parses one command line.
    let _ = LANGUAGE.set(language);
}

/// The text of a message in the language of the command line.
pub fn worded(said: &Message) -> String {
    said.text(LANGUAGE.get().copied().unwrap_or(Language::En))
}

/// Writes a message and a newline to standard output.
pub fn say(said: &Message) {
    print(&format!("{}\n", worded(said)));
}

/// Writes a message to standard error, after the name of the program.
pub fn complain_of(said: &Message) {
    complain(format_args!("gsk980td: {}", worded(said)));
}

/// Writes a line to standard error. Errors of the stream are ignored: there is no other
/// place to report them.
pub fn complain(text: fmt::Arguments<'_>) {
    let _ = writeln!(io::stderr().lock(), "{}", shown(&text.to_string()));
}

/// Writes a line to standard error like `eprintln!`, but does not panic if the stream fails.
macro_rules! complain {
    ($($text:tt)*) => {
        $crate::output::complain(format_args!($($text)*))
    };
}

/// Prints a report, as one JSON object or in words. `aside` selects standard error, because
/// the moves are on standard output.
///
/// # Errors
/// The report cannot be converted to JSON.
pub fn report(
    report: &Report,
    json: bool,
    aside: bool,
    language: Option<Language>,
) -> Result<(), serde_json::Error> {
    let text = if json {
        report.json()?
    } else {
        report.words(language)
    };
    print_or_aside(&text, aside);
    Ok(())
}

/// Writes to standard output or, with `aside`, to standard error.
pub fn print_or_aside(text: &str, aside: bool) {
    if aside {
        complain!("{}", text.trim_end());
    } else {
        print(text);
    }
}

/// Watches the preview of a program: shows a progress line if it takes long, and cancels it
/// at its work limit.
pub struct Watch {
    limit: WorkLimit,
    bar: Option<ProgressBar>,
    lines: u64,
    /// When the progress line appears; `None` if it is off or already shown.
    shown_from: Option<Instant>,
}

/// Starts to watch a preview of the selected program. `shown` allows a progress line; it is
/// off if several programs are previewed at once.
pub fn watch(programs: &ProgramMemory, limit: WorkLimit, shown: bool) -> Watch {
    const SOON: Duration = Duration::from_millis(500);
    let selected = programs.current().and_then(|number| programs.get(number));
    Watch {
        limit,
        bar: None,
        lines: selected.map_or(0, |program| u64::from(program.line_count())),
        shown_from: shown.then(|| Instant::now() + SOON),
    }
}

impl Watch {
    /// Updates the progress line. Returns false if the preview must end.
    pub fn goes_on(&mut self, progress: &Progress) -> bool {
        if self.shown_from.is_some_and(|from| Instant::now() > from) {
            self.shown_from = None;
            self.bar = Some(self::progress(self.lines));
        }
        if let Some(bar) = &self.bar {
            bar.set_position(u64::from(progress.line));
            let time = clock(progress.time_s);
            let said = say::report_progress(progress.blocks, progress.moves, time);
            bar.set_message(said.to_string());
        }
        self.limit.allows(progress)
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Creates a progress line of `lines` steps on standard error; hidden if that is not a
/// terminal.
pub fn progress(lines: u64) -> ProgressBar {
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
    fn nothing_steers_the_terminal() {
        assert!(matches!(shown("G00 X1\n\t车"), Cow::Borrowed(_)));
        let hostile = "\u{1b}[31m \u{9b} \u{7f} \u{202e} \r";
        assert_eq!(
            shown(hostile),
            "\\u001b[31m \\u009b \\u007f \\u202e \\u000d"
        );
    }
}
