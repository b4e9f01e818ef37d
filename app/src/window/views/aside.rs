//! Saves and opens text files without blocking the window: neither the file dialog nor a slow
//! disk delays a frame.

use crate::files::{atomic, program_file};
use crate::kernel::Console;
use crate::window::files::{Wanted, choose};
use gsk_messages::{Language, say};

/// Shows a save dialog and writes the text that `make` returns. `kind` is the proposed name
/// and the extension. The result is shown on the window's message line.
pub fn save(
    console: &Console,
    context: &egui::Context,
    language: Language,
    kind: (&'static str, &'static str),
    make: impl FnOnce() -> String + Send + 'static,
) {
    let wanted = Wanted::Save(kind.0.to_owned(), kind.1);
    choose(context, language, &console.say, wanted, move |path| {
        Some(match atomic::write(&path, make().as_bytes()) {
            Ok(()) => say::window_saved(path.display()),
            Err(error) => say::subject_reason(path.display(), say::as_written(error)),
        })
    });
}

/// Shows an open dialog for files with this extension and passes the text to `take`. An error
/// is shown on the window's message line.
pub fn open(
    console: &Console,
    context: &egui::Context,
    language: Language,
    extension: &'static str,
    take: impl FnOnce(String) + Send + 'static,
) {
    let wanted = Wanted::Open(extension.to_owned(), vec![extension]);
    choose(
        context,
        language,
        &console.say,
        wanted,
        move |path| match program_file::read(&path) {
            Ok(file) => {
                take(file.text);
                None
            }
            Err(error) => Some(error.message()),
        },
    );
}
