//! Saves and opens text files without blocking the window: neither the file dialog nor a slow
//! disk delays a frame.

use gsk_host::files::{atomic, program_file};
use gsk_host::kernel::Console;

use crate::widgets::files::{FileChoice, choose_file};
use gsk_messages::{Language, say};

/// Shows a save dialog and writes the text that `make_text` returns. `name_and_extension` is
/// the proposed name and the extension. The window's message line shows the result.
pub fn save(
    console: &Console,
    context: &egui::Context,
    language: Language,
    name_and_extension: (&'static str, &'static str),
    make_text: impl FnOnce() -> String + Send + 'static,
) {
    let dialog = FileChoice::Save(name_and_extension.0.to_owned(), name_and_extension.1);
    choose_file(
        context,
        language,
        &console.notice_sender,
        dialog,
        move |path| {
            Some(match atomic::write(&path, make_text().as_bytes()) {
                Ok(()) => say::window_saved(path.display()),
                Err(error) => say::subject_reason(path.display(), say::as_written(error)),
            })
        },
    );
}

/// Shows an open dialog for files with this extension and passes the text of the chosen one to
/// `take_text`. The window's message line shows an error.
pub fn open(
    console: &Console,
    context: &egui::Context,
    language: Language,
    extension: &'static str,
    take_text: impl FnOnce(String) + Send + 'static,
) {
    let dialog = FileChoice::Open(extension.to_owned(), vec![extension]);
    choose_file(
        context,
        language,
        &console.notice_sender,
        dialog,
        move |path| match program_file::read(&path) {
            Ok(file) => {
                take_text(file.text);
                None
            }
            Err(error) => Some(error.message()),
        },
    );
}
