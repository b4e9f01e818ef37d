//! Chooses files in a thread, with the desktop's dialog if there is one, else with the dialog
//! of this program. Cancelling shows no message.

mod browser;

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use egui::{Context, Id};

use crate::kernel::Notice;
use crate::platform::{self, FileDialog};
pub use browser::Browser;
use crossbeam::channel::Sender;
use gsk_messages::{Language, Message, say};

/// What the operator chooses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// An existing file with one of these extensions; the string names the file type.
    Open(String, Vec<&'static str>),
    /// An existing folder.
    Folder,
    /// A file to write: the proposed name and the extension.
    Save(String, &'static str),
}

/// Called in a thread with the chosen file. A returned message appears on the message line.
type Then = Box<dyn FnOnce(PathBuf) -> Option<Message> + Send>;

/// A choice for the dialog of this program.
struct Ask {
    wanted: Wanted,
    then: Then,
    say: Sender<Notice>,
}

/// The choices that wait for the dialog of this program.
#[derive(Clone, Default)]
struct Asked(Arc<Mutex<Vec<Ask>>>);

impl Asked {
    fn of(context: &Context) -> Self {
        let id = Id::unique("asked for files");
        context.data_mut(|data| data.get_temp_mut_or_default::<Self>(id).clone())
    }

    fn take(&self) -> Option<Ask> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).pop()
    }

    fn put(&self, ask: Ask) {
        let mut asked = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        asked.push(ask);
    }
}

/// Lets the operator choose a file and calls `then` with it in a thread. Messages go to `say`.
pub fn choose(
    context: &Context,
    language: Language,
    say: &Sender<Notice>,
    wanted: Wanted,
    then: impl FnOnce(PathBuf) -> Option<Message> + Send + 'static,
) {
    let asked = Asked::of(context);
    let ask = Ask {
        wanted,
        then: Box::new(then),
        say: say.clone(),
    };
    let waker = context.clone();
    beside(context, say, move || {
        if platform::file_dialog_answers() {
            platform::choose_file(dialog(&ask.wanted, language), move |path| {
                if let Some(said) = (ask.then)(path) {
                    // A window that is closed needs no message.
                    let _ = ask.say.try_send(Notice::Said(said));
                }
                waker.request_repaint();
            });
            return None;
        }
        asked.put(ask);
        waker.request_repaint();
        None
    });
}

/// The settings of the desktop's dialog.
fn dialog(wanted: &Wanted, language: Language) -> FileDialog {
    match wanted.clone() {
        Wanted::Open(kind, endings) => FileDialog::Open {
            kind,
            endings,
            all: say::window_all_files().text(language),
        },
        Wanted::Folder => FileDialog::Folder,
        Wanted::Save(name, ending) => FileDialog::Save { name, ending },
    }
}

/// Runs `job` in a thread and sends its message to `say`.
pub fn beside(
    context: &Context,
    say: &Sender<Notice>,
    job: impl FnOnce() -> Option<Message> + Send + 'static,
) {
    let context = context.clone();
    let telling = say.clone();
    let started = platform::beside("files", move || {
        if let Some(said) = job() {
            // A window that is closed needs no message.
            let _ = telling.try_send(Notice::Said(said));
        }
        context.request_repaint();
    });
    if let Err(error) = started {
        let _ = say.try_send(Notice::Said(say::as_written(error)));
    }
}
