//! Saving and opening a text beside the window: neither the dialog nor a slow disk
//! holds it up.

use crate::files::{atomic, program_file};
use crate::kernel::Console;
use crate::window::files::{Wanted, choose};
use gsk_messages::{Language, say};

/// Asks for a file and writes what `make` gives. `kind` is the proposed name and the
/// extension. What comes of it is said on the window's line of messages.
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

/// Asks for a file with this extension and hands its text to `take`. What stands
/// against it is said on the window's line of messages.
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
