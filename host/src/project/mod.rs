//! Reads and writes project folders. A kill at any moment leaves no folder that looks
//! complete and is not.
//!
//! A new folder is written under a hidden name and renamed. In an existing project a marker
//! file is present while files are replaced one by one; a folder with the marker is refused.

mod control_import;

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
use crate::files::data_dir::{DataDir, DataDirError};
use crate::files::decode::{self, TextEncoding};
use crate::files::models;
use crate::files::program_file;
use crate::job::{self, JobError};
use crate::loading::{self, LoadError};
use crate::message_format::join_lines;
use crate::platform;
use crate::retained::NotSaved;
use crate::retained::project::{DataDirContent, read_content};
pub use control_import::{
    ImportRequest, ImportResult, ImportRights, ImportTarget, OpenedMemory, import_project,
    open_control_memory,
};

/// Name of the file that marks a folder as a project.
pub const PROJECT_FILE: &str = "project.gpr";
/// Name of the file that is present while the files of a project are replaced.
const UNFINISHED_MARKER: &str = ".gsk980td-unfinished";
/// Suffix of the hidden folder in which a new project is written.
const NEW_FOLDER_SUFFIX: &str = ".gsk980td-new";
/// Names of the folders of a project.
const PROJECT_FOLDERS: [&str; 3] = ["programs", "ladder", "disks"];
/// Name of the folder in the data directory that stores the state of the memory before each import.
const BACKUP_FOLDER: &str = "backups";

/// Size limit of a project file that is not a program, bytes: a hundred times the usual size.
const MAX_TABLE_BYTES: u64 = 4 * 1024 * 1024;

/// Text encodings of the programs of a project folder, by program number.
pub type Encodings = BTreeMap<u16, TextEncoding>;

/// The reason why a project cannot be read, written or imported.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum ProjectError {
    /// The data directory cannot be used.
    Data(#[from] DataDirError),
    /// The target folder contains other files than a project.
    NotEmpty(PathBuf),
    /// The folder is neither a project nor a data directory.
    NotAProject(PathBuf),
    /// The last write of the folder was interrupted, so that its files do not match.
    Unfinished(PathBuf),
    /// The operating system reports an error for this path.
    System(PathBuf, io::Error),
    /// The files of the folder have these errors.
    Problems(PathBuf, Vec<ProjectProblem>),
    /// These values would be invalid after the import.
    InvalidValues(Vec<gsk_project::InvalidValue>),
    /// The project in the folder is for this control model, not for the requested one.
    OtherModel(PathBuf, ModelId),
    /// The entered password belongs to no operation level.
    WrongPassword,
    /// The changed files could not be written.
    NotSaved(#[from] NotSaved),
}

impl ProjectError {
    pub fn message(&self) -> Message {
        match self {
            Self::Data(error) => error.message(),
            Self::NotEmpty(path) => say::project_folder_other(path.display()),
            Self::NotAProject(path) => say::project_not_a_project(path.display()),
            Self::Unfinished(path) => say::project_broken_off(path.display()),
            Self::System(path, error) => {
                say::subject_reason(path.display(), say::as_written(error))
            }
            Self::Problems(path, problems) => {
                let count = say::project_not_read(path.display(), problems.len());
                let messages = problems.iter().map(|it| say::indented(it.message()));
                join_lines([count].into_iter().chain(messages))
            }
            Self::InvalidValues(faults) => join_lines(faults.iter().map(|fault| {
                let name = format!("{} {}", fault.key.path(), fault.key.name());
                say::subject_reason(name, fault.rule.clone())
            })),
            Self::OtherModel(path, model) => say::project_other_model(path.display(), model.name()),
            Self::WrongPassword => say::project_wrong_password(),
            Self::NotSaved(error) => error.message(),
        }
    }
}

fn system_error(path: &Path) -> impl FnOnce(io::Error) -> ProjectError + '_ {
    |error| ProjectError::System(path.to_owned(), error)
}

/// Makes a control of a model in its factory state, with the lathe of a machine file. The
/// lathe without a file is the training lathe, which has a chuck.
pub fn factory_setup(model: ModelId, machine: Option<&PathBuf>) -> Setup {
    let mut setup = loading::with_training_lathe(Setup::delivered(), machine);
    setup.memory.set_model(ControlModel::new(model));
    setup
}

/// Whether a folder contains the file that marks a project.
pub fn is_project(folder: &Path) -> bool {
    platform::is_taken(&folder.join(PROJECT_FILE))
}

/// Reads the memory of a control from its data directory, without changing it. `model`:
/// `None` selects the model of the directory.
///
/// # Errors
/// The directory cannot be read, or a window has it open.
pub fn read_control(
    directory: &Path,
    model: Option<ModelId>,
) -> Result<DataDirContent, DataDirError> {
    let model = model.unwrap_or_else(|| models::read_selected_model(directory));
    let data = DataDir::open_read_only(&models::memory_folder(directory, model))?;
    Ok(read_content(&data, factory_setup(model, None)))
}

