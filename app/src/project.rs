//! Reads and writes project folders. A kill at any moment leaves no folder that looks
//! complete and is not.
//!
//! A new folder is written under a hidden name and renamed. In an existing project a marker
//! file is present while files are replaced one by one; a folder with the marker is refused.

mod take_over;

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use gsk_core::model::{ControlModel, ModelId};
use gsk_core::setup::Setup;
use gsk_messages::{Message, say};
use gsk_project::{
    ProjectFiles, ProjectKey, ProjectProblem, ProjectState, import, is_project_file,
};

use crate::files::atomic;
use crate::files::data_dir::{DataDir, DataError};
use crate::files::decode::{self, Encoding};
use crate::files::models;
use crate::files::program_file;
use crate::job::{self, JobError};
use crate::loading::{self, LoadError};
use crate::platform;
use crate::retained::NotSaved;
use crate::retained::project::{Held, held};
use crate::saying::lines;
pub use take_over::{OpenedMemory, Taken, Taking, Target, Who, open, take_over};

/// The file that marks a folder as a project.
pub const HEAD: &str = "project.gpr";
/// The marker file that is present while the files of a project are replaced.
const MARK: &str = ".gsk980td-unfinished";
/// Suffix of the hidden folder in which a new project is written.
const ASIDE: &str = ".gsk980td-new";
/// Folders of a project; tables may also be at its top.
const FOLDERS: [&str; 3] = ["programs", "ladder", "disks"];
/// Folder in the data directory for the memory as it was before each import.
const BACKUPS: &str = "backups";

/// The largest file that is read, programs excepted, bytes: a hundred times the usual size.
const LARGEST_TABLE: u64 = 4 * 1024 * 1024;

/// Text encodings of the programs of a folder, by program number.
pub type Encodings = BTreeMap<u16, Encoding>;

/// Why a project cannot be read, written or imported.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum ProjectError {
    /// The data directory cannot be used.
    Data(#[from] DataError),
    /// The folder contains other files.
    Other(PathBuf),
    /// The folder is neither a project nor a data directory.
    NoProject(PathBuf),
    /// The last writing of the folder was interrupted.
    BrokenOff(PathBuf),
    /// An error of the operating system.
    System(PathBuf, io::Error),
    /// The errors in the files of the folder.
    Problems(PathBuf, Vec<ProjectProblem>),
    /// Values that would be invalid after the import.
    Faults(Vec<gsk_project::InvalidValue>),
    /// The project is for another control model.
    OtherModel(PathBuf, ModelId),
    /// No operation level has this password.
    WrongPassword,
    /// The changes could not be written.
    NotSaved(#[from] NotSaved),
}

impl ProjectError {
    pub fn message(&self) -> Message {
        match self {
            Self::Data(error) => error.message(),
            Self::Other(path) => say::project_folder_other(path.display()),
            Self::NoProject(path) => say::project_not_a_project(path.display()),
            Self::BrokenOff(path) => say::project_broken_off(path.display()),
            Self::System(path, error) => {
                say::subject_reason(path.display(), say::as_written(error))
            }
            Self::Problems(path, problems) => {
                let count = say::project_not_read(path.display(), problems.len());
                let said = problems.iter().map(|it| say::indented(it.message()));
                lines([count].into_iter().chain(said))
            }
            Self::Faults(faults) => lines(faults.iter().map(|fault| {
                let name = format!("{} {}", fault.key.path(), fault.key.name());
                say::subject_reason(name, fault.rule.clone())
            })),
            Self::OtherModel(path, model) => say::project_other_model(path.display(), model.name()),
            Self::WrongPassword => say::project_wrong_password(),
            Self::NotSaved(error) => error.message(),
        }
    }
}

fn system(path: &Path) -> impl FnOnce(io::Error) -> ProjectError + '_ {
    |error| ProjectError::System(path.to_owned(), error)
}

/// A control of a model in its factory state, with the lathe of a machine file. The default
/// lathe has a chuck.
pub fn delivered(model: ModelId, machine: Option<&PathBuf>) -> Setup {
    let mut setup = loading::fitted(Setup::delivered(), machine);
    setup.memory.set_model(ControlModel::new(model));
    setup
}

/// Whether a folder is a project.
pub fn is_project(folder: &Path) -> bool {
    platform::is_taken(&folder.join(HEAD))
}

/// Reads the memory of a control from its data directory, without changing it. `model`:
/// `None` selects the model of the directory.
///
/// # Errors
/// The directory cannot be read, or a window has it open.
pub fn of_data(directory: &Path, model: Option<ModelId>) -> Result<Held, DataError> {
    let model = model.unwrap_or_else(|| models::chosen(directory));
    let data = DataDir::read_only(&models::folder(directory, model))?;
    Ok(held(&data, delivered(model, None)))
}

