//! Loads exercises: the built-in ones, those of a teacher in the folder `exercises` of the data
//! directory, and the solutions beside a task.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use gsk_exercise::check::{
    REFERENCE_RECORDING, REFERENCE_SCRIPT, SolutionContent, SolutionFile, check_task,
};
use gsk_exercise::course::CourseTaskFile;
use gsk_exercise::library::{EXERCISES, built_in_tasks};
use gsk_exercise::task::ExerciseTask;
use gsk_messages::{Message, say};

use super::{atomic, program_file};
use crate::output::WriteError;
use crate::platform;

/// Name of the folder for a teacher's exercises in the data directory.
pub const FOLDER: &str = "exercises";
/// Name of the file of a task in its folder.
pub const TASK_FILE: &str = "task.ron";
/// Name of the file with a drawing made by hand, in the folder of a task.
const DRAWING_FILE: &str = "drawing.png";
/// Greatest size of a drawing made by hand, bytes.
const MAX_DRAWING_BYTES: u64 = 4 * 1024 * 1024;

/// The exercises of the program and of a data directory, and the errors of unusable ones.
#[derive(Debug, Default)]
pub struct AvailableExercises {
    /// The built-in exercises, then those of the data directory, sorted by name.
    pub tasks: Vec<ExerciseTask>,
    /// One error message for each task that cannot be used.
    pub errors: Vec<Message>,
    /// Names of the exercises of the data directory without a reference solution.
    pub without_reference: BTreeSet<String>,
}

/// Reads the task in a folder. The path may also be that of its file.
///
/// # Errors
/// The file cannot be read, or breaks a rule: the message names file and line.
pub fn read(path: &Path) -> Result<ExerciseTask, Message> {
    let file = task_path(path);
    read_source(path)?.read_task(&file.display().to_string())
}

/// Reads the task file and the drawing of a task.
fn read_source(path: &Path) -> Result<CourseTaskFile, Message> {
    let file = task_path(path);
    let folder = file.parent().and_then(Path::file_name).unwrap_or_default();
    let text = program_file::read(&file).map_err(|error| error.message())?;
    let drawing = file.with_file_name(DRAWING_FILE);
    let drawing = match platform::is_taken(&drawing) {
        true => {
            let bytes = platform::read(&drawing, MAX_DRAWING_BYTES);
            let named = |error| say::subject_reason(drawing.display(), say::as_written(error));
            Some(bytes.map_err(named)?)
        }
        false => None,
    };
    let id = folder.to_string_lossy().into_owned();
    Ok(CourseTaskFile::new(id, text.text, drawing.as_deref()))
}

/// Finds the files of a task like [`find`], for a package, which checks them.
///
/// # Errors
/// There is no such task.
pub fn find_source(name: &Path, data: Option<&Path>) -> Result<CourseTaskFile, Message> {
    let of_teacher = data.map(|data| data.join(FOLDER).join(name));
    let of_teacher = of_teacher.filter(|folder| platform::is_taken(&folder.join(TASK_FILE)));
    let built_in = EXERCISES.iter().find(|(id, _)| Path::new(id) == name);
    match (of_teacher, built_in) {
        (None, Some((id, text))) => Ok(CourseTaskFile::new(
            (*id).to_owned(),
            (*text).to_owned(),
            None,
        )),
        (folder, _) => {
            let folder = folder.unwrap_or_else(|| name.to_owned());
            if !platform::is_taken(&folder) {
                let names = EXERCISES.iter().map(|(id, _)| *id).collect::<Vec<_>>();
                return Err(say::exercise_unknown(name.display(), names.join(" ")));
            }
            read_source(&folder)
        }
    }
}

/// Reads the files of an exercise in the folder of a teacher, for a seat that does not have it;
/// `None` for one that comes with the program.
///
/// # Errors
/// A file cannot be read.
pub fn find_own_source(id: &str, data: Option<&Path>) -> Result<Option<CourseTaskFile>, Message> {
    let folder = data.map(|data| data.join(FOLDER).join(id));
    let folder = folder.filter(|folder| platform::is_taken(&folder.join(TASK_FILE)));
    folder.map(|folder| read_source(&folder)).transpose()
}

/// Returns the path of the file of a task: `path` is the file or its folder.
fn task_path(path: &Path) -> PathBuf {
    match path.extension() {
        Some(ending) if ending.eq_ignore_ascii_case("ron") => path.to_owned(),
        _ => path.join(TASK_FILE),
    }
}

/// Reads the solutions beside a task: `reference.txt` or `reference.gskrec`, `wrong-1.txt`,
/// `wrong-2.txt`, …
///
/// # Errors
/// A file cannot be read.
pub fn read_solutions(path: &Path) -> Result<Vec<SolutionFile>, Message> {
    let file = task_path(path);
    let folder = file.parent().unwrap_or(Path::new(""));
    let mut paths = platform::list(folder).map_err(say::as_written)?;
    paths.sort();
    let mut solutions = Vec::new();
    for path in paths {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let is_script =
            name == REFERENCE_SCRIPT || (name.starts_with("wrong-") && name.ends_with(".txt"));
        let content = if is_script {
            let file = program_file::read(&path).map_err(|error| error.message())?;
            SolutionContent::Script(file.text)
        } else if name == REFERENCE_RECORDING {
            let bytes = program_file::read_bytes(&path).map_err(|error| error.message())?;
            SolutionContent::Recording(bytes)
        } else {
            continue;
        };
        let name = name.into_owned();
        solutions.push(SolutionFile { name, content });
    }
    Ok(solutions)
}

