//! Choosing a file beside the window: with the desktop's own dialog where the desktop
//! has one, else with the dialog of this program. Giving up is silent.

mod browser;

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use egui::{Context, Id};

use crate::kernel::Notice;
use crate::platform::{self, FileDialog};
pub use browser::Browser;
use crossbeam::channel::Sender;
use gsk_messages::{Language, Message, say};

/// What is chosen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// A file that is there, with one of these endings; the name of them all.
    Open(String, Vec<&'static str>),
    /// A folder that is there.
    Folder,
    /// A name to write to, as it is proposed, with this ending.
    Save(String, &'static str),
}

/// What is done with the chosen file, beside the window; a sentence is said on the
/// line of messages.
type Then = Box<dyn FnOnce(PathBuf) -> Option<Message> + Send>;

/// A choice that the dialog of this program is to make.
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

/// Lets the user choose a file and hands it to `then`.
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
                    // A window that is gone needs no message.
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

/// What a dialog of the desktop is to ask.
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

/// Does a job beside the window and says what comes of it.
pub fn beside(
    context: &Context,
    say: &Sender<Notice>,
    job: impl FnOnce() -> Option<Message> + Send + 'static,
) {
    let context = context.clone();
    let telling = say.clone();
    let started = platform::beside("files", move || {
        if let Some(said) = job() {
            // A window that is gone needs no message.
            let _ = telling.try_send(Notice::Said(said));
        }
        context.request_repaint();
    });
    if let Err(error) = started {
        let _ = say.try_send(Notice::Said(say::as_written(error)));
    }
}
