//! Where results go: files, standard output and standard error, the progress line.
//!
//! A stream that is full or closed never ends the work: `print!` and `eprintln!` would
//! panic there, and what was edited would be lost.

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

/// A file cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub struct WriteError {
    path: PathBuf,
    error: io::Error,
}

impl WriteError {
    /// With its name.
    pub fn new(path: &Path, error: io::Error) -> Self {
        let path = path.to_owned();
        Self { path, error }
    }

    /// What is said of it.
    pub fn message(&self) -> Message {
        say::file_not_written(self.path.display(), of_system(&self.error))
    }
}

/// Bytes that are written at once.
const AT_ONCE: usize = 64 * 1024;

/// A file to be written to, or standard output for `-`.
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

/// Whether results go to standard output by this name.
pub fn is_standard(path: Option<&Path>) -> bool {
    path.is_some_and(|path| path.as_os_str() == "-")
}

/// A text as a terminal may have it: control characters and those that turn the
/// direction of writing are escaped, in the form that JSON knows, too.
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

/// A file that is written at the end, opened at the begin: what refuses it is said
/// before any work is done. Until then its old content stands.
pub struct Reserved {
    file: File,
    path: PathBuf,
}

/// Opens a file that is written at the end.
///
/// # Errors
/// A sentence with the name.
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
    /// Writes it.
    ///
    /// # Errors
    /// A sentence with the name.
    pub fn write(mut self, bytes: &[u8]) -> Result<(), WriteError> {
        // A pipe or a terminal has no length to be set.
        let _ = self.file.set_len(0);
        let written = self.file.write_all(bytes);
        written.map_err(|error| WriteError::new(&self.path, error))
    }
}

/// What standard output did not take first; nothing more is written there then.
static LOST: OnceLock<String> = OnceLock::new();

/// Writes to standard output. A reader that has gone away (`| head`) ends the output, not
/// the program; so does a full disk, which [`lost`] tells at the end.
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
        // Somebody else may have been told first.
        let _ = LOST.set(told);
    }
}

/// Why standard output lacks something; a reader that has gone away wants no more.
pub fn lost() -> Option<&'static str> {
    let why = LOST.get()?;
    (!why.is_empty()).then_some(why.as_str())
}

/// The language of what is said here: that of the command line, chosen once.
static LANGUAGE: OnceLock<Language> = OnceLock::new();

/// From now on messages are in this language; English unless it is chosen.
pub fn speak(language: Language) {
    // One command line chooses once.
    let _ = LANGUAGE.set(language);
}

/// A message in the language of the command line.
pub fn worded(said: &Message) -> String {
    said.text(LANGUAGE.get().copied().unwrap_or(Language::En))
}

/// Writes a message to standard output, on a line of its own.
pub fn say(said: &Message) {
    print(&format!("{}\n", worded(said)));
}

/// Writes a message to standard error, with the name of the program before it.
pub fn complain_of(said: &Message) {
    complain(format_args!("gsk980td: {}", worded(said)));
}

/// Writes a line to standard error; what it does not take nobody can be told.
pub fn complain(text: fmt::Arguments<'_>) {
    let _ = writeln!(io::stderr().lock(), "{}", shown(&text.to_string()));
}

/// A line on standard error, as `eprintln!` writes it, but for a stream that takes none.
macro_rules! complain {
    ($($text:tt)*) => {
        $crate::output::complain(format_args!($($text)*))
    };
}

/// Prints a report, as one JSON object or in words; `aside`: on standard error, where it
/// does not mix with moves on standard output.
///
/// # Errors
/// It cannot be told as JSON.
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

/// Writes to standard output, or to standard error, where it does not mix with moves.
pub fn print_or_aside(text: &str, aside: bool) {
    if aside {
        complain!("{}", text.trim_end());
    } else {
        print(text);
    }
}

/// Watches a look through a program: a progress line while it takes long, and its end
/// when it is given up.
pub struct Watch {
    limit: WorkLimit,
    bar: Option<ProgressBar>,
    lines: u64,
    /// When a progress line is shown, if ever.
    shown_from: Option<Instant>,
}

/// Begins to watch a look through the selected program; `shown` unless others are
/// looked through at the same time.
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
    /// Shows how far it has come; whether to go on.
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

/// A progress line on a terminal; elsewhere nothing.
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
