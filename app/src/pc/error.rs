//! Why files do not go through the serial port.

use std::io;
use std::path::{Path, PathBuf};

use gsk_messages::{Message, say};
use gsk_transfer::{ConnectionLoss, FileName, FileNameError, InvalidCharacter, TransferFault};

use crate::files::program_file::FileError;
use crate::output::WriteError;
use crate::ports::{self, PortError};

/// Why the PC's side does not do what it is asked for.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum PcError {
    /// The port is not opened.
    Port(#[from] PortError),
    /// It does not go through the port.
    Files(#[from] FilesError),
    /// A file of the PC is not read.
    File(#[from] FileError),
    /// A file of the PC is not written.
    Write(#[from] WriteError),
}

impl PcError {
    /// What is said of it.
    pub fn message(&self) -> Message {
        match self {
            Self::Port(error) => error.message(),
            Self::Files(error) => error.message(),
            Self::File(error) => error.message(),
            Self::Write(error) => error.message(),
        }
    }

    /// There is no connection any more, or no port.
    pub const fn ends_connection(&self) -> bool {
        matches!(
            self,
            Self::Port(_) | Self::Files(FilesError::Lost(_) | FilesError::Gone(_))
        )
    }
}

/// Why files do not go through the serial port.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum FilesError {
    /// There is no connection with the control, or none any more.
    Lost(#[from] ConnectionLoss),
    /// The open port has gone.
    Gone(io::Error),
    /// The user has broken it off.
    Cancelled,
    /// The control refuses it.
    Refused {
        /// The file there.
        name: FileName,
        /// Why.
        fault: TransferFault,
    },
    /// What came is no text.
    Noise,
    /// A text ended in the middle.
    Broken,
    /// Nothing came within so many seconds.
    Nothing(u64),
    /// The other end held the line for so many seconds.
    HeldUp(u64),
    /// Something of several was not done; each has been said.
    Some,
    /// A file that has no name at the control.
    NoName(PathBuf),
    /// A name that the control cannot have.
    Name(#[from] FileNameError),
    /// A name twice.
    Twice {
        /// The name at the control.
        name: FileName,
        /// A file.
        first: PathBuf,
        /// Another one.
        second: PathBuf,
    },
    /// A file that is there already.
    There(PathBuf),
    /// A name that is taken, and nobody at a terminal.
    NobodyToAsk(FileName),
    /// No program number is free.
    NoFreeName(FileName),
    /// A folder without files for the control.
    Empty(PathBuf),
    /// A program with a character that is none of ASCII.
    NotText {
        /// The file.
        file: PathBuf,
        /// Where.
        error: InvalidCharacter,
    },
}

impl FilesError {
    /// Whether it is a matter of the line and the control, not of the call and its files.
    pub const fn is_of_the_line(&self) -> bool {
        matches!(
            self,
            Self::Lost(_)
                | Self::Gone(_)
                | Self::Cancelled
                | Self::Refused { .. }
                | Self::Noise
                | Self::Broken
                | Self::Nothing(_)
                | Self::HeldUp(_)
                | Self::Some
        )
    }

    /// What is said of it.
    pub fn message(&self) -> Message {
        let path = |path: &Path| path.display().to_string();
        match self {
            Self::Lost(loss) => loss.message(),
            Self::Gone(error) => ports::gone(error),
            Self::Cancelled => say::transfer_cancelled(),
            Self::Refused { name, fault } => say::subject_reason(name, fault.message()),
            Self::Noise => say::transfer_text_noise(),
            Self::Broken => say::transfer_text_broken(),
            Self::Nothing(seconds) => say::transfer_nothing_came(seconds),
            Self::HeldUp(seconds) => say::transfer_stopped_long(seconds),
            Self::Some => say::transfer_not_all(),
            Self::NoName(file) => say::transfer_no_name_for(path(file)),
            Self::Name(error) => error.message(),
            Self::Twice {
                name,
                first,
                second,
            } => say::transfer_twice(name, path(first), path(second)),
            Self::There(file) => say::transfer_file_there(path(file)),
            Self::NobodyToAsk(name) => say::transfer_nobody_to_ask(name),
            Self::NoFreeName(name) => say::transfer_no_free_name(name),
            Self::Empty(folder) => say::transfer_folder_empty(path(folder)),
            Self::NotText { file, error } => say::subject_reason(path(file), error.message()),
        }
    }
}
