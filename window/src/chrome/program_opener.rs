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
use gsk_host::kernel::{Command, Console, Notice, OpenedProgram, StorePolicy};
use gsk_host::loading::LoadError;
use gsk_host::preview::work_limit::WorkLimit;
use gsk_host::{loading, transfer};
use gsk_panel::emulator::number_of_name;
use gsk_runner::program_summary;
use gsk_runner::text_format::format_time;
use web_time::{Duration, Instant};

use crate::samples::SampleRequest;
use crate::widgets::files::{self, FileChoice};
use gsk_messages::{Language, Message, say};

/// Opens programs in the control and previews them for the message line.
#[derive(Clone, Debug)]
pub struct ProgramOpener {
    console: Console,
    /// Number of the program that was opened last; the preview of an earlier one ends.
    newest_number: Arc<AtomicU64>,
}

/// Limit of the work of one preview.
const PREVIEW_BUDGET: WorkBudget = WorkBudget::interactive(50_000_000);

/// Interval between two progress messages of a preview.
const PROGRESS_INTERVAL: Duration = Duration::from_secs(2);

impl ProgramOpener {
    /// Creates an opener that sends programs to `console`.
    pub fn new(console: Console) -> Self {
        Self {
            console,
            newest_number: Arc::default(),
        }
    }

    /// Shows a file dialog and opens the chosen program.
    pub fn choose(&self, language: Language, context: &egui::Context) {
        let opener = self.clone();
        let name = say::window_part_programs().text(language);
        let wanted = FileChoice::Open(name, vec!["cnc", "nc", "txt", "tap"]);
        files::choose_file(
            context,
            language,
            &self.console.notice_sender,
            wanted,
            move |path| {
                opener.read_and_send(&path);
                None
            },
        );
    }

    /// Opens a program file, or receives a data file, in a thread.
    pub fn open(&self, path: PathBuf, context: &egui::Context) {
        let opener = self.clone();
        files::run_in_thread(context, &self.console.notice_sender, move || {
            opener.read_and_send(&path);
            None
        });
    }

    /// Opens a sample program, and starts it if `request.starts` is set.
    pub fn open_sample(&self, request: SampleRequest, context: &egui::Context) {
        let opener = self.clone();
        files::run_in_thread(context, &self.console.notice_sender, move || {
            let opened = request.sample.to_opened();
            let starts = request.starts;
            opener.hand_over(opened, |program| Command::OpenSample { program, starts });
            None
        });
    }

    /// Sends a program to the control with `command` and previews it.
    fn hand_over(
        &self,
        opened: OpenedProgram,
        command: impl FnOnce(Box<OpenedProgram>) -> Command,
    ) {
        let previewed = opened.clone();
        // The queue has a slot for a program: the kernel empties it continuously.
        let _ = self.console.commands.send(command(Box::new(opened)));
        self.preview(&previewed);
    }

    fn read_and_send(&self, path: &Path) {
        if transfer::is_data_file(path) {
            match transfer::read_serial_file(path) {
                Ok(file) => self.console.send(Command::Receive(Box::new(file))),
                Err(error) => {
                    let _ = self
                        .console
                        .notice_sender
                        .try_send(Notice::Message(error.message()));
                }
            }
            return;
        }
        let model = self.console.setup().unwrap_or_default().memory.model;
        match read_program(path, &model) {
            Ok((opened, notices)) => {
                self.hand_over(opened, Command::Open);
                for notice in notices {
                    let _ = self.console.notice_sender.try_send(Notice::Message(notice));
                }
            }
            Err(error) => {
                let _ = self
                    .console
                    .notice_sender
                    .try_send(Notice::Message(error.message()));
            }
        }
    }
}

impl ProgramOpener {
    /// Previews a program once, for its summary on the message line and for the extents of the
    /// graphic page. Reports its progress, and ends when the work limit is reached or another
    /// program is opened.
    fn preview(&self, opened: &OpenedProgram) {
        let number = self.newest_number.fetch_add(1, Ordering::Relaxed) + 1;
        let is_newest = || self.newest_number.load(Ordering::Relaxed) == number;
        let notify = |notice: Notice| {
            let _ = self.console.notice_sender.try_send(notice);
        };
        let name = Path::new(&opened.name).file_name().unwrap_or_default();
        let name = name.to_string_lossy();
        let program_name = opened.program.number().or(number_of_name(&opened.name));
        let called = |number| self.console.naming().name(number);
        let called = program_name.map_or_else(|| name.to_string(), called);
        let setup = select_opened(self.console.setup().unwrap_or_default(), opened);
        let limit = WorkLimit::new(PREVIEW_BUDGET);
        let mut next_progress = Instant::now() + PROGRESS_INTERVAL;
        let mut is_over_limit = false;
        let summary = program_summary::summarize(called, &setup, &mut |progress| {
            if Instant::now() >= next_progress {
                next_progress += PROGRESS_INTERVAL;
                let time = format_time(progress.time_s);
                let (line, moves) = (progress.line, progress.moves);
                let message = say::window_looks_through(&name, line, moves, time);
                notify(Notice::Message(message));
            }
            is_over_limit = !limit.allows(progress);
            !is_over_limit && is_newest()
        });
        if !is_newest() {
            return;
        }
        if let Some((least, greatest)) = summary.cut_extents() {
            self.console.send(Command::FitGraphic { least, greatest });
        }
        notify(match is_over_limit {
            true => Notice::Message(say::window_no_extents(&name)),
            false => Notice::Previewed(name.into_owned(), Box::new(summary)),
        });
    }
}

/// Adds the opened program to the setup and selects it; also adds those subprograms of its
/// folder that the memory does not have.
fn select_opened(mut setup: Setup, opened: &OpenedProgram) -> Setup {
    let programs = &mut setup.memory.programs;
    for program in &opened.subprograms {
        let is_stored = |number| programs.stored(number).is_some();
        if !program.number().is_some_and(is_stored) {
            // A program that does not fit into the memory is missing here as in the control.
            let _ = programs.store(program.text());
        }
    }
    programs.open_external(opened.program.clone());
    programs.select(ProgramId::External);
    setup
}

/// Reads a program file and the subprograms in its folder. Returns them with the notices for
/// the operator.
pub fn read_program(
    path: &Path,
    model: &ControlModel,
) -> Result<(OpenedProgram, Vec<Message>), LoadError> {
    let mut programs = ProgramMemory::default();
    let (program, notices) = loading::open_into(&mut programs, model, path, &[])?;
    let subprograms = programs
        .iter()
        .map(|(_, program)| program.clone())
        .collect();
    let name = path.display().to_string();
    Ok((
        OpenedProgram {
            name,
            path: Some(path.to_owned()),
            store_policy: StorePolicy::AskOperator,
            program,
            subprograms,
        },
        notices.0,
    ))
}
