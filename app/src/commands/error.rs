//! The errors of commands.

use std::io;

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
use gsk_plot::{PictureError, UnknownPictureFormat};
use gsk_runner::execution::ExecutionError;

use crate::picture::PictureNameError;

/// The reason why a command failed.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum CommandError {
    /// A file transfer with the control failed. The commands that transfer decide by the error
    /// whether they try again.
    Files(#[from] FilesError),
    /// Any other failure, as the message that ends the command.
    Failed(Message),
}

impl CommandError {
    /// Returns the message that the command prints.
    pub fn message(&self) -> Message {
        match self {
            Self::Files(error) => error.message(),
            Self::Failed(message) => message.clone(),
        }
    }

    /// Creates the error for a port or stream that failed after it had been opened.
    pub fn gone(error: io::Error) -> Self {
        Self::Failed(say::as_written(error))
    }

    /// Creates the error for a stream of results, such as moves, that cannot be written.
    pub fn output(error: io::Error) -> Self {
        Self::Failed(say::command_output_lost(error))
    }

    /// Creates the error for several independent failures, each in a separate line.
    pub fn several(errors: &[Self]) -> Self {
        Self::Failed(join_lines(errors.iter().map(Self::message)))
    }
}

impl From<Message> for CommandError {
    fn from(message: Message) -> Self {
        Self::Failed(message)
    }
}

impl From<CommandError> for Message {
    fn from(error: CommandError) -> Self {
        error.message()
    }
}

impl From<PcError> for CommandError {
    fn from(error: PcError) -> Self {
        match error {
            PcError::Port(error) => error.into(),
            PcError::Files(error) => error.into(),
            PcError::File(error) => error.into(),
            PcError::Write(error) => error.into(),
        }
    }
}

/// Lets `?` end a command with errors that have a message of their own.
macro_rules! end_with_the_message_of {
    ($($error:ty),* $(,)?) => {
        $(impl From<$error> for CommandError {
            fn from(error: $error) -> Self {
                Self::Failed(error.message())
            }
        })*
    };
}

end_with_the_message_of! {
    BoardError,
    DataDirError,
    ExecutionError,
    JobError,
    LoadError,
    MachineStateOption,
    NoProgram,
    NotSaved,
    OverwriteError,
    PictureError,
    PictureNameError,
    PortError,
    ProgramFileError,
    ProjectError,
    SignalError,
    TransferError,
    UnknownPictureFormat,
    WriteError,
}

/// Lets `?` end a command with errors that are printed in their own words.
macro_rules! end_with_the_words_of {
    ($($error:ty),* $(,)?) => {
        $(impl From<$error> for CommandError {
            fn from(error: $error) -> Self {
                Self::Failed(say::as_written(error))
            }
        })*
    };
}

end_with_the_words_of! { LinkConfigError, serde_json::Error }
