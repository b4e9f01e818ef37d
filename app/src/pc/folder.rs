//! Files of the PC: what they are called at the control, and where those of the control
//! are stored.

use std::path::{Path, PathBuf};

use gsk_panel::panel::FileId;
use gsk_transfer::FileName;

use super::{FilesError, PcError};
use crate::files::program_file::FileError;
use crate::files::{atomic, subprograms};
use crate::output::WriteError;

/// A file of the PC and its name at the control.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chosen {
    /// Where it stands on the PC.
    pub path: PathBuf,
    /// Its name at the control.
    pub name: FileName,
}

/// From a word of the command line: `FILE=NAME`, else the name is that of the file, or
/// made of the program number in the file's name or first block.
///
/// # Errors
/// There is no name for it, or not such a one.
pub fn chosen(word: &str) -> Result<Chosen, FilesError> {
    let path = PathBuf::from(word);
    if !path.exists()
        && let Some((file, name)) = word.rsplit_once('=')
    {
        return Ok(Chosen {
            path: PathBuf::from(file),
            name: FileName::new(name)?,
        });
    }
    match named(&path) {
        Some(name) => Ok(Chosen { path, name }),
        None => Err(FilesError::NoName(path)),
    }
}

/// The name at the control: that of the file, or made of the program number in the file's
/// name or first block; none where there is none.
pub fn named(path: &Path) -> Option<FileName> {
    let own = path.file_name().and_then(|name| name.to_str());
    let own = own.filter(|name| FileId::of(name).is_some());
    let number = || {
        let number =
            subprograms::number_in_name(path).or_else(|| subprograms::number_in_head(path));
        number.map(FileName::from_program)
    };
    own.and_then(|name| FileName::new(name).ok())
        .or_else(number)
}

/// Refuses two files of one name.
///
/// # Errors
/// Names both.
pub fn each_once(files: &[Chosen]) -> Result<(), FilesError> {
    for (at, file) in files.iter().enumerate() {
        if let Some(first) = files[..at].iter().find(|first| first.name == file.name) {
            return Err(FilesError::Twice {
                name: file.name.clone(),
                first: first.path.clone(),
                second: file.path.clone(),
            });
        }
    }
    Ok(())
}

/// The files of a folder that the control knows: programs first, parameters last, since
/// they may change the speed of the line.
///
/// # Errors
/// The folder cannot be read, or has none.
pub fn of_folder(folder: &Path) -> Result<Vec<Chosen>, PcError> {
    let entries = std::fs::read_dir(folder).map_err(|error| unreadable(folder, error))?;
    let mut files: Vec<(u8, Chosen)> = entries
        .flatten()
        .filter_map(|entry| {
            let name = entry.file_name();
            let name = FileName::new(name.to_str()?).ok()?;
            let order = match FileId::of(name.as_str())? {
                FileId::Program(_) => 0,
                FileId::Offsets | FileId::Pitch => 1,
                FileId::Parameters => 2,
            };
            let path = entry.path();
            path.is_file().then_some((order, Chosen { path, name }))
        })
        .collect();
    if files.is_empty() {
        return Err(FilesError::Empty(folder.to_owned()).into());
    }
    files.sort_by(|(one, a), (other, b)| {
        one.cmp(other)
            .then_with(|| a.name.as_str().cmp(b.name.as_str()))
    });
    let files: Vec<Chosen> = files.into_iter().map(|(_, file)| file).collect();
    each_once(&files)?;
    Ok(files)
}

/// What a file holds.
///
/// # Errors
/// Names it, and what the system said.
pub fn read(path: &Path) -> Result<Vec<u8>, PcError> {
    std::fs::read(path).map_err(|error| unreadable(path, error))
}

fn unreadable(path: &Path, source: std::io::Error) -> PcError {
    let path = path.to_owned();
    PcError::File(FileError::System { path, source })
}

/// Refuses files that are there already, before anything is received.
///
/// # Errors
/// Names the first one.
pub fn keep_apart(
    folder: &Path,
    names: impl Iterator<Item = String>,
    overwrite: bool,
) -> Result<(), FilesError> {
    let mut paths = names.map(|name| folder.join(name));
    match paths.find(|path| !overwrite && path.exists()) {
        Some(path) => Err(FilesError::There(path)),
        None => Ok(()),
    }
}

/// Makes a folder, if it is not there.
///
/// # Errors
/// Names it, and what the system said.
pub fn make(folder: &Path) -> Result<(), PcError> {
    let made = std::fs::create_dir_all(folder);
    made.map_err(|error| WriteError::new(folder, error).into())
}

/// Writes a file, all of it or nothing.
///
/// # Errors
/// Names it, and what the system said.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), PcError> {
    let written = atomic::write(path, bytes);
    written.map_err(|error| WriteError::new(path, error).into())
}

/// A name in a folder that is free: the file's own, else with a number behind it.
pub fn free(folder: &Path, name: &str) -> PathBuf {
    let (stem, ending) = name.split_once('.').unwrap_or((name, ""));
    let numbered = (2_u32..).map(|number| folder.join(format!("{stem} ({number}).{ending}")));
    let mut names = core::iter::once(folder.join(name)).chain(numbered);
    names.find(|path| !path.exists()).unwrap_or_default()
}
