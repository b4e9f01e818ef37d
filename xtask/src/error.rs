//! Errors of the tasks.

use std::io;
use std::path::PathBuf;
use std::process::ExitStatus;

use thiserror::Error;

/// The reason for which a development task failed.
#[derive(Debug, Error)]
pub enum TaskError {
    /// A command cannot be started, for instance because it is not installed.
    #[error("{line}: {error}")]
    Start {
        /// The command line that cannot be started.
        line: String,
        /// Error of the operating system.
        error: io::Error,
    },
    /// A command ended with an error.
    #[error("{line}: {status}")]
    Failed {
        /// The command line of the failed command.
        line: String,
        /// Exit status of the command.
        status: ExitStatus,
    },
    /// The path of a new case, which the payload quotes, does not have three parts.
    #[error("{0}: a case is subject/code/name, for instance cycles/G71/roughing-small-step")]
    CaseParts(String),
    /// The path of a new case, which the payload quotes, has a forbidden character.
    #[error("{0}: letters, digits and hyphens only")]
    CaseCharacters(String),
    /// The folder of a new case already exists.
    #[error("{} exists already", .0.display())]
    Exists(PathBuf),
    /// A folder or file cannot be read or written.
    #[error("{}: {error}", path.display())]
    Write {
        /// Path of the folder or file.
        path: PathBuf,
        /// Error of the operating system.
        error: io::Error,
    },
    /// A tool that is needed to build the program for a system is not installed.
    #[error("the program for {system} is not built: {missing} is missing; {cure}")]
    Tools {
        /// The target system.
        system: &'static str,
        /// The first missing tool or file.
        missing: String,
        /// An instruction that installs the missing tool.
        cure: &'static str,
    },
    /// A table of `assets/tables` has a fault.
    #[error("assets/tables/{table}: {fault}")]
    Table {
        /// Name of the table file.
        table: &'static str,
        /// The fault of the table, with its line.
        fault: String,
    },
    /// A release file exceeds its size limit.
    #[error("{}: {size} bytes are more than {largest}", path.display())]
    Large {
        /// Path of the file.
        path: PathBuf,
        /// Size of the file, bytes.
        size: u64,
        /// Size limit of the file, bytes.
        largest: u64,
    },
    /// The changelog has no section of this version.
    #[error("CHANGELOG.md has no heading `## [{0}] – YYYY-MM-DD`")]
    NoHeading(String),
    /// The requirements of a program cannot be read.
    #[error("{}: {why}", path.display())]
    Program {
        /// Path of the program.
        path: PathBuf,
        /// The reason for which the requirements cannot be read.
        why: String,
    },
    /// An archive cannot be written.
    #[error("{}: {error}", path.display())]
    Archive {
        /// Path of the archive.
        path: PathBuf,
        /// Error of the archive library.
        error: zip::result::ZipError,
    },
}