/// Lists the project files in a folder, as relative paths with `/`. Returns an error if the folder
/// cannot be read.
fn list_project_files(folder: &Path) -> Result<Vec<String>, ProjectError> {
    let mut found = Vec::new();
    let mut pending_folders: Vec<String> = vec![String::new()];
    while let Some(folder_path) = pending_folders.pop() {
        let path = folder.join(&folder_path);
        let entries = platform::list(&path).map_err(system_error(&path))?;
        for entry in entries {
            let name = entry.file_name().unwrap_or_default().to_string_lossy();
            if name.starts_with('.') {
                continue;
            }
            let name = match folder_path.is_empty() {
                true => name.into_owned(),
                false => format!("{folder_path}/{name}"),
            };
            let is_folder = platform::path_facts(&entry).is_ok_and(|facts| facts.is_folder);
            if is_folder && !platform::is_link(&entry) {
                // The owner may keep other folders at the top.
                if !folder_path.is_empty() || PROJECT_FOLDERS.contains(&name.as_str()) {
                    pending_folders.push(name);
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
    if platform::is_taken(&folder.join(UNFINISHED_MARKER)) {
        return Err(ProjectError::Unfinished(folder.to_owned()));
    }
    if !is_project(folder) {
        return Err(ProjectError::NotAProject(folder.to_owned()));
    }
    let mut files = ProjectFiles::new();
    let mut encodings = Encodings::new();
    let mut problems = Vec::new();
    for name in list_project_files(folder)? {
        let path = folder.join(&name);
        let problem = |line, rule| ProjectProblem {
            file: name.clone(),
            line,
            rule,
        };
        let text = read_regular_file(&path, max_bytes(&name));
        let text = text.and_then(|it| decode::decode(it).map_err(|error| error.message()));
        let decoded = match text {
            Ok(decoded) => decoded,
            Err(rule) => {
                problems.push(problem(None, rule));
                continue;
            }
        };
        if let Some(number) = program_number(&name) {
            encodings.insert(number, decoded.encoding);
        }
        problems.extend(find_problems(&path, &name, &decoded.text));
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

/// Returns the size limit of the project file `name`, bytes.
fn max_bytes(name: &str) -> u64 {
    match program_number(name) {
        Some(_) => program_file::MAX_BYTES,
        None => MAX_TABLE_BYTES,
    }
}

/// Reads a regular file; refuses one of more than `max_bytes` bytes.
fn read_regular_file(path: &Path, max_bytes: u64) -> Result<Vec<u8>, Message> {
    let facts = platform::path_facts(path).map_err(say::as_written)?;
    // Reading a pipe would wait for its writer.
    if !facts.is_file {
        return Err(say::file_not_plain());
    }
    let bytes = platform::read(path, max_bytes + 1).map_err(say::as_written)?;
    if bytes.len() as u64 > max_bytes {
        return Err(say::file_larger_than(max_bytes));
    }
    Ok(bytes)
}

fn program_number(name: &str) -> Option<u16> {
    let name = name.strip_prefix("programs/O")?.strip_suffix(".CNC")?;
    name.parse().ok()
}

/// Lists the errors in a machine file or a job file; for other files the list is empty.
fn find_problems(path: &Path, name: &str, text: &str) -> Vec<ProjectProblem> {
    let problem = |line: Option<usize>, rule| ProjectProblem {
        file: name.to_owned(),
        line: line.and_then(|line| line.try_into().ok()),
        rule,
    };
    if name == "machine.ron" {
        return match loading::parse_machine(path, text) {
            Ok(_) => Vec::new(),
            Err(LoadError::Machine { line, error, .. }) => {
                vec![problem(Some(line), say::as_written(error))]
            }
            Err(LoadError::MachineNumber { line, token, .. }) => {
                vec![problem(Some(line), say::number_not_finite(token))]
            }
            Err(LoadError::InvalidLathe { rules, .. }) => {
                rules.into_iter().map(|rule| problem(None, rule)).collect()
            }
            Err(error) => vec![problem(None, error.message())],
        };
    }
    if !name.ends_with(".job.ron") {
        return Vec::new();
    }
    match job::parse(path, text) {
        Ok(_) => Vec::new(),
        Err(JobError::Syntax { line, error, .. }) => {
            vec![problem(Some(line), say::as_written(error))]
        }
        Err(JobError::NonFiniteNumber { line, token, .. }) => {
            vec![problem(Some(line), say::number_not_finite(token))]
        }
        Err(JobError::BrokenRule { rule, .. }) => vec![problem(None, rule)],
        Err(error) => vec![problem(None, error.message())],
    }
}

/// Numbers of files that a call of [`write()`] has changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProjectWriteCounts {
    /// Number of files that are new or have other contents.
    pub changed_files: usize,
    pub removed_files: usize,
}

/// The encoding of an existing program file; `None` if it cannot be read.
fn read_encoding(path: &Path) -> Option<TextEncoding> {
    let bytes = read_regular_file(path, program_file::MAX_BYTES).ok()?;
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
) -> Result<ProjectWriteCounts, ProjectError> {
    let bytes = files.iter().map(|(name, text)| {
        let encoding = program_number(name).and_then(|number| {
            let known = encodings.get(&number).copied();
            known.or_else(|| read_encoding(&folder.join(name)))
        });
        let bytes = decode::encode(text, encoding.unwrap_or_default());
        (name.clone(), bytes)
    });
    let bytes: BTreeMap<String, Vec<u8>> = bytes.collect();
    if !platform::is_taken(folder) {
        return write_new(folder, &bytes);
    }
    let is_empty = platform::list(folder)
        .map_err(system_error(folder))?
        .is_empty();
    let unfinished = platform::is_taken(&folder.join(UNFINISHED_MARKER));
    if !is_empty && !is_project(folder) && !unfinished {
        return Err(ProjectError::NotEmpty(folder.to_owned()));
    }
    let is_kept = |name: &str| state.texts().is_none() && is_machine_or_job_file(name);
    let old_files = list_project_files(folder)?;
    let removed = old_files
        .iter()
        .filter(|name| !bytes.contains_key(*name) && !is_kept(name));
    let removed: Vec<&String> = removed.collect();
    let changed = bytes.iter().filter(|(name, bytes)| {
        let found = platform::read(&folder.join(name), bytes.len() as u64 + 1);
        found.ok().as_ref() != Some(*bytes)
    });
    let changed: Vec<(&String, &Vec<u8>)> = changed.collect();
    if changed.is_empty() && removed.is_empty() && !unfinished {
        return Ok(ProjectWriteCounts {
            changed_files: 0,
            removed_files: 0,
        });
    }
    let mark = folder.join(UNFINISHED_MARKER);
    atomic::write(&mark, b"").map_err(system_error(&mark))?;
    for (name, bytes) in &changed {
        write_file(folder, name, bytes)?;
    }
    for name in &removed {
        let path = folder.join(name);
        platform::remove(&path).map_err(system_error(&path))?;
    }
    platform::remove(&mark).map_err(system_error(&mark))?;
    Ok(ProjectWriteCounts {
        changed_files: changed.len(),
        removed_files: removed.len(),
    })
}

/// Whether a file is a machine file or a job file, which a control does not hold.
fn is_machine_or_job_file(name: &str) -> bool {
    name == "machine.ron" || name.ends_with(".job.ron")
}

fn write_file(folder: &Path, name: &str, bytes: &[u8]) -> Result<(), ProjectError> {
    let path = folder.join(name);
    if let Some(parent) = path.parent() {
        platform::make_folder(parent).map_err(system_error(parent))?;
    }
    atomic::write(&path, bytes).map_err(system_error(&path))
}

/// Writes the files into a hidden folder and renames that to `folder`: the project appears complete
/// or not at all. Returns an error if that fails.
fn write_new(
    folder: &Path,
    bytes: &BTreeMap<String, Vec<u8>>,
) -> Result<ProjectWriteCounts, ProjectError> {
    let mut name = std::ffi::OsString::from(".");
    name.push(folder.file_name().unwrap_or_default());
    name.push(NEW_FOLDER_SUFFIX);
    let new_folder = folder.with_file_name(name);
    // The rest of a process that was killed.
    let _ = platform::remove_folder(&new_folder);
    let result = bytes
        .iter()
        .try_for_each(|(name, bytes)| write_file(&new_folder, name, bytes));
    let result =
        result.and_then(|()| platform::rename(&new_folder, folder).map_err(system_error(folder)));
    if let Err(error) = result {
        let _ = platform::remove_folder(&new_folder);
        return Err(error);
    }
    if let Some(parent) = folder.parent() {
        platform::sync_folder(parent);
    }
    Ok(ProjectWriteCounts {
        changed_files: bytes.len(),
        removed_files: 0,
    })
}

/// Writes the memory of a data directory as a new project into its `backups` folder; returns
/// the path.
///
/// # Errors
/// The project cannot be written.
pub fn back_up(data: &Path, held: &DataDirContent) -> Result<PathBuf, ProjectError> {
    let folder = data.join(BACKUP_FOLDER);
    platform::make_folder(&folder).map_err(system_error(&folder))?;
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

/// Reads a machine file and returns its text with the key of a project's machine file.
///
/// # Errors
/// The file cannot be read, or is not a valid machine file.
pub fn read_machine_file(path: &Path) -> Result<(ProjectKey, std::sync::Arc<str>), LoadError> {
    let text = program_file::read(path)?.text;
    loading::parse_machine(path, &text)?;
    Ok((ProjectKey::Machine, text.into()))
}