/// The project files in a folder, as relative paths with `/`.
fn own_files(folder: &Path) -> Result<Vec<String>, ProjectError> {
    let mut found = Vec::new();
    let mut open: Vec<String> = vec![String::new()];
    while let Some(inside) = open.pop() {
        let path = folder.join(&inside);
        let entries = platform::list(&path).map_err(system(&path))?;
        for entry in entries {
            let name = entry.file_name().unwrap_or_default().to_string_lossy();
            if name.starts_with('.') {
                continue;
            }
            let name = match inside.is_empty() {
                true => name.into_owned(),
                false => format!("{inside}/{name}"),
            };
            let is_folder = platform::facts(&entry).is_ok_and(|facts| facts.is_folder);
            if is_folder && !platform::is_link(&entry) {
                // The owner may keep other folders at the top.
                if !inside.is_empty() || FOLDERS.contains(&name.as_str()) {
                    open.push(name);
                }
            } else if is_project_file(&name) {
                found.push(name);
            }
        }
    }
    found.sort();
    Ok(found)
}

/// Reads a project: its state and the encodings of its programs.
///
/// # Errors
/// All errors in its files; a single one refuses the project.
pub fn read(folder: &Path) -> Result<(ProjectState, Encodings), ProjectError> {
    if platform::is_taken(&folder.join(MARK)) {
        return Err(ProjectError::BrokenOff(folder.to_owned()));
    }
    if !is_project(folder) {
        return Err(ProjectError::NoProject(folder.to_owned()));
    }
    let mut files = ProjectFiles::new();
    let mut encodings = Encodings::new();
    let mut problems = Vec::new();
    for name in own_files(folder)? {
        let path = folder.join(&name);
        let wrong = |line, rule| ProjectProblem {
            file: name.clone(),
            line,
            rule,
        };
        let text = plain(&path, largest(&name));
        let text = text.and_then(|it| decode::decode(it).map_err(|error| error.message()));
        let decoded = match text {
            Ok(decoded) => decoded,
            Err(rule) => {
                problems.push(wrong(None, rule));
                continue;
            }
        };
        if let Some(number) = program_of(&name) {
            encodings.insert(number, decoded.encoding);
        }
        problems.extend(checked(&path, &name, &decoded.text));
        files.insert(name, decoded.text);
    }
    match import(&files) {
        Ok(state) if problems.is_empty() => Ok((state, encodings)),
        Ok(_) => Err(ProjectError::Problems(folder.to_owned(), problems)),
        Err(found) => {
            // A file that cannot be decoded is present: do not report it as missing, too.
            let unread: Vec<String> = problems.iter().map(|it| it.file.clone()).collect();
            let found = found.into_iter().filter(|it| !unread.contains(&it.file));
            problems.extend(found);
            Err(ProjectError::Problems(folder.to_owned(), problems))
        }
    }
}

/// Size limit of a project file, bytes.
fn largest(name: &str) -> u64 {
    match program_of(name) {
        Some(_) => program_file::LARGEST_BYTES,
        None => LARGEST_TABLE,
    }
}

/// Reads a regular file of at most `largest` bytes.
fn plain(path: &Path, largest: u64) -> Result<Vec<u8>, Message> {
    let facts = platform::facts(path).map_err(say::as_written)?;
    // Reading a pipe would wait for its writer.
    if !facts.is_file {
        return Err(say::file_not_plain());
    }
    let bytes = platform::read(path, largest + 1).map_err(say::as_written)?;
    if bytes.len() as u64 > largest {
        return Err(say::file_larger_than(largest));
    }
    Ok(bytes)
}

fn program_of(name: &str) -> Option<u16> {
    let name = name.strip_prefix("programs/O")?.strip_suffix(".CNC")?;
    name.parse().ok()
}

/// The errors in a machine file or a job file; other files have none here.
fn checked(path: &Path, name: &str, text: &str) -> Vec<ProjectProblem> {
    let wrong = |line: Option<usize>, rule| ProjectProblem {
        file: name.to_owned(),
        line: line.and_then(|line| line.try_into().ok()),
        rule,
    };
    if name == "machine.ron" {
        return match loading::machine_of(path, text) {
            Ok(_) => Vec::new(),
            Err(LoadError::Machine { line, error, .. }) => {
                vec![wrong(Some(line), say::as_written(error))]
            }
            Err(LoadError::MachineNumber { line, token, .. }) => {
                vec![wrong(Some(line), say::number_not_finite(token))]
            }
            Err(LoadError::NoLathe { rules, .. }) => {
                rules.into_iter().map(|rule| wrong(None, rule)).collect()
            }
            Err(error) => vec![wrong(None, error.message())],
        };
    }
    if !name.ends_with(".job.ron") {
        return Vec::new();
    }
    match job::parse(path, text) {
        Ok(_) => Vec::new(),
        Err(JobError::Syntax { line, error, .. }) => {
            vec![wrong(Some(line), say::as_written(error))]
        }
        Err(JobError::Number { line, token, .. }) => {
            vec![wrong(Some(line), say::number_not_finite(token))]
        }
        Err(JobError::Rule { rule, .. }) => vec![wrong(None, rule)],
        Err(error) => vec![wrong(None, error.message())],
    }
}

/// The numbers of files that a writing changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Written {
    /// Files that are new or have other contents.
    pub files: usize,
    pub removed: usize,
}

