//! Saving a text beside the window: neither the dialog nor a slow disk holds it up.

use std::thread;

use crate::cli::Language;
use crate::files::atomic;
use crate::kernel::{Console, Notice};
use crate::window::texts::{Text, say};

/// Asks for a file and writes what `make` gives. `kind` is the proposed name and the
/// extension. What comes of it is said on the window's line of messages.
pub fn save(
    console: &Console,
    context: &egui::Context,
    language: Language,
    kind: (&'static str, &'static str),
    make: impl FnOnce() -> String + Send + 'static,
) {
    let console = console.clone();
    let words = console.clone();
    let context = context.clone();
    let (name, extension) = kind;
    let job = move || {
        let lower = extension.to_ascii_lowercase();
        let chosen = rfd::FileDialog::new()
            .set_file_name(name)
            .add_filter(extension, &[lower.as_str()])
            .save_file();
        let said = match chosen {
            // A desktop without a file dialog answers as a cancelled one.
            None => Text::NothingChosen.of(language).to_owned(),
            Some(path) => match atomic::write(&path, make().as_bytes()) {
                Ok(()) => format!("{} {}", say(language, "已保存", "Saved"), path.display()),
                Err(error) => format!("{}: {error}", path.display()),
            },
        };
        let _ = console.say.try_send(Notice::Said(said));
        context.request_repaint();
    };
    let started = thread::Builder::new().name("files".to_owned()).spawn(job);
    if let Err(error) = started {
        let _ = words.say.try_send(Notice::Said(error.to_string()));
    }
}
