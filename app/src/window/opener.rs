//! Choosing and reading program files beside the window: neither a dialog nor a
//! large file holds it up.

use std::path::{Path, PathBuf};
use std::thread;

use gsk_core::program::ProgramMemory;

use super::extents;
use super::texts::Text;
use crate::cli::Language;
use crate::kernel::{Command, Console, Notice, Opened};
use crate::{loading, transfer};

/// Opens programs.
#[derive(Clone, Debug)]
pub struct Opener {
    console: Console,
}

impl Opener {
    /// For a console.
    pub const fn new(console: Console) -> Self {
        Self { console }
    }

    /// Lets the user choose a program, and opens it.
    pub fn choose(&self, language: Language, context: egui::Context) {
        self.aside(context, move |opener| {
            let chosen = rfd::FileDialog::new()
                .add_filter(
                    Text::Programs.of(language),
                    &["CNC", "cnc", "NC", "nc", "TXT", "txt", "TAP", "tap"],
                )
                .add_filter(Text::AllFiles.of(language), &["*"])
                .pick_file();
            match chosen {
                Some(path) => opener.read(&path),
                // A desktop without a file dialog answers as a cancelled one.
                None => {
                    let said = Text::NothingChosen.of(language).to_owned();
                    let _ = opener.console.say.try_send(Notice::Said(said));
                }
            }
        });
    }

    /// Opens a program.
    pub fn open(&self, path: PathBuf, context: egui::Context) {
        self.aside(context, move |opener| opener.read(&path));
    }

    fn aside(&self, context: egui::Context, job: impl FnOnce(&Self) + Send + 'static) {
        let opener = self.clone();
        let started = thread::Builder::new()
            .name("files".to_owned())
            .spawn(move || {
                job(&opener);
                context.request_repaint();
            });
        if let Err(error) = started {
            let _ = self.console.say.try_send(Notice::Said(error.to_string()));
        }
    }

    fn read(&self, path: &Path) {
        if transfer::is_data(path) {
            match transfer::read(path) {
                Ok(file) => self.console.send(Command::Receive(Box::new(file))),
                Err(said) => {
                    let _ = self.console.say.try_send(Notice::Said(said));
                }
            }
            return;
        }
        match read(path) {
            Ok((opened, notices)) => {
                let shown = opened.clone();
                // The queue has room for a program; the kernel empties it all the time.
                let _ = self.console.commands.send(Command::Open(Box::new(opened)));
                if let Some((least, greatest)) = extents::of(&shown) {
                    self.console.send(Command::Fit { least, greatest });
                }
                for notice in notices {
                    let _ = self.console.say.try_send(Notice::Said(notice));
                }
            }
            Err(said) => {
                let _ = self.console.say.try_send(Notice::Said(said));
            }
        }
    }
}

/// Reads a program and its subprograms.
pub fn read(path: &Path) -> Result<(Opened, Vec<String>), String> {
    let mut programs = ProgramMemory::default();
    let (program, notices) = loading::open_into(&mut programs, path, &[])?;
    let subprograms = programs
        .iter()
        .map(|(_, program)| program.clone())
        .collect();
    let name = path.display().to_string();
    Ok((
        Opened {
            name,
            program,
            subprograms,
        },
        notices.0,
    ))
}
