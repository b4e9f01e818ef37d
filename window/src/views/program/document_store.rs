//! Loads and saves the texts of the editor in background threads: files, and the control's
//! memory.

use std::path::{Path, PathBuf};

use crossbeam::channel::{Receiver, Sender, unbounded};
use egui::Context;
use gsk_core::command::ProgramId;
use gsk_host::files::{atomic, program_file};
use gsk_host::kernel::{Console, NotStored};
use gsk_messages::{Language, Message, say};

use super::document::{ProgramDocument, TextOrigin};
use super::print::print_sheet;
use crate::widgets::files::{FileChoice, choose_file, run_in_thread};

/// A result that a background thread reports to the program view.
pub enum DocumentEvent {
    /// The text of this document was loaded.
    Loaded(Box<ProgramDocument>),
    /// A text was saved: written to a file or stored in the control.
    Saved {
        text: String,
        /// The file or program to which the text was saved.
        origin: TextOrigin,
    },
    /// The control has stored a text as the program of this number.
    Stored { text: String, number: u16 },
    /// The setup sheet of a text was opened, as the message reports.
    Printed(Message),
    /// The control has refused to store a text for this reason.
    NotStored(NotStored),
    /// An operation other than these has failed, as the message reports.
    Failed(Message),
}

/// Loads and saves texts in background threads.
pub struct DocumentStore {
    console: Console,
    sender: Sender<DocumentEvent>,
    receiver: Receiver<DocumentEvent>,
}

impl DocumentStore {
    /// Creates a store without running operations.
    pub fn new(console: Console) -> Self {
        let (sender, receiver) = unbounded();
        Self {
            console,
            sender,
            receiver,
        }
    }

    /// Removes and returns the next result; `None` without one.
    pub fn next_event(&self) -> Option<DocumentEvent> {
        self.receiver.try_recv().ok()
    }

    pub fn load_file(&self, path: PathBuf, context: &Context) {
        self.run_in_background(context, move |_| Some(read_document(&path)));
    }

    /// Shows a dialog in which the user chooses a file, and reads it.
    pub fn choose_file(&self, language: Language, context: &Context) {
        let to = self.sender.clone();
        let name = say::window_part_programs().text(language);
        let dialog = FileChoice::Open(name, vec!["cnc", "nc", "txt", "tap"]);
        choose_file(
            context,
            language,
            &self.console.notice_sender,
            dialog,
            move |path| {
                // The send fails when the view is gone. No view needs the text then.
                let _ = to.send(read_document(&path));
                None
            },
        );
    }

    /// Reads a program of the control's memory; `None` reads the selected one.
    pub fn load_program(&self, number: Option<u16>, context: &Context) {
        self.run_in_background(context, move |console| {
            let setup = console.setup()?;
            let programs = &setup.memory.programs;
            let number = number.or(match programs.selected() {
                Some(ProgramId::Stored(number)) => Some(number),
                _ => None,
            })?;
            let program = programs.stored(number)?;
            let document = ProgramDocument::new(TextOrigin::Memory(number), program.text());
            Some(DocumentEvent::Loaded(Box::new(document)))
        });
    }

    /// Writes the setup sheet of a text and opens it in a browser.
    pub fn print(&self, document: &ProgramDocument, language: Language, context: &Context) {
        let name = document.name(self.console.naming());
        let origin = document.origin.clone();
        let text = document.text.clone();
        self.run_in_background(context, move |console| {
            let setup = console.setup()?;
            let file = match &origin {
                TextOrigin::File(path, _) => Some(path.as_path()),
                TextOrigin::New | TextOrigin::Memory(_) => None,
            };
            Some(match print_sheet(&name, &text, file, setup, language) {
                Ok(message) => DocumentEvent::Printed(message),
                Err(why) => DocumentEvent::Failed(why),
            })
        });
    }

    /// Writes a text to its file, or to a file that the user chooses if it has none.
    pub fn save(&self, document: &ProgramDocument, language: Language, context: &Context) {
        let TextOrigin::File(path, encoding) = document.origin.clone() else {
            return self.save_as(document, language, context);
        };
        let (text, bytes) = (document.text.clone(), document.to_bytes(encoding));
        self.run_in_background(context, move |_| {
            Some(write_document(
                &path,
                &bytes,
                text,
                TextOrigin::File(path.clone(), encoding),
            ))
        });
    }

    /// Writes a text to a file that the user chooses.
    pub fn save_as(&self, document: &ProgramDocument, language: Language, context: &Context) {
        let encoding = document.encoding();
        let (text, bytes) = (document.text.clone(), document.to_bytes(encoding));
        let name = match &document.origin {
            TextOrigin::File(..) => document.name(self.console.naming()),
            TextOrigin::New | TextOrigin::Memory(_) => {
                let number = document.to_program().number().unwrap_or(1);
                format!("O{number:04}.CNC")
            }
        };
        let to = self.sender.clone();
        let dialog = FileChoice::Save(name, "CNC");
        choose_file(
            context,
            language,
            &self.console.notice_sender,
            dialog,
            move |path| {
                let origin = TextOrigin::File(path.clone(), encoding);
                let _ = to.send(write_document(&path, &bytes, text, origin));
                None
            },
        );
    }

    /// Stores a text as a program of the control.
    pub fn store(&self, document: &ProgramDocument, context: &Context) {
        let text = document.text.clone();
        self.run_in_background(context, move |console| {
            Some(match console.store(text.clone())? {
                Ok(number) => DocumentEvent::Stored { text, number },
                Err(why) => DocumentEvent::NotStored(why),
            })
        });
    }

    fn run_in_background(
        &self,
        context: &Context,
        job: impl FnOnce(&Console) -> Option<DocumentEvent> + Send + 'static,
    ) {
        let (to, console) = (self.sender.clone(), self.console.clone());
        run_in_thread(context, &self.console.notice_sender, move || {
            if let Some(arrived) = job(&console) {
                let _ = to.send(arrived);
            }
            None
        });
    }
}

fn read_document(path: &Path) -> DocumentEvent {
    match program_file::read(path) {
        Ok(file) => DocumentEvent::Loaded(Box::new(ProgramDocument::from_file(&file))),
        Err(error) => DocumentEvent::Failed(error.message()),
    }
}

fn write_document(path: &Path, bytes: &[u8], text: String, origin: TextOrigin) -> DocumentEvent {
    match atomic::write(path, bytes) {
        Ok(()) => DocumentEvent::Saved { text, origin },
        Err(error) => {
            DocumentEvent::Failed(say::subject_reason(path.display(), say::as_written(error)))
        }
    }
}
