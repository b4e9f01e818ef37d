//! Files of the PC: their names at the control, and the paths of received files.

use std::path::{Path, PathBuf};

use gsk_panel::panel::{FileId, LADDER_FILE};
use gsk_transfer::FileName;

use super::{FilesError, PcError};
use crate::files::program_file::ProgramFileError;
use crate::files::{atomic, subprograms};
use crate::output::WriteError;

/// Endings of the names of ladder files.
const LADDER_ENDINGS: [&str; 2] = ["ldx", "il"];

/// A file of the PC and its name at the control.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PcFile {
    /// Path of the file on the PC.
    pub path: PathBuf,
    /// Name of the file at the control.
    pub name: FileName,
}

/// Parses a word of the command line: `FILE=NAME`, or a file. Without a name the function
/// takes the file's name, or one made from the program number in the file's name or first
/// block.
///
/// # Errors
/// The file yields no name, or `NAME` is invalid.
pub fn parse_file_word(word: &str) -> Result<PcFile, FilesError> {
    let path = PathBuf::from(word);
    if !path.exists()
        && let Some((file, name)) = word.rsplit_once('=')
    {
        return Ok(PcFile {
            path: PathBuf::from(file),
            name: FileName::new(name)?,
        });
    }
    match control_name(&path) {
        Some(name) => Ok(PcFile { path, name }),
        None => Err(FilesError::NoName(path)),
    }
}

/// Returns the name of a file at the control: the name of the file itself, that of the ladder
/// for a file whose name ends in `.ldx` or `.il`, or one made from the program number in its name
/// or first block; `None` if none of these gives one.
pub fn control_name(path: &Path) -> Option<FileName> {
    let ending = path.extension().and_then(|ending| ending.to_str());
    if ending.is_some_and(|it| LADDER_ENDINGS.iter().any(|of| it.eq_ignore_ascii_case(of))) {
        return FileName::new(LADDER_FILE).ok();
    }
    let own = path.file_name().and_then(|name| name.to_str());
    let own = own.filter(|name| FileId::of(name).is_some());
    let number = || {
        let number = subprograms::parse_number_in_name(path)
            .or_else(|| subprograms::read_number_in_head(path));
        number.map(FileName::from_program)
    };
    own.and_then(|name| FileName::new(name).ok())
        .or_else(number)
}

/// Refuses files of which two have the same name at the control.
///
/// # Errors
/// Names both.
pub fn refuse_duplicates(files: &[PcFile]) -> Result<(), FilesError> {
    for (at, file) in files.iter().enumerate() {
        if let Some(first) = files[..at].iter().find(|first| first.name == file.name) {
            return Err(FilesError::DuplicateName {
                name: file.name.clone(),
                first: first.path.clone(),
                second: file.path.clone(),
            });
        }
    }
    Ok(())
}

/// Lists the files of a folder that the control can store: programs first, parameters last,
/// since they may change the rate of the line.
///
/// # Errors
/// The folder cannot be read, or has no such files.
pub fn list_control_files(folder: &Path) -> Result<Vec<PcFile>, PcError> {
    let entries = std::fs::read_dir(folder).map_err(|error| unreadable(folder, error))?;
    let mut files: Vec<(u8, PcFile)> = entries
        .flatten()
        .filter_map(|entry| {
            let name = entry.file_name();
            let name = FileName::new(name.to_str()?).ok()?;
            let order = match FileId::of(name.as_str())? {
                FileId::Program(_) => 0,
                FileId::Offsets | FileId::Pitch => 1,
                FileId::Ladder => 2,
                FileId::Parameters => 3,
            };
            let path = entry.path();
            path.is_file().then_some((order, PcFile { path, name }))
        })
        .collect();
    if files.is_empty() {
        return Err(FilesError::Empty(folder.to_owned()).into());
    }
    files.sort_by(|(one, a), (other, b)| {
        one.cmp(other)
            .then_with(|| a.name.as_str().cmp(b.name.as_str()))
    });
    let files: Vec<PcFile> = files.into_iter().map(|(_, file)| file).collect();
    refuse_duplicates(&files)?;
    Ok(files)
}

/// Reads the contents of a file on the PC.
///
/// # Errors
/// Names the file and the error of the system.
pub fn read_file(path: &Path) -> Result<Vec<u8>, PcError> {
    std::fs::read(path).map_err(|error| unreadable(path, error))
}

fn unreadable(path: &Path, source: std::io::Error) -> PcError {
    let path = path.to_owned();
    PcError::File(ProgramFileError::System { path, source })
}

/// Checks before a transfer that no file would be replaced, unless `overwrite` is set.
///
/// # Errors
/// Names the first existing file.
pub fn refuse_existing(
    folder: &Path,
    names: impl Iterator<Item = String>,
    overwrite: bool,
) -> Result<(), FilesError> {
    let mut paths = names.map(|name| folder.join(name));
    match paths.find(|path| !overwrite && path.exists()) {
        Some(path) => Err(FilesError::Exists(path)),
        None => Ok(()),
    }
}

/// Creates a folder if it does not exist.
///
/// # Errors
/// Names the folder and the error of the system.
pub fn make_folder(folder: &Path) -> Result<(), PcError> {
    let made = std::fs::create_dir_all(folder);
    made.map_err(|error| WriteError::new(folder, error).into())
}

/// Writes a file on the PC completely or not at all.
///
/// # Errors
/// Names the file and the error of the system.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), PcError> {
    let written = atomic::write(path, bytes);
    written.map_err(|error| WriteError::new(path, error).into())
}

/// Returns a free path in a folder: with this name, or with a number after it.
pub fn free_path(folder: &Path, name: &str) -> PathBuf {
    let (stem, ending) = name.split_once('.').unwrap_or((name, ""));
    let numbered = (2_u32..).map(|number| folder.join(format!("{stem} ({number}).{ending}")));
    let mut names = core::iter::once(folder.join(name)).chain(numbered);
    names.find(|path| !path.exists()).unwrap_or_default()
}