/// The encoding of an existing program file.
fn encoding_of(path: &Path) -> Option<Encoding> {
    let bytes = plain(path, program_file::LARGEST_BYTES).ok()?;
    decode::decode(bytes).ok().map(|decoded| decoded.encoding)
}

/// Writes a project into a new folder, an empty folder or an existing project. If the state
/// has no machine file and jobs, those of the folder stay. A program without an entry in
/// `encodings` keeps the encoding of its old file.
///
/// # Errors
/// The folder contains something else, or a file cannot be written.
pub fn write(
    folder: &Path,
    state: &ProjectState,
    files: &ProjectFiles,
    encodings: &Encodings,
) -> Result<Written, ProjectError> {
    let bytes = files.iter().map(|(name, text)| {
        let encoding = program_of(name).and_then(|number| {
            let said = encodings.get(&number).copied();
            said.or_else(|| encoding_of(&folder.join(name)))
        });
        let bytes = decode::encode(text, encoding.unwrap_or_default());
        (name.clone(), bytes)
    });
    let bytes: BTreeMap<String, Vec<u8>> = bytes.collect();
    if !platform::is_taken(folder) {
        return write_new(folder, &bytes);
    }
    let is_empty = platform::list(folder).map_err(system(folder))?.is_empty();
    let unfinished = platform::is_taken(&folder.join(MARK));
    if !is_empty && !is_project(folder) && !unfinished {
        return Err(ProjectError::Other(folder.to_owned()));
    }
    let keeps = |name: &str| state.texts().is_none() && is_text(name);
    let before = own_files(folder)?;
    let gone = before
        .iter()
        .filter(|name| !bytes.contains_key(*name) && !keeps(name));
    let gone: Vec<&String> = gone.collect();
    let changed = bytes.iter().filter(|(name, bytes)| {
        let found = platform::read(&folder.join(name), bytes.len() as u64 + 1);
        found.ok().as_ref() != Some(*bytes)
    });
    let changed: Vec<(&String, &Vec<u8>)> = changed.collect();
    if changed.is_empty() && gone.is_empty() && !unfinished {
        return Ok(Written {
            files: 0,
            removed: 0,
        });
    }
    let mark = folder.join(MARK);
    atomic::write(&mark, b"").map_err(system(&mark))?;
    for (name, bytes) in &changed {
        put(folder, name, bytes)?;
    }
    for name in &gone {
        let path = folder.join(name);
        platform::remove(&path).map_err(system(&path))?;
    }
    platform::remove(&mark).map_err(system(&mark))?;
    Ok(Written {
        files: changed.len(),
        removed: gone.len(),
    })
}

/// Whether a file is a machine file or a job, which a control does not hold.
fn is_text(name: &str) -> bool {
    name == "machine.ron" || name.ends_with(".job.ron")
}

fn put(folder: &Path, name: &str, bytes: &[u8]) -> Result<(), ProjectError> {
    let path = folder.join(name);
    if let Some(parent) = path.parent() {
        platform::make_folder(parent).map_err(system(parent))?;
    }
    atomic::write(&path, bytes).map_err(system(&path))
}

/// Writes into a hidden folder and renames it: the project appears complete or not at all.
fn write_new(folder: &Path, bytes: &BTreeMap<String, Vec<u8>>) -> Result<Written, ProjectError> {
    let mut name = std::ffi::OsString::from(".");
    name.push(folder.file_name().unwrap_or_default());
    name.push(ASIDE);
    let aside = folder.with_file_name(name);
    // The rest of a process that was killed.
    let _ = platform::remove_folder(&aside);
    let made = bytes
        .iter()
        .try_for_each(|(name, bytes)| put(&aside, name, bytes));
    let made = made.and_then(|()| platform::rename(&aside, folder).map_err(system(folder)));
    if let Err(error) = made {
        let _ = platform::remove_folder(&aside);
        return Err(error);
    }
    if let Some(parent) = folder.parent() {
        platform::sync_folder(parent);
    }
    Ok(Written {
        files: bytes.len(),
        removed: 0,
    })
}

/// Writes the memory of a data directory as a new project into its `backups` folder; returns
/// the path.
///
/// # Errors
/// The project cannot be written.
pub fn back_up(data: &Path, held: &Held) -> Result<PathBuf, ProjectError> {
    let folder = data.join(BACKUPS);
    platform::make_folder(&folder).map_err(system(&folder))?;
    let mut count = 1;
    let mut path;
    loop {
        path = folder.join(format!("before-import-{count:04}"));
        if !platform::is_taken(&path) {
            break;
        }
        count += 1;
    }
    let files = gsk_project::export(&held.state, gsk_messages::Language::En);
    write(&path, &held.state, &files, held.encodings())?;
    Ok(path)
}

/// Reads a machine file as the machine file of a project.
///
/// # Errors
/// The file cannot be read, or is not a valid machine file.
pub fn machine_text(path: &Path) -> Result<(ProjectKey, std::sync::Arc<str>), LoadError> {
    let text = program_file::read(path)?.text;
    loading::machine_of(path, &text)?;
    Ok((ProjectKey::Machine, text.into()))
}
