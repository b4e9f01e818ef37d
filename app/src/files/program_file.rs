//! Reads a part program from the disk.

use std::io;
use std::path::{Path, PathBuf};

use gsk_messages::{Message, say};

use super::decode::{self, DecodeError, Encoding};
use crate::platform;
use crate::saying::of_system;

/// Size limit of a program file, bytes.
pub const LARGEST_BYTES: u64 = 256 * 1024 * 1024;

/// A program file with its text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramFile {
    pub path: PathBuf,
    pub text: String,
    pub encoding: Encoding,
    /// Notices for the operator, such as full-width letters.
    pub notices: Vec<Message>,
}

/// Why a program cannot be read. Every message names the file.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum FileError {
    /// An error of the operating system.
    System {
        path: PathBuf,
        source: io::Error,
    },
    /// The path is a folder.
    Folder {
        path: PathBuf,
    },
    /// The folder contains no part program.
    NoProgram {
        path: PathBuf,
    },
    /// The file is empty or blank.
    Empty {
        path: PathBuf,
    },
    /// The file exceeds [`LARGEST_BYTES`].
    TooLarge {
        path: PathBuf,
    },
    /// The file is not text.
    NotText {
        path: PathBuf,
        /// Position and reason.
        source: DecodeError,
    },
}

impl FileError {
    pub fn message(&self) -> Message {
        match self {
            Self::System { path, source } => {
                say::subject_reason(path.display(), plain_reason(source))
            }
            Self::Folder { path } => say::file_is_folder(path.display()),
            Self::NoProgram { path } => say::file_folder_without_programs(path.display()),
            Self::Empty { path } => say::file_is_empty(path.display()),
            Self::TooLarge { path } => say::file_too_large(path.display()),
            Self::NotText { path, source } => say::subject_reason(path.display(), source.message()),
        }
    }
}

fn plain_reason(error: &io::Error) -> Message {
    match error.kind() {
        io::ErrorKind::NotFound => say::file_not_there(),
        io::ErrorKind::PermissionDenied => say::file_no_permission(),
        _ => of_system(error),
    }
}

/// Reads a program file of any supported encoding, up to 256 MB.
pub fn read(path: &Path) -> Result<ProgramFile, FileError> {
    let bytes = read_bytes(path)?;
    let decoded = decode::decode(bytes).map_err(|source| FileError::NotText {
        path: path.to_owned(),
        source,
    })?;
    if decoded.text.trim().is_empty() {
        return Err(FileError::Empty {
            path: path.to_owned(),
        });
    }
    let mut notices = Vec::new();
    if let Some(line) = decode::full_width_line(&decoded.text) {
        notices.push(say::file_full_width(path.display(), line));
    }
    Ok(ProgramFile {
        path: path.to_owned(),
        text: decoded.text,
        encoding: decoded.encoding,
        notices,
    })
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, FileError> {
    let system = |source| FileError::System {
        path: path.to_owned(),
        source,
    };
    let facts = platform::facts(path).map_err(system)?;
    if facts.is_folder {
        return Err(FileError::Folder {
            path: path.to_owned(),
        });
    }
    if facts.length > LARGEST_BYTES {
        return Err(FileError::TooLarge {
            path: path.to_owned(),
        });
    }
    // A pipe has no length in advance: limit the bytes read, too.
    let bytes = platform::read(path, LARGEST_BYTES + 1).map_err(system)?;
    if bytes.len() as u64 > LARGEST_BYTES {
        return Err(FileError::TooLarge {
            path: path.to_owned(),
        });
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use std::fs::File;

    use super::*;

    #[test]
    fn each_refusal_is_a_sentence_with_the_name() {
        let folder = crate::files::test_folder("program-file");
        let path = folder.join("part.CNC");
        let said = |path: &Path| read(path).expect_err("refused").to_string();
        assert!(said(&path).ends_with("part.CNC: there is no such file"));
        assert!(said(&folder).contains("is a folder"));
        std::fs::write(&path, "\n  \n").expect("write");
        assert!(said(&path).contains("is empty"));
        std::fs::write(&path, b"G00\0").expect("write");
        assert!(said(&path).contains("binary file"));
        let big = File::create(folder.join("big.CNC")).expect("create");
        big.set_len(LARGEST_BYTES + 1).expect("sparse");
        assert!(said(&folder.join("big.CNC")).contains("larger than 256 MB"));
        std::fs::write(&path, "Ｏ０００１\nG00 X1\n").expect("write");
        let read = read(&path).expect("program");
        assert_eq!(read.notices.len(), 1);
    }
}
