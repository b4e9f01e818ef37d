//! The file of the tool library, `tools.ron` in the data folder.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{OnceLock, PoisonError, RwLock};

use gsk_core::units::{NonFinite, find_non_finite};
use gsk_messages::{Message, say};
use gsk_runner::report::ToolLifeLimit;
use gsk_tooling::ToolLibrary;
use gsk_workpiece::job::Job;

use crate::files::atomic;
use crate::files::data_dir::default_data_path;
use crate::files::program_file;
use crate::platform;

/// Name of the file in the data folder.
const FILE_NAME: &str = "tools.ron";

/// The data folder of this process; `None` for the default one.
fn data_folder() -> &'static RwLock<Option<PathBuf>> {
    static FOLDER: OnceLock<RwLock<Option<PathBuf>>> = OnceLock::new();
    FOLDER.get_or_init(RwLock::default)
}

/// Sets the data folder whose tool library this process uses.
pub fn set_data_folder(path: &Path) {
    let mut folder = data_folder()
        .write()
        .unwrap_or_else(PoisonError::into_inner);
    *folder = Some(path.to_owned());
}

/// Returns the path of the tool library.
///
/// # Errors
/// The platform has no default data folder.
pub fn library_path() -> Result<PathBuf, Message> {
    let folder = data_folder().read().unwrap_or_else(PoisonError::into_inner);
    match &*folder {
        Some(path) => Ok(path.join(FILE_NAME)),
        None => default_data_path()
            .map(|path| path.join(FILE_NAME))
            .map_err(|error| error.message()),
    }
}

/// Reads the tool library; an empty one if there is no file.
///
/// # Errors
/// The file cannot be read, is malformed, or breaks a rule.
pub fn read() -> Result<ToolLibrary, Message> {
    let path = library_path()?;
    match platform::is_taken(&path) {
        true => read_file(&path),
        false => Ok(ToolLibrary::default()),
    }
}

/// Reads a file with a tool library.
///
/// # Errors
/// The file cannot be read, is malformed, or breaks a rule.
pub fn read_file(path: &Path) -> Result<ToolLibrary, Message> {
    let file = program_file::read(path).map_err(|error| error.message())?;
    if let Some(NonFinite { line, token }) = find_non_finite(&file.text) {
        let why = say::number_not_finite(token);
        return Err(say::job_file_line(path.display(), line, why));
    }
    let options = ron_options();
    let library: ToolLibrary = options.from_str(&file.text).map_err(|error| {
        let why = say::as_written(error.code);
        say::job_file_line(path.display(), error.span.start.line, why)
    })?;
    library
        .check()
        .map_err(|rule| say::subject_reason(path.display(), rule))?;
    Ok(library)
}

/// Writes the tool library.
///
/// # Errors
/// The file cannot be written; the old one remains.
pub fn write(library: &ToolLibrary) -> Result<(), Message> {
    let path = library_path()?;
    if let Some(folder) = path.parent() {
        let failed = |error| say::subject_reason(folder.display(), say::as_written(error));
        platform::make_folder(folder).map_err(failed)?;
    }
    write_file(&path, library)
}

/// Writes a file with a tool library.
///
/// # Errors
/// The file cannot be written; the old one remains.
pub fn write_file(path: &Path, library: &ToolLibrary) -> Result<(), Message> {
    let pretty = ron::ser::PrettyConfig::new()
        .depth_limit(4)
        .indentor("    ")
        .new_line("\n");
    let failed = |why: Message| say::subject_reason(path.display(), why);
    let text = ron_options().to_string_pretty(library, pretty);
    let text = text.map_err(|error| failed(say::as_written(error)))? + "\n";
    atomic::write(path, text.as_bytes()).map_err(|error| failed(say::as_written(error)))
}

fn ron_options() -> ron::Options {
    ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
}

/// Changes the tool library: reads it, applies `change` and writes it.
///
/// # Errors
/// The library cannot be read or written, or `change` refuses.
pub fn change<T>(
    change: impl FnOnce(&mut ToolLibrary) -> Result<T, Message>,
) -> Result<T, Message> {
    let mut library = read()?;
    let result = change(&mut library)?;
    write(&library)?;
    Ok(result)
}

/// Replaces the tools of a job that name a tool of the library.
///
/// # Errors
/// The library cannot be read, or has no such tool while the job has none either.
pub fn fill_in_tools(job: &mut Job) -> Result<(), Message> {
    if job.library.is_empty() {
        return Ok(());
    }
    let library = read()?;
    for (number, id) in &job.library {
        match library.tools.get(id) {
            Some(known) => {
                job.tools.insert(*number, known.tool.clone());
            }
            None if job.tools.contains_key(number) => {}
            None => return Err(say::job_library_missing(number, id)),
        }
    }
    Ok(())
}

/// The rest of the lives of the job's tools that come from the library. A library that cannot
/// be read limits nothing.
pub fn life_limits(job: &Job) -> BTreeMap<u8, ToolLifeLimit> {
    if job.library.is_empty() {
        return BTreeMap::new();
    }
    let library = read().unwrap_or_default();
    let limits = job.library.iter().filter_map(|(number, id)| {
        let life = library.tools.get(id)?.life?;
        let limit = ToolLifeLimit {
            id: id.clone(),
            remaining_minutes: life.remaining_minutes(),
        };
        Some((*number, limit))
    });
    limits.collect()
}

/// Minutes in the cut of a tool.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolMinutes {
    /// T number.
    pub number: u8,
    /// The tool in the library.
    pub id: String,
    pub minutes: f64,
}

/// Adds minutes in the cut to the lives of tools. Returns a message for each edge that is used
/// up by them.
///
/// # Errors
/// The library cannot be read or written.
pub fn add_minutes(spent: &[ToolMinutes]) -> Result<Vec<Message>, Message> {
    change(|library| {
        let mut worn = Vec::new();
        for ToolMinutes {
            number,
            id,
            minutes,
        } in spent
        {
            let tool = library.tools.get_mut(id);
            let Some(life) = tool.and_then(|it| it.life.as_mut()) else {
                continue;
            };
            let was_used_up = life.is_used_up();
            life.add_minutes(*minutes);
            if life.is_used_up() && !was_used_up {
                let used = format!("{:.1}", life.used_minutes);
                worn.push(say::tool_library_worn(
                    id,
                    format_args!("{number:02}"),
                    used,
                ));
            }
        }
        Ok(worn)
    })
}
