//! Choosing a file beside the window: with the desktop's own dialog where the desktop
//! has one, else with the dialog of this program. Giving up is silent.

mod browser;

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use egui::{Context, Id};

use crate::kernel::Notice;
pub use browser::Browser;
use crossbeam::channel::Sender;
use gsk_messages::{Language, Message, say};

/// What is chosen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// A file that is there, with one of these endings; the name of them all.
    Open(String, Vec<&'static str>),
    /// A name to write to, as it is proposed, with this ending.
    Save(String, &'static str),
}

/// What is done with the chosen file, in a thread of its own; a sentence is said on the
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
        if crate::platform::file_dialog_answers() {
            return native(&ask.wanted, language).and_then(ask.then);
        }
        asked.put(ask);
        waker.request_repaint();
        None
    });
}

/// The desktop's dialog; nothing when it was given up.
fn native(wanted: &Wanted, language: Language) -> Option<PathBuf> {
    let dialog = rfd::FileDialog::new();
    match wanted {
        Wanted::Open(name, endings) => {
            let upper: Vec<String> = endings.iter().map(|it| it.to_ascii_uppercase()).collect();
            let all: Vec<&str> = endings
                .iter()
                .copied()
                .chain(upper.iter().map(String::as_str))
                .collect();
            dialog
                .add_filter(name, &all)
                .add_filter(say::window_all_files().text(language), &["*"])
                .pick_file()
        }
        Wanted::Save(name, ending) => dialog
            .set_file_name(name)
            .add_filter(*ending, &[ending])
            .save_file(),
    }
}

/// Does a job in a thread of its own and says what comes of it.
pub fn beside(
    context: &Context,
    say: &Sender<Notice>,
    job: impl FnOnce() -> Option<Message> + Send + 'static,
) {
    let context = context.clone();
    let telling = say.clone();
    let started = thread::Builder::new()
        .name("files".to_owned())
        .spawn(move || {
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
