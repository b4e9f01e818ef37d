//! Chooses and reads program files in a thread: neither a dialog nor a large file delays the
//! window.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use gsk_core::command::ProgramId;
use gsk_core::model::ControlModel;
use gsk_core::preview::WorkBudget;
use gsk_core::program::ProgramMemory;
use gsk_core::setup::Setup;
use gsk_panel::emulator::number_of_name;
use gsk_runner::first_look;
use gsk_runner::words::clock;
use web_time::{Duration, Instant};

use super::files::{self, Wanted};
use super::samples::SampleRequest;
use crate::kernel::{Command, Console, Notice, Opened, Storing};
use crate::loading::LoadError;
use crate::work_limit::WorkLimit;
use crate::{loading, transfer};
use gsk_messages::{Language, Message, say};

/// Opens programs and previews them.
#[derive(Clone, Debug)]
pub struct Opener {
    console: Console,
    /// Number of the program that was opened last. The preview of an earlier one ends.
    newest: Arc<AtomicU64>,
}

/// Work limit of a preview.
const BUDGET: WorkBudget = WorkBudget::interactive(50_000_000);

/// Interval between two progress messages of a preview.
const NEWS: Duration = Duration::from_secs(2);

impl Opener {
    /// Creates an opener that sends programs to `console`.
    pub fn new(console: Console) -> Self {
        Self {
            console,
            newest: Arc::default(),
        }
    }

    /// Shows a file dialog and opens the chosen program.
    pub fn choose(&self, language: Language, context: &egui::Context) {
        let opener = self.clone();
        let name = say::window_part_programs().text(language);
        let wanted = Wanted::Open(name, vec!["cnc", "nc", "txt", "tap"]);
        files::choose(context, language, &self.console.say, wanted, move |path| {
            opener.read(&path);
            None
        });
    }

    /// Opens a program file, or receives a data file, in a thread.
    pub fn open(&self, path: PathBuf, context: &egui::Context) {
        let opener = self.clone();
        files::beside(context, &self.console.say, move || {
            opener.read(&path);
            None
        });
    }

    /// Opens a sample program, and starts it if the request says so.
    pub fn open_sample(&self, request: SampleRequest, context: &egui::Context) {
        let opener = self.clone();
        files::beside(context, &self.console.say, move || {
            let opened = request.sample.opened();
            match request.starts {
                true => opener.hand_over(opened, Command::OpenAndStart),
                false => opener.hand_over(opened, Command::Open),
            }
            None
        });
    }

    /// Sends a program to the control and previews it.
    fn hand_over(&self, opened: Opened, command: fn(Box<Opened>) -> Command) {
        let shown = opened.clone();
        // The queue has a slot for a program: the kernel empties it continuously.
        let _ = self.console.commands.send(command(Box::new(opened)));
        self.look_through(&shown);
    }

    fn read(&self, path: &Path) {
        if transfer::is_data(path) {
            match transfer::read(path) {
                Ok(file) => self.console.send(Command::Receive(Box::new(file))),
                Err(error) => {
                    let _ = self.console.say.try_send(Notice::Said(error.message()));
                }
            }
            return;
        }
        let model = self.console.setup().unwrap_or_default().memory.model;
        match read(path, &model) {
            Ok((opened, notices)) => {
                self.hand_over(opened, Command::Open);
                for notice in notices {
                    let _ = self.console.say.try_send(Notice::Said(notice));
                }
            }
            Err(error) => {
                let _ = self.console.say.try_send(Notice::Said(error.message()));
            }
        }
    }
}

impl Opener {
    /// Previews a program once, for its summary on the message line and for the extents of the
    /// graphic page. Reports its progress, and ends when the work limit is reached or another
    /// program is opened.
    fn look_through(&self, opened: &Opened) {
        let number = self.newest.fetch_add(1, Ordering::Relaxed) + 1;
        let is_newest = || self.newest.load(Ordering::Relaxed) == number;
        let tell = |notice: Notice| {
            let _ = self.console.say.try_send(notice);
        };
        let name = Path::new(&opened.name).file_name().unwrap_or_default();
        let name = name.to_string_lossy();
        let called = opened.program.number().or(number_of_name(&opened.name));
        let called = called.map_or_else(|| name.to_string(), |number| format!("O{number:04}"));
        let setup = selected(self.console.setup().unwrap_or_default(), opened);
        let limit = WorkLimit::new(BUDGET);
        let mut news_at = Instant::now() + NEWS;
        let mut given_up = false;
        let look = first_look::look(called, &setup, &mut |progress| {
            if Instant::now() >= news_at {
                news_at += NEWS;
                let time = clock(progress.time_s);
                let (line, moves) = (progress.line, progress.moves);
                let said = say::window_looks_through(&name, line, moves, time);
                tell(Notice::Said(said));
            }
            given_up = !limit.allows(progress);
            !given_up && is_newest()
        });
        if !is_newest() {
            return;
        }
        if let Some((least, greatest)) = look.extents() {
            self.console.send(Command::Fit { least, greatest });
        }
        tell(match given_up {
            true => Notice::Said(say::window_no_extents(&name)),
            false => Notice::Looked(name.into_owned(), Box::new(look)),
        });
    }
}

/// The setup with the opened program selected, and with the subprograms of its folder that the
/// memory does not have.
fn selected(mut setup: Setup, opened: &Opened) -> Setup {
    let programs = &mut setup.memory.programs;
    for program in &opened.subprograms {
        let known = |number| programs.stored(number).is_some();
        if !program.number().is_some_and(known) {
            // A program that does not fit into the memory is missing here as in the control.
            let _ = programs.store(program.text());
        }
    }
    programs.open_external(opened.program.clone());
    programs.select(ProgramId::External);
    setup
}

/// Reads a program file and the subprograms in its folder. Also returns the notices about
/// them.
pub fn read(path: &Path, model: &ControlModel) -> Result<(Opened, Vec<Message>), LoadError> {
    let mut programs = ProgramMemory::default();
    let (program, notices) = loading::open_into(&mut programs, model, path, &[])?;
    let subprograms = programs
        .iter()
        .map(|(_, program)| program.clone())
        .collect();
    let name = path.display().to_string();
    Ok((
        Opened {
            name,
            path: Some(path.to_owned()),
            storing: Storing::Ask,
            program,
            subprograms,
        },
        notices.0,
    ))
}
