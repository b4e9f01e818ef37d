//! Errors of file transfer through the serial port.

use std::io;
use std::path::{Path, PathBuf};

use gsk_messages::{Message, say};
use gsk_transfer::{ConnectionLoss, FileName, FileNameError, InvalidCharacter, TransferFault};

use crate::files::program_file::ProgramFileError;
use crate::output::WriteError;
use crate::ports::{self, PortError};

/// Why a transfer command has failed.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum PcError {
    /// The port cannot be opened.
    Port(#[from] PortError),
    /// The transfer through the port has failed.
    Files(#[from] FilesError),
    /// A file of the PC cannot be read.
    File(#[from] ProgramFileError),
    /// A file of the PC cannot be written.
    Write(#[from] WriteError),
}

impl PcError {
    /// Returns the message for the operator.
    pub fn message(&self) -> Message {
        match self {
            Self::Port(error) => error.message(),
            Self::Files(error) => error.message(),
            Self::File(error) => error.message(),
            Self::Write(error) => error.message(),
        }
    }

    /// Whether the connection or the port is lost.
    pub const fn ends_connection(&self) -> bool {
        matches!(
            self,
            Self::Port(_) | Self::Files(FilesError::Lost(_) | FilesError::Gone(_))
        )
    }
}

/// Why a file transfer has failed.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum FilesError {
    /// There is no connection with the control, or it was lost.
    Lost(#[from] ConnectionLoss),
    /// The open port has failed.
    Gone(io::Error),
    /// The operator has cancelled it.
    Cancelled,
    /// The control refuses it.
    Refused {
        /// The file at the control.
        name: FileName,
        /// The reason.
        fault: TransferFault,
    },
    /// The received bytes are no text.
    Noise,
    /// A text ended before its last character.
    Broken,
    /// No byte arrived within this time, s.
    NothingReceived(u64),
    /// The other end stopped the line for this time, s.
    LineStopped(u64),
    /// Some of several files failed; each has been reported.
    SomeFailed,
    /// A file that has no name at the control.
    NoName(PathBuf),
    /// A name that the control does not permit.
    Name(#[from] FileNameError),
    /// Two files of the same name.
    DuplicateName {
        /// The name at the control.
        name: FileName,
        /// The first file.
        first: PathBuf,
        /// The second file.
        second: PathBuf,
    },
    /// The file already exists.
    Exists(PathBuf),
    /// The name is taken and there is no terminal to query the operator.
    NoTerminal(FileName),
    /// No program number is free.
    NoFreeName(FileName),
    /// The folder has no files for the control.
    Empty(PathBuf),
    /// A program contains a character outside ASCII.
    NotText {
        /// The file.
        file: PathBuf,
        /// The character and its position.
        error: InvalidCharacter,
    },
}

impl FilesError {
    /// Whether the cause is the line or the control, not the command and its files.
    pub const fn is_line_error(&self) -> bool {
        matches!(
            self,
            Self::Lost(_)
                | Self::Gone(_)
                | Self::Cancelled
                | Self::Refused { .. }
                | Self::Noise
                | Self::Broken
                | Self::NothingReceived(_)
                | Self::LineStopped(_)
                | Self::SomeFailed
        )
    }

    /// Returns the message for the operator.
    pub fn message(&self) -> Message {
        let path = |path: &Path| path.display().to_string();
        match self {
            Self::Lost(loss) => loss.message(),
            Self::Gone(error) => ports::failure_message(error),
            Self::Cancelled => say::transfer_cancelled(),
            Self::Refused { name, fault } => say::subject_reason(name, fault.message()),
            Self::Noise => say::transfer_text_noise(),
            Self::Broken => say::transfer_text_broken(),
            Self::NothingReceived(seconds) => say::transfer_nothing_came(seconds),
            Self::LineStopped(seconds) => say::transfer_stopped_long(seconds),
            Self::SomeFailed => say::transfer_not_all(),
            Self::NoName(file) => say::transfer_no_name_for(path(file)),
            Self::Name(error) => error.message(),
            Self::DuplicateName {
                name,
                first,
                second,
            } => say::transfer_twice(name, path(first), path(second)),
            Self::Exists(file) => say::transfer_file_there(path(file)),
            Self::NoTerminal(name) => say::transfer_no_terminal(name),
            Self::NoFreeName(name) => say::transfer_no_free_name(name),
            Self::Empty(folder) => say::transfer_folder_empty(path(folder)),
            Self::NotText { file, error } => say::subject_reason(path(file), error.message()),
        }
    }
}
