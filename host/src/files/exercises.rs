//! Loads exercises: the built-in ones, those of a teacher in the folder `exercises` of the data
//! directory, and the solutions beside a task.

use std::path::{Path, PathBuf};

use gsk_exercise::check::SolutionFile;
use gsk_exercise::course::CourseTaskFile;
use gsk_exercise::library::{EXERCISES, built_in_tasks};
use gsk_exercise::task::ExerciseTask;
use gsk_messages::{Message, say};

use super::program_file;
use crate::platform;

/// Name of the folder for a teacher's exercises in the data directory.
pub const FOLDER: &str = "exercises";
/// Name of the file of a task in its folder.
pub const TASK_FILE: &str = "task.ron";

/// The exercises of the program and of a data directory, and the errors of unusable ones.
#[derive(Debug, Default)]
pub struct AvailableExercises {
    /// The built-in exercises, then those of the data directory, sorted by name.
    pub tasks: Vec<ExerciseTask>,
    /// One error for each task that cannot be used.
    pub errors: Vec<Message>,
}

/// Reads the task in a folder. The path may also be that of its file.
///
/// # Errors
/// The file cannot be read, or breaks a rule: the message names file and line.
pub fn read(path: &Path) -> Result<ExerciseTask, Message> {
    read_with_text(path).map(|(task, _)| task)
}

/// Reads the task in a folder and returns it with the text of its file.
fn read_with_text(path: &Path) -> Result<(ExerciseTask, String), Message> {
    let file = task_path(path);
    let folder = file.parent().and_then(Path::file_name).unwrap_or_default();
    let text = program_file::read(&file)
        .map_err(|error| error.message())?
        .text;
    let id = folder.to_string_lossy();
    let task = ExerciseTask::read(&id, &file.display().to_string(), &text);
    Ok((task.map_err(|error| error.message())?, text))
}

/// Finds the text of a task like [`find`], for a package.
///
/// # Errors
/// There is no such task, or it breaks a rule.
pub fn find_text(name: &Path, data: Option<&Path>) -> Result<CourseTaskFile, Message> {
    let of_teacher = data.map(|data| data.join(FOLDER).join(name));
    let of_teacher = of_teacher.filter(|folder| platform::is_taken(&folder.join(TASK_FILE)));
    let built_in = EXERCISES.iter().find(|(id, _)| Path::new(id) == name);
    let (id, text) = match (of_teacher, built_in) {
        (None, Some((id, text))) => ((*id).to_owned(), (*text).to_owned()),
        (folder, _) => {
            let folder = folder.unwrap_or_else(|| name.to_owned());
            if !platform::is_taken(&folder) {
                let names = EXERCISES.iter().map(|(id, _)| *id).collect::<Vec<_>>();
                return Err(say::exercise_unknown(name.display(), names.join(" ")));
            }
            let (task, text) = read_with_text(&folder)?;
            (task.id, text)
        }
    };
    Ok(CourseTaskFile { id, text })
}

/// Returns the path of the file of a task: `path` is the file or its folder.
fn task_path(path: &Path) -> PathBuf {
    match path.extension() {
        Some(ending) if ending.eq_ignore_ascii_case("ron") => path.to_owned(),
        _ => path.join(TASK_FILE),
    }
}

/// Reads the solutions beside a task: `reference.txt` and `wrong-1.txt`, `wrong-2.txt`, …
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
        let is_solution =
            name == "reference.txt" || (name.starts_with("wrong-") && name.ends_with(".txt"));
        if is_solution {
            let text = program_file::read(&path)
                .map_err(|error| error.message())?
                .text;
            let name = name.into_owned();
            solutions.push(SolutionFile { name, text });
        }
    }
    Ok(solutions)
}

/// Loads all exercises: the built-in ones and those of a data directory.
pub fn load_exercises(data: Option<&Path>) -> AvailableExercises {
    let mut available = AvailableExercises {
        tasks: built_in_tasks(),
        errors: Vec::new(),
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
                available.tasks.push(task);
            }
            Err(message) => available.errors.push(message),
        }
    }
    available
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
