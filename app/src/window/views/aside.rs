//! Saving and opening a text beside the window: neither the dialog nor a slow disk
//! holds it up.

use std::thread;

use crate::cli::Language;
use crate::files::{atomic, program_file};
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
    let (name, extension) = kind;
    beside(console, context, move || {
        let lower = extension.to_ascii_lowercase();
        let chosen = rfd::FileDialog::new()
            .set_file_name(name)
            .add_filter(extension, &[lower.as_str()])
            .save_file();
        Some(match chosen {
            // A desktop without a file dialog answers as a cancelled one.
            None => Text::NothingChosen.of(language).to_owned(),
            Some(path) => match atomic::write(&path, make().as_bytes()) {
                Ok(()) => format!("{} {}", say(language, "已保存", "Saved"), path.display()),
                Err(error) => format!("{}: {error}", path.display()),
            },
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
    beside(console, context, move || {
        let lower = extension.to_ascii_lowercase();
        let chosen = rfd::FileDialog::new()
            .add_filter(extension, &[lower.as_str(), extension])
            .add_filter(Text::AllFiles.of(language), &["*"])
            .pick_file();
        let Some(path) = chosen else {
            return Some(Text::NothingChosen.of(language).to_owned());
        };
        match program_file::read(&path) {
            Ok(file) => {
                take(file.text);
                None
            }
            Err(error) => Some(error.to_string()),
        }
    });
}

/// Does a job in a thread of its own and says what comes of it.
fn beside(
    console: &Console,
    context: &egui::Context,
    job: impl FnOnce() -> Option<String> + Send + 'static,
) {
    let say = console.say.clone();
    let context = context.clone();
    let started = thread::Builder::new()
        .name("files".to_owned())
        .spawn(move || {
            if let Some(said) = job() {
                let _ = say.try_send(Notice::Said(said));
            }
            context.request_repaint();
        });
    if let Err(error) = started {
        let _ = console.say.try_send(Notice::Said(error.to_string()));
    }
}