/// Loads all exercises: the built-in ones and those of a data directory.
pub fn load_exercises(data: Option<&Path>) -> AvailableExercises {
    let mut available = AvailableExercises {
        tasks: built_in_tasks(),
        ..AvailableExercises::default()
    };
    let listed = data.map(|data| platform::list(&data.join(FOLDER)));
    // Without the folder there are no exercises of a teacher.
    let mut folders = listed.and_then(Result::ok).unwrap_or_default();
    folders.retain(|folder| platform::is_taken(&folder.join(TASK_FILE)));
    folders.sort();
    for folder in folders {
        match read(&folder) {
            Ok(task) => {
                // An exercise of the folder replaces the built-in one of the same name.
                available.tasks.retain(|known| known.id != task.id);
                let mut references = [REFERENCE_SCRIPT, REFERENCE_RECORDING].into_iter();
                if !references.any(|name| platform::is_taken(&folder.join(name))) {
                    available.without_reference.insert(task.id.clone());
                }
                available.tasks.push(task);
            }
            Err(message) => available.errors.push(message),
        }
    }
    available
}

/// Writes the task of a new exercise into a separate folder of a data directory, and returns
/// its path.
///
/// # Errors
/// The name cannot be that of a folder, the folder is not empty, or the file cannot be written.
pub fn write_new(data: &Path, name: &str, task: &str) -> Result<PathBuf, Message> {
    let folder = make_task_folder(data, name)?;
    let file = folder.join(TASK_FILE);
    atomic::write(&file, task.as_bytes())
        .map_err(|error| WriteError::new(&file, error).message())?;
    Ok(file)
}

/// Writes an exercise that the class has sent into a separate folder of a data directory, with its
/// drawing, and returns that folder. An exercise of the same name stays as it is.
///
/// # Errors
/// There is an exercise of this name, or a file cannot be written.
pub fn keep_sent(
    data: &Path,
    id: &str,
    task: &str,
    drawing: Option<&[u8]>,
) -> Result<PathBuf, Message> {
    if EXERCISES.iter().any(|(known, _)| *known == id) {
        return Err(say::class_task_name_taken(id));
    }
    let folder = make_task_folder(data, id)?;
    // The task is the last: a folder without it is no exercise.
    let files = [(DRAWING_FILE, drawing), (TASK_FILE, Some(task.as_bytes()))];
    for (name, bytes) in files {
        let file = folder.join(name);
        if let Some(bytes) = bytes {
            atomic::write(&file, bytes).map_err(|error| WriteError::new(&file, error).message())?;
        }
    }
    Ok(folder)
}

/// Makes the folder of a new exercise in a data directory.
fn make_task_folder(data: &Path, name: &str) -> Result<PathBuf, Message> {
    let is_plain = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_');
    if name.is_empty() || !name.chars().all(is_plain) {
        return Err(say::exercise_part_bad_name(name));
    }
    let folder = data.join(FOLDER).join(name);
    if platform::list(&folder).is_ok_and(|files| !files.is_empty()) {
        return Err(say::exercise_draft_folder(folder.display()));
    }
    platform::make_folder(&folder).map_err(|error| WriteError::new(&folder, error).message())?;
    Ok(folder)
}

/// Saves a recording as the reference solution of an exercise of a data directory and checks the
/// exercise. Returns the message for its author.
///
/// # Errors
/// The file cannot be written, or the task cannot be read.
pub fn save_reference(data: &Path, id: &str, recording: &[u8]) -> Result<Message, Message> {
    let folder = data.join(FOLDER).join(id);
    let file = folder.join(REFERENCE_RECORDING);
    atomic::write(&file, recording).map_err(|error| WriteError::new(&file, error).message())?;
    let faults = check_task(&read(&folder)?, &read_solutions(&folder)?).faults;
    Ok(match faults.is_empty() {
        true => say::exercise_reference_saved(file.display()),
        false => say::exercise_reference_faults(file.display(), say::several(faults)),
    })
}

/// Finds an exercise by its name; a name that is unknown is read as a folder.
///
/// # Errors
/// There is neither, or the task breaks a rule.
pub fn find(name: &Path, data: Option<&Path>) -> Result<ExerciseTask, Message> {
    let tasks = load_exercises(data).tasks;
    let names: Vec<String> = tasks.iter().map(|task| task.id.clone()).collect();
    if let Some(task) = tasks.into_iter().find(|task| Path::new(&task.id) == name) {
        return Ok(task);
    }
    match platform::is_taken(name) {
        true => read(name),
        false => Err(say::exercise_unknown(name.display(), names.join(" "))),
    }
}
