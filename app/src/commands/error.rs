//! Why a command cannot be carried out.

use std::io;
use std::path::PathBuf;

use gsk_link::LinkConfigError;
use gsk_panel::script::ScriptError;
use gsk_runner::execution::ExecutionError;
use gsk_runner::picture::{NoPicture, PictureError};

use crate::apart::ApartError;
use crate::board::BoardError;
use crate::ending::SignalError;
use crate::files::data_dir::DataError;
use crate::files::program_file::FileError;
use crate::guard::holder::NoProgram;
use crate::loading::LoadError;
use crate::output::WriteError;
use crate::picture::NameError;
use crate::ports::PortError;
use crate::setup_args::SetByTheMachine;
use crate::transfer::TransferError;

/// Why a command cannot be carried out, or has failed beside what it is for.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// A result would overwrite what is read.
    #[error(transparent)]
    Apart(#[from] ApartError),
    /// A board that is not spoken to.
    #[error(transparent)]
    Board(#[from] BoardError),
    /// A data directory.
    #[error(transparent)]
    Data(#[from] DataError),
    /// A program that is not executed.
    #[error(transparent)]
    Execution(#[from] ExecutionError),
    /// A file.
    #[error(transparent)]
    File(#[from] FileError),
    /// What does not become JSON.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// The section `link` of a machine file.
    #[error(transparent)]
    Link(#[from] LinkConfigError),
    /// What the control starts from.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A name that is none of a picture.
    #[error(transparent)]
    Name(#[from] NameError),
    /// The same, by its ending.
    #[error(transparent)]
    Ending(#[from] NoPicture),
    /// A port is to be held for nobody.
    #[error(transparent)]
    NoProgram(#[from] NoProgram),
    /// A picture that is not made.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A port.
    #[error(transparent)]
    Port(#[from] PortError),
    /// An open port that has gone.
    #[error(transparent)]
    Gone(io::Error),
    /// An option that a real machine does not take.
    #[error(transparent)]
    SetByTheMachine(#[from] SetByTheMachine),
    /// Signals.
    #[error(transparent)]
    Signals(#[from] SignalError),
    /// What came through the serial port.
    #[error(transparent)]
    Transfer(#[from] TransferError),
    /// A result.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Output that goes to several places.
    #[error("the output cannot be written: {0}")]
    Output(io::Error),
    /// A script that cannot be read.
    #[error("{}", in_file(.path, .errors))]
    Script {
        /// Its file.
        path: PathBuf,
        /// Its lines.
        errors: Vec<ScriptError>,
    },
    /// A page that is not there.
    #[error("there is no page `{name}`; the pages are: {pages}")]
    NoPage {
        /// What was asked for.
        name: String,
        /// What there is.
        pages: String,
    },
    /// A part after the other needs somebody.
    #[error(
        "--parts {0}: with --link somebody has to allow each part, and standard input is no \
         terminal; make one part, or begin the program at the panel"
    )]
    Unattended(u32),
    /// Moves of several programs.
    #[error("--moves takes one program")]
    OneProgram,
    /// Another file ended the work.
    #[error("this file was not checked")]
    NotChecked,
    /// No board.
    #[error("no port: name one, or the section `link` in the file given with --machine")]
    NoPort,
    /// A feed above what a board makes.
    #[error(
        "{feed} mm/min are {rate:.0} pulses a second of Z, the board makes {most:.0}: a lower \
         --feed"
    )]
    TooFast {
        /// mm/min.
        feed: f64,
        /// Pulses a second.
        rate: f64,
        /// Pulses a second that the board makes.
        most: f64,
    },
    /// A board that moves, or is locked.
    #[error("the board does not stand still, or stays locked")]
    NotStill,
    /// A program that is not there.
    #[error("{}: there is no such file", .0.display())]
    NoFile(PathBuf),
    /// What could not be saved, a sentence a line.
    #[error("{0}")]
    NotSaved(String),
    /// Several at once.
    #[error("{}", lines(.0))]
    Several(Vec<CommandError>),
}

fn in_file(path: &std::path::Path, errors: &[ScriptError]) -> String {
    let lines = errors.iter();
    let lines: Vec<String> = lines
        .map(|error| format!("{}: {error}", path.display()))
        .collect();
    lines.join("\n")
}

fn lines(errors: &[CommandError]) -> String {
    let lines: Vec<String> = errors.iter().map(ToString::to_string).collect();
    lines.join("\n")
}
