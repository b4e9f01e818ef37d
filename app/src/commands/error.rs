//! Why a command cannot be carried out.

use std::io;
use std::path::PathBuf;

use gsk_link::LinkConfigError;
use gsk_messages::{Message, say};
use gsk_panel::script::ScriptError;
use gsk_runner::execution::ExecutionError;
use gsk_runner::picture::{NoPicture, PictureError};

use crate::apart::ApartError;
use crate::board::BoardError;
use crate::ending::SignalError;
use crate::files::data_dir::DataError;
use crate::files::program_file::FileError;
use crate::guard::holder::NoProgram;
use crate::job::JobError;
use crate::loading::LoadError;
use crate::output::WriteError;
use crate::pc::{FilesError, PcError};
use crate::picture::NameError;
use crate::ports::PortError;
use crate::project::ProjectError;
use crate::retained::NotSaved;
use crate::saying::lines;
use crate::setup_args::SetByTheMachine;
use crate::transfer::TransferError;

/// Why a command cannot be carried out, or has failed beside what it is for.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum CommandError {
    /// A result would overwrite what is read.
    Apart(#[from] ApartError),
    /// A board that is not spoken to.
    Board(#[from] BoardError),
    /// A data directory.
    Data(#[from] DataError),
    /// A program that is not executed.
    Execution(#[from] ExecutionError),
    /// Messages of an editor that are none, or an editor that has gone.
    Editor(String),
    /// A file.
    File(#[from] FileError),
    /// A job.
    Job(#[from] JobError),
    /// What does not become JSON.
    Json(#[from] serde_json::Error),
    /// A lesson.
    Lesson(Message),
    /// The section `link` of a machine file.
    Link(#[from] LinkConfigError),
    /// What the control starts from.
    Load(#[from] LoadError),
    /// A name that is none of a picture.
    Name(#[from] NameError),
    /// The same, by its ending.
    Ending(#[from] NoPicture),
    /// A port is to be held for nobody.
    NoProgram(#[from] NoProgram),
    /// A measurement of pitch errors.
    Pitch(Message),
    /// A picture that is not made.
    Picture(#[from] PictureError),
    /// A port.
    Port(#[from] PortError),
    /// A project.
    Project(#[from] ProjectError),
    /// An open port that has gone.
    Gone(io::Error),
    /// An option that a real machine does not take.
    SetByTheMachine(#[from] SetByTheMachine),
    /// Signals.
    Signals(#[from] SignalError),
    /// What came through the serial port.
    Transfer(#[from] TransferError),
    /// Files that were to go through it.
    Files(#[from] FilesError),
    /// A result.
    Write(#[from] WriteError),
    /// Output that goes to several places.
    Output(io::Error),
    /// A script that cannot be read.
    Script {
        /// Its file.
        path: PathBuf,
        /// Its lines.
        errors: Vec<ScriptError>,
    },
    /// Help that there is none for.
    NoTopic(String),
    /// A page that is not there.
    NoPage {
        /// What was asked for.
        name: String,
        /// What there is.
        pages: String,
    },
    /// A part after the other needs somebody.
    Unattended(u32),
    /// Moves of several programs.
    OneProgram,
    /// Parts of several programs.
    OneSection,
    /// Another file ended the work.
    NotChecked,
    /// A port for two things.
    SamePort(String),
    /// The questions of the first start, one of them which lathe, at a lathe's own port.
    FirstStartAtBoard,
    /// No board.
    NoPort,
    /// No port of the PC's side, and the window has had none.
    NoTransferPort,
    /// A feed above what a board makes.
    TooFast {
        /// mm/min.
        feed: f64,
        /// Pulses a second.
        rate: f64,
        /// Pulses a second that the board makes.
        most: f64,
    },
    /// A board that moves, or is locked.
    NotStill,
    /// A program that is not there.
    NoFile(PathBuf),
    /// What could not be saved.
    NotSaved(#[from] NotSaved),
    /// Several at once.
    Several(Vec<CommandError>),
}

impl From<PcError> for CommandError {
    fn from(error: PcError) -> Self {
        match error {
            PcError::Port(error) => Self::Port(error),
            PcError::Files(error) => Self::Files(error),
            PcError::File(error) => Self::File(error),
            PcError::Write(error) => Self::Write(error),
        }
    }
}

impl From<CommandError> for Message {
    fn from(error: CommandError) -> Self {
        error.message()
    }
}

impl CommandError {
    /// What is said of it.
    pub fn message(&self) -> Message {
        match self {
            Self::Apart(error) => error.message(),
            Self::Board(error) => error.message(),
            Self::Data(error) => error.message(),
            Self::Execution(error) => error.message(),
            Self::Editor(reason) => say::lsp_ended(reason),
            Self::File(error) => error.message(),
            Self::Job(error) => error.message(),
            Self::Lesson(said) | Self::Pitch(said) => said.clone(),
            Self::Json(error) => say::as_written(error),
            Self::Link(error) => say::as_written(error),
            Self::Load(error) => error.message(),
            Self::Name(error) => error.message(),
            Self::Ending(error) => error.message(),
            Self::NoProgram(error) => error.message(),
            Self::Picture(error) => error.message(),
            Self::Port(error) => error.message(),
            Self::Project(error) => error.message(),
            Self::Gone(error) => say::as_written(error),
            Self::SetByTheMachine(option) => option.message(),
            Self::Signals(error) => error.message(),
            Self::Transfer(error) => error.message(),
            Self::Files(error) => error.message(),
            Self::Write(error) => error.message(),
            Self::Output(error) => say::command_output_lost(error),
            Self::Script { path, errors } => {
                let name = path.display();
                let errors = errors.iter().map(ScriptError::message);
                lines(errors.map(|error| say::subject_reason(&name, error)))
            }
            Self::NoTopic(question) => say::help_nothing(question),
            Self::NoPage { name, pages } => say::command_no_page(name, pages),
            Self::Unattended(parts) => say::command_parts_unattended(parts),
            Self::OneProgram => say::command_one_program(),
            Self::OneSection => say::command_one_section(),
            Self::NotChecked => say::command_not_checked(),
            Self::SamePort(port) => say::serial_and_dnc(port),
            Self::FirstStartAtBoard => say::first_start_at_board(),
            Self::NoPort => say::command_no_port(),
            Self::NoTransferPort => say::transfer_no_port(),
            Self::TooFast { feed, rate, most } => say::command_feed_too_high(feed, rate, most),
            Self::NotStill => say::command_board_moves(),
            Self::NoFile(path) => say::subject_reason(path.display(), say::file_not_there()),
            Self::NotSaved(error) => error.message(),
            Self::Several(errors) => lines(errors.iter().map(Self::message)),
        }
    }
}
