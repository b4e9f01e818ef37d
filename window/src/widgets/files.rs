//! Chooses files in a thread, with the desktop's dialog if there is one, else with the dialog
//! of this program. Cancelling shows no message.

mod file_browser;

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use egui::{Context, Id};

use crossbeam::channel::Sender;
pub use file_browser::FileBrowser;
use gsk_host::kernel::Notice;
use gsk_host::platform::{self, FileDialog};
use gsk_messages::{Language, Message, say};

/// What the operator chooses in the file dialog: a file, a folder or a new name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FileChoice {
    /// An existing file with one of these extensions; the string is the name of the file type.
    Open(String, Vec<&'static str>),
    /// The operator chooses an existing folder.
    Folder,
    /// A file to write, with the proposed name and the extension.
    Save(String, &'static str),
}

/// Function that a thread calls with the chosen file; the window shows the message that it
/// returns.
type OnChosen = Box<dyn FnOnce(PathBuf) -> Option<Message> + Send>;

/// A file choice that waits for the file dialog of this program.
struct ChoiceRequest {
    choice: FileChoice,
    on_chosen: OnChosen,
    notices: Sender<Notice>,
}

/// The choices that wait for the file dialog of this program, on a desktop without one.
#[derive(Clone, Default)]
struct PendingChoices(Arc<Mutex<Vec<ChoiceRequest>>>);

impl PendingChoices {
    fn of_context(context: &Context) -> Self {
        let id = Id::unique("file requests");
        context.data_mut(|data| data.get_temp_mut_or_default::<Self>(id).clone())
    }

    fn take(&self) -> Option<ChoiceRequest> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).pop()
    }

    fn add(&self, request: ChoiceRequest) {
        let mut requests = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        requests.push(request);
    }
}

/// Lets the operator choose a file and calls `on_chosen` with it in a thread. Messages are
/// sent to `notices`.
pub fn choose_file(
    context: &Context,
    language: Language,
    notices: &Sender<Notice>,
    choice: FileChoice,
    on_chosen: impl FnOnce(PathBuf) -> Option<Message> + Send + 'static,
) {
    let pending = PendingChoices::of_context(context);
    let request = ChoiceRequest {
        choice,
        on_chosen: Box::new(on_chosen),
        notices: notices.clone(),
    };
    let waker = context.clone();
    run_in_thread(context, notices, move || {
        if platform::has_file_dialog() {
            platform::choose_file(desktop_dialog(&request.choice, language), move |path| {
                if let Some(message) = (request.on_chosen)(path) {
                    // A window that is closed needs no message.
                    let _ = request.notices.try_send(Notice::Message(message));
                }
                waker.request_repaint();
            });
            return None;
        }
        pending.add(request);
        waker.request_repaint();
        None
    });
}

/// Converts a choice to the settings of the desktop's dialog.
fn desktop_dialog(choice: &FileChoice, language: Language) -> FileDialog {
    match choice.clone() {
        FileChoice::Open(kind, endings) => FileDialog::Open {
            kind,
            endings,
            all: say::window_all_files().text(language),
        },
        FileChoice::Folder => FileDialog::Folder,
        FileChoice::Save(name, ending) => FileDialog::Save { name, ending },
    }
}

/// Runs `job` in a thread and sends the message that it returns to `notices`.
pub fn run_in_thread(
    context: &Context,
    notices: &Sender<Notice>,
    job: impl FnOnce() -> Option<Message> + Send + 'static,
) {
    let context = context.clone();
    let thread_notices = notices.clone();
    let started = platform::run_in_background("files", move || {
        if let Some(message) = job() {
            // A window that is closed needs no message.
            let _ = thread_notices.try_send(Notice::Message(message));
        }
        context.request_repaint();
    });
    if let Err(error) = started {
        let _ = notices.try_send(Notice::Message(say::as_written(error)));
    }
}
