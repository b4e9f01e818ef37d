//! Errors of the tasks.

use std::io;
use std::path::PathBuf;
use std::process::ExitStatus;

use thiserror::Error;

/// Why a task failed.
#[derive(Debug, Error)]
pub enum TaskError {
    /// A command cannot be started.
    #[error("{line}: {error}")]
    Start {
        /// The command.
        line: String,
        /// The cause.
        error: io::Error,
    },
    /// A command failed.
    #[error("{line}: {status}")]
    Failed {
        /// The command.
        line: String,
        /// Its exit status.
        status: ExitStatus,
    },
    /// The path of a case does not have three parts.
    #[error("{0}: a case is subject/code/name, for instance cycles/G71/roughing-small-step")]
    CaseParts(String),
    /// The path of a case has a forbidden character.
    #[error("{0}: letters, digits and hyphens only")]
    CaseCharacters(String),
    /// The folder of a new case exists.
    #[error("{} exists already", .0.display())]
    Exists(PathBuf),
    /// A folder or file cannot be read or written.
    #[error("{}: {error}", path.display())]
    Write {
        /// The folder or file.
        path: PathBuf,
        /// The cause.
        error: io::Error,
    },
    /// A tool for building the program for a system is not installed.
    #[error("the program for {system} is not built: {missing} is missing; {cure}")]
    Tools {
        /// The target system.
        system: &'static str,
        /// The first missing tool or file.
        missing: String,
        /// How to install it.
        cure: &'static str,
    },
    /// A release file is too large.
    #[error("{}: {size} bytes are more than {largest}", path.display())]
    Large {
        /// The file.
        path: PathBuf,
        /// Its size, bytes.
        size: u64,
        /// The limit, bytes.
        largest: u64,
    },
    /// The changelog has no section of the version.
    #[error("CHANGELOG.md has no heading `## [{0}] – YYYY-MM-DD`")]
    NoHeading(String),
    /// The requirements of a program cannot be read.
    #[error("{}: {why}", path.display())]
    Program {
        /// The program.
        path: PathBuf,
        /// The reason.
        why: String,
    },
    /// An archive cannot be written.
    #[error("{}: {error}", path.display())]
    Archive {
        /// The archive.
        path: PathBuf,
        /// The cause.
        error: zip::result::ZipError,
    },
}
