//! Loads and saves the texts of the editor in background threads: files, and the control's
//! memory.

use std::path::{Path, PathBuf};

use crossbeam::channel::{Receiver, Sender, unbounded};
use egui::Context;
use gsk_core::command::ProgramId;
use gsk_messages::{Language, Message, say};

use super::document::{Document, Origin};
use crate::files::{atomic, program_file};
use crate::kernel::{Console, NotStored};
use crate::window::files::{Wanted, beside, choose};

/// A result of a background thread.
pub enum Arrived {
    /// A text was loaded.
    Text(Box<Document>),
    /// A text was written to a file.
    Saved {
        text: String,
        /// The file.
        origin: Origin,
    },
    /// The control has stored a text.
    Stored {
        text: String,
        number: u16,
    },
    /// The control has refused a text.
    NotStored(NotStored),
    /// Another operation failed.
    Refused(Message),
}

/// Starts operations that take time in background threads.
pub struct Desk {
    console: Console,
    to: Sender<Arrived>,
    from: Receiver<Arrived>,
}

impl Desk {
    /// Creates the desk without running operations.
    pub fn new(console: Console) -> Self {
        let (to, from) = unbounded();
        Self { console, to, from }
    }

    /// Takes the next result.
    pub fn arrived(&self) -> Option<Arrived> {
        self.from.try_recv().ok()
    }

    pub fn read(&self, path: PathBuf, context: &Context) {
        self.beside(context, move |_| Some(read(&path)));
    }

    /// Lets the user choose a file and reads it.
    pub fn choose(&self, language: Language, context: &Context) {
        let to = self.to.clone();
        let name = say::window_part_programs().text(language);
        let wanted = Wanted::Open(name, vec!["cnc", "nc", "txt", "tap"]);
        choose(context, language, &self.console.say, wanted, move |path| {
            // The send fails when the view is gone. No view needs the text then.
            let _ = to.send(read(&path));
            None
        });
    }

    /// Reads a program of the control's memory; `None`: the selected one.
    pub fn take(&self, number: Option<u16>, context: &Context) {
        self.beside(context, move |console| {
            let setup = console.setup()?;
            let programs = &setup.memory.programs;
            let number = number.or(match programs.current() {
                Some(ProgramId::Stored(number)) => Some(number),
                _ => None,
            })?;
            let program = programs.stored(number)?;
            let document = Document::new(Origin::Memory(number), program.text());
            Some(Arrived::Text(Box::new(document)))
        });
    }

    /// Writes a text to its file, or to a file that the user chooses if it has none.
    pub fn save(&self, document: &Document, language: Language, context: &Context) {
        let Origin::File(path, encoding) = document.origin.clone() else {
            return self.save_as(document, language, context);
        };
        let (text, bytes) = (document.text.clone(), document.bytes(encoding));
        self.beside(context, move |_| {
            Some(write(
                &path,
                &bytes,
                text,
                Origin::File(path.clone(), encoding),
            ))
        });
    }

    /// Writes a text to a file that the user chooses.
    pub fn save_as(&self, document: &Document, language: Language, context: &Context) {
        let encoding = document.encoding();
        let (text, bytes) = (document.text.clone(), document.bytes(encoding));
        let name = match &document.origin {
            Origin::File(..) => document.name(),
            Origin::New | Origin::Memory(_) => {
                let number = document.program().number().unwrap_or(1);
                format!("O{number:04}.CNC")
            }
        };
        let to = self.to.clone();
        let wanted = Wanted::Save(name, "CNC");
        choose(context, language, &self.console.say, wanted, move |path| {
            let origin = Origin::File(path.clone(), encoding);
            let _ = to.send(write(&path, &bytes, text, origin));
            None
        });
    }

    /// Stores a text in the control.
    pub fn store(&self, document: &Document, context: &Context) {
        let text = document.text.clone();
        self.beside(context, move |console| {
            Some(match console.store(text.clone())? {
                Ok(number) => Arrived::Stored { text, number },
                Err(why) => Arrived::NotStored(why),
            })
        });
    }

    fn beside(
        &self,
        context: &Context,
        job: impl FnOnce(&Console) -> Option<Arrived> + Send + 'static,
    ) {
        let (to, console) = (self.to.clone(), self.console.clone());
        beside(context, &self.console.say, move || {
            if let Some(arrived) = job(&console) {
                let _ = to.send(arrived);
            }
            None
        });
    }
}

fn read(path: &Path) -> Arrived {
    match program_file::read(path) {
        Ok(file) => Arrived::Text(Box::new(Document::of_file(&file))),
        Err(error) => Arrived::Refused(error.message()),
    }
}

fn write(path: &Path, bytes: &[u8], text: String, origin: Origin) -> Arrived {
    match atomic::write(path, bytes) {
        Ok(()) => Arrived::Saved { text, origin },
        Err(error) => Arrived::Refused(say::subject_reason(path.display(), say::as_written(error))),
    }
}
