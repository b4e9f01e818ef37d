//! Errors of file transfer through the serial port.

use std::io;
use std::path::{Path, PathBuf};

use gsk_messages::{Message, say};
use gsk_transfer::{ConnectionLoss, FileName, FileNameError, InvalidCharacter, TransferFault};

use crate::files::program_file::ProgramFileError;
use crate::output::WriteError;
use crate::ports::{self, PortError};

/// The reason why a transfer command has failed.
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
    /// Returns the message for the operator: why the transfer command has failed.
    pub fn message(&self) -> Message {
        match self {
            Self::Port(error) => error.message(),
            Self::Files(error) => error.message(),
            Self::File(error) => error.message(),
            Self::Write(error) => error.message(),
        }
    }

    /// Whether the connection with the control or the port is lost.
    pub const fn ends_connection(&self) -> bool {
        matches!(
            self,
            Self::Port(_) | Self::Files(FilesError::Lost(_) | FilesError::Gone(_))
        )
    }
}

/// The reason why a file transfer has failed.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum FilesError {
    /// There is no connection with the control, or the connection was lost.
    Lost(#[from] ConnectionLoss),
    /// The port failed after it had been opened, for example because it was unplugged.
    Gone(io::Error),
    /// The operator has cancelled the transfer.
    Cancelled,
    /// The control refuses a command about a file.
    Refused {
        /// Name of the file at the control.
        name: FileName,
        /// The reason why the control refuses the command.
        fault: TransferFault,
    },
    /// The received bytes do not form a text.
    Noise,
    /// A received text ended before its end mark.
    Broken,
    /// No byte arrived within this time, s.
    NothingReceived(u64),
    /// The other end has held the line (DC3) for this time, s.
    LineStopped(u64),
    /// Some of several files failed; each failure was reported before.
    SomeFailed,
    /// The file has no name at the control: neither its name nor its text gives one.
    NoName(PathBuf),
    /// The control does not permit this file name.
    Name(#[from] FileNameError),
    /// Two files would have the same name at the control.
    DuplicateName {
        /// The name that two files would get at the control.
        name: FileName,
        /// Path of the first file on the PC.
        first: PathBuf,
        /// Path of the second file on the PC.
        second: PathBuf,
    },
    /// A file of this path already exists on the PC.
    Exists(PathBuf),
    /// The name is taken at the control, and there is no terminal at which to query the
    /// operator.
    NoTerminal(FileName),
    /// No program number is free to replace this name, which the control does not permit.
    NoFreeName(FileName),
    /// The folder at this path has no files for the control.
    Empty(PathBuf),
    /// A program contains a character outside ASCII.
    NotText {
        /// Path of the program on the PC.
        file: PathBuf,
        /// The character outside ASCII and its position.
        error: InvalidCharacter,
    },
}

impl FilesError {
    /// Whether the line or the control is the cause, and not the command and its files.
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

    /// Returns the message for the operator: why the file transfer has failed.
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
