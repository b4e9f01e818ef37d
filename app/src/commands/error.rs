//! The errors of commands.

use std::io;
use std::path::PathBuf;

use gsk_host::board::BoardError;
use gsk_host::files::data_dir::DataDirError;
use gsk_host::files::overwrite_guard::OverwriteError;
use gsk_host::files::program_file::ProgramFileError;
use gsk_host::guard::holder::NoProgram;
use gsk_host::job::JobError;
use gsk_host::loading::LoadError;
use gsk_host::message_format::join_lines;
use gsk_host::output::WriteError;
use gsk_host::pc::{FilesError, PcError};
use gsk_host::ports::PortError;
use gsk_host::project::ProjectError;
use gsk_host::retained::NotSaved;
use gsk_host::setup_args::MachineStateOption;
use gsk_host::termination::SignalError;
use gsk_host::transfer::TransferError;
use gsk_link::LinkConfigError;
use gsk_messages::{Message, say};
use gsk_panel::script::ScriptError;
use gsk_runner::execution::ExecutionError;
use gsk_runner::picture::{PictureError, UnknownPictureFormat};

use crate::picture::PictureNameError;

/// Why a command failed, or an error besides its main task.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum CommandError {
    /// A result would overwrite a file that the command reads.
    Overwrite(#[from] OverwriteError),
    /// The board cannot be opened.
    Board(#[from] BoardError),
    /// The data directory cannot be used.
    Data(#[from] DataDirError),
    /// The program cannot be executed.
    Execution(#[from] ExecutionError),
    /// An option that breaks, watches or traces a run is wrong; holds the rule.
    Debug(Message),
    /// The debug client sent a malformed message or closed the connection; holds the reason.
    DebugClient(String),
    /// The editor sent a malformed message or closed the connection; holds the reason.
    Editor(String),
    /// A program file cannot be read.
    File(#[from] ProgramFileError),
    /// No job was found or guessed for the program, or the job file is faulty.
    Job(#[from] JobError),
    /// A result cannot be written as JSON.
    Json(#[from] serde_json::Error),
    /// A lesson is unknown or its file is faulty; holds the reason.
    Lesson(Message),
    /// The section `link` of the machine file is invalid.
    Link(#[from] LinkConfigError),
    /// The initial state of the control cannot be loaded.
    Load(#[from] LoadError),
    /// The name of the output file is not that of a picture.
    Name(#[from] PictureNameError),
    /// The extension of the output file is not one of a picture format.
    Ending(#[from] UnknownPictureFormat),
    /// `hold-port` has no parent program that needs the port.
    NoProgram(#[from] NoProgram),
    /// A measurement of pitch errors cannot be used; holds the reason.
    Pitch(Message),
    /// The picture cannot be drawn or written.
    Picture(#[from] PictureError),
    /// A serial port cannot be opened.
    Port(#[from] PortError),
    /// The project cannot be read or written.
    Project(#[from] ProjectError),
    /// A port or stream failed after it had been opened.
    Gone(io::Error),
    /// An option contradicts the state of a connected machine.
    SetByTheMachine(#[from] MachineStateOption),
    /// The signal handlers cannot be installed.
    Signals(#[from] SignalError),
    /// A file that the control has sent cannot be written.
    Transfer(#[from] TransferError),
    /// A file transfer with the control failed.
    Files(#[from] FilesError),
    /// A result file cannot be written.
    Write(#[from] WriteError),
    /// A stream of results, such as moves, cannot be written.
    Output(io::Error),
    /// The script cannot be parsed.
    Script {
        path: PathBuf,
        /// One error for each faulty line.
        errors: Vec<ScriptError>,
    },
    /// No help topic matches the question, which the payload quotes.
    NoTopic(String),
    /// No LCD page has the requested name.
    NoPage {
        name: String,
        /// The names of all pages, for the message.
        pages: String,
    },
    /// Several parts (the payload is their number) are requested at a real machine, but there
    /// is no operator at a terminal.
    Unattended(u32),
    /// `--moves` was given with several programs; it takes only one.
    OneProgram,
    /// `--section` was given with several programs; it takes only one.
    OneSection,
    /// This file was not checked, because an error in another file ended the check.
    NotChecked,
    /// The serial line and DNC are given the same port, whose name is the payload.
    SamePort(String),
    /// `--first-start` was given, but a board is connected: the questions would choose another
    /// lathe.
    FirstStartAtBoard,
    /// Neither the command line nor the machine file names a board's port.
    NoPort,
    /// Neither the command line nor the window's settings name a port of the PC.
    NoTransferPort,
    /// The feed requires more pulses per second than the board can make.
    TooFast {
        /// Feed in mm/min.
        feed: f64,
        /// Pulse rate that the feed requires, pulses per second.
        rate: f64,
        /// Maximum pulse rate of the board, pulses per second.
        most: f64,
    },
    /// The board cannot begin a test move: it is moving or locked.
    NotStill,
    /// The program file at this path does not exist.
    NoFile(PathBuf),
    /// The memory of the control cannot be saved.
    NotSaved(#[from] NotSaved),
    /// Several independent errors.
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
    pub fn message(&self) -> Message {
        match self {
            Self::Overwrite(error) => error.message(),
            Self::Board(error) => error.message(),
            Self::Data(error) => error.message(),
            Self::Execution(error) => error.message(),
            Self::Editor(reason) => say::lsp_ended(reason),
            Self::File(error) => error.message(),
            Self::Job(error) => error.message(),
            Self::Debug(message) | Self::Lesson(message) | Self::Pitch(message) => message.clone(),
            Self::DebugClient(reason) => say::dap_ended(reason),
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
                join_lines(errors.map(|error| say::subject_reason(&name, error)))
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
            Self::Several(errors) => join_lines(errors.iter().map(Self::message)),
        }
    }
}
