//! What can go wrong in a task.

use std::io;
use std::path::PathBuf;
use std::process::ExitStatus;

use thiserror::Error;

/// A task that was not done.
#[derive(Debug, Error)]
pub enum TaskError {
    /// A command cannot be started.
    #[error("{line}: {error}")]
    Start {
        /// The command.
        line: String,
        /// Why.
        error: io::Error,
    },
    /// A command failed.
    #[error("{line}: {status}")]
    Failed {
        /// The command.
        line: String,
        /// How it ended.
        status: ExitStatus,
    },
    /// The path of a case has not three parts.
    #[error("{0}: a case is subject/code/name, for instance cycles/G71/roughing-small-step")]
    CaseParts(String),
    /// The path of a case has other characters.
    #[error("{0}: letters, digits and hyphens only")]
    CaseCharacters(String),
    /// The folder of a new case exists.
    #[error("{} is there already", .0.display())]
    Exists(PathBuf),
    /// A folder or file cannot be read or written.
    #[error("{}: {error}", path.display())]
    Write {
        /// The folder or file.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// What is needed for another system is not installed.
    #[error("the program for {system} is not built: {missing} is missing; {cure}")]
    Tools {
        /// The system it is built for.
        system: &'static str,
        /// The first thing that is missing.
        missing: String,
        /// How it comes.
        cure: &'static str,
    },
    /// What is given to users is too large.
    #[error("{}: {size} bytes are more than {largest}", path.display())]
    Large {
        /// The file.
        path: PathBuf,
        /// Its size, bytes.
        size: u64,
        /// The largest that it may have.
        largest: u64,
    },
    /// The changelog does not know the version.
    #[error("CHANGELOG.md has no heading `## [{0}] – YYYY-MM-DD`")]
    NoHeading(String),
    /// A program that is not understood.
    #[error("{}: {why}", path.display())]
    Program {
        /// The program.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// An archive cannot be written.
    #[error("{}: {error}", path.display())]
    Archive {
        /// The archive.
        path: PathBuf,
        /// Why.
        error: zip::result::ZipError,
    },
}
