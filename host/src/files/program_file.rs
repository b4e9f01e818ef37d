//! Reads a part program from the disk.

use std::io;
use std::path::{Path, PathBuf};

use gsk_messages::{Message, say};

use super::decode::{self, DecodeError, TextEncoding};
use crate::message_format::describe_io_error;
use crate::platform;

/// Size limit of a program file, bytes.
pub const MAX_BYTES: u64 = 256 * 1024 * 1024;

/// A program file that was read: its text, and notices for the operator.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramFile {
    pub path: PathBuf,
    pub text: String,
    pub encoding: TextEncoding,
    /// Notices about the text for the operator, such as full-width letters.
    pub notices: Vec<Message>,
}

/// The reason why a program cannot be read. Every message names the file.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum ProgramFileError {
    /// The operating system reports an error for this file.
    System { path: PathBuf, source: io::Error },
    /// The path is that of a folder, not of a file.
    Folder { path: PathBuf },
    /// The folder at this path contains no part program.
    NoPrograms { path: PathBuf },
    /// The file is empty or blank.
    Empty { path: PathBuf },
    /// The file exceeds [`MAX_BYTES`].
    TooLarge { path: PathBuf },
    /// The content of the file is not text.
    NotText {
        path: PathBuf,
        /// Position and reason of the first byte that cannot be decoded.
        source: DecodeError,
    },
}

impl ProgramFileError {
    pub fn message(&self) -> Message {
        match self {
            Self::System { path, source } => {
                say::subject_reason(path.display(), describe_read_error(source))
            }
            Self::Folder { path } => say::file_is_folder(path.display()),
            Self::NoPrograms { path } => say::file_folder_without_programs(path.display()),
            Self::Empty { path } => say::file_is_empty(path.display()),
            Self::TooLarge { path } => say::file_too_large(path.display()),
            Self::NotText { path, source } => say::subject_reason(path.display(), source.message()),
        }
    }
}

fn describe_read_error(error: &io::Error) -> Message {
    match error.kind() {
        io::ErrorKind::NotFound => say::file_not_there(),
        io::ErrorKind::PermissionDenied => say::file_no_permission(),
        _ => describe_io_error(error),
    }
}

/// Reads a program file of any supported encoding, up to 256 MB. Returns an error if it cannot be
/// read, is too large or is no text.
pub fn read(path: &Path) -> Result<ProgramFile, ProgramFileError> {
    let bytes = read_bytes(path)?;
    let decoded = decode::decode(bytes).map_err(|source| ProgramFileError::NotText {
        path: path.to_owned(),
        source,
    })?;
    if decoded.text.trim().is_empty() {
        return Err(ProgramFileError::Empty {
            path: path.to_owned(),
        });
    }
    let mut notices = Vec::new();
    if let Some(line) = decode::find_full_width_line(&decoded.text) {
        notices.push(say::file_full_width(path.display(), line));
    }
    Ok(ProgramFile {
        path: path.to_owned(),
        text: decoded.text,
        encoding: decoded.encoding,
        notices,
    })
}

/// Reads the bytes of a file, up to 256 MB.
///
/// # Errors
/// The file cannot be read, is a folder or is larger.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, ProgramFileError> {
    let system = |source| ProgramFileError::System {
        path: path.to_owned(),
        source,
    };
    let facts = platform::path_facts(path).map_err(system)?;
    if facts.is_folder {
        return Err(ProgramFileError::Folder {
            path: path.to_owned(),
        });
    }
    if facts.length > MAX_BYTES {
        return Err(ProgramFileError::TooLarge {
            path: path.to_owned(),
        });
    }
    // A pipe has no length in advance: limit the bytes read, too.
    let bytes = platform::read(path, MAX_BYTES + 1).map_err(system)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(ProgramFileError::TooLarge {
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
    fn every_error_names_the_file() {
        let folder = gsk_tests::test_folder("program-file");
        let path = folder.join("part.CNC");
        let error_text = |path: &Path| read(path).expect_err("refused").to_string();
        assert!(error_text(&path).ends_with("part.CNC: there is no such file"));
        assert!(error_text(&folder).contains("is a folder"));
        std::fs::write(&path, "\n  \n").expect("write");
        assert!(error_text(&path).contains("is empty"));
        std::fs::write(&path, b"G00\0").expect("write");
        assert!(error_text(&path).contains("binary file"));
        let big = File::create(folder.join("big.CNC")).expect("create");
        big.set_len(MAX_BYTES + 1).expect("sparse");
        assert!(error_text(&folder.join("big.CNC")).contains("larger than 256 MB"));
        std::fs::write(&path, "Ｏ０００１\nG00 X1\n").expect("write");
        let read = read(&path).expect("program");
        assert_eq!(read.notices.len(), 1);
    }
}
