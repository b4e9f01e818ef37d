//! `exercise pack`: exercises and the page for browsers as a package for learning platforms.

use std::path::Path;

use gsk_exercise::course::scorm::write_package;
use gsk_exercise::course::{Course, CourseFile};
use gsk_host::files::exercises;
use gsk_host::platform;
use gsk_messages::{Language, Message, say};

use super::super::{CommandError, EXIT_OK, output};
use crate::cli::ExercisePackArgs;

/// Writes a package.
///
/// # Errors
/// An exercise is unknown or breaks a rule, the folder has no page, or the file cannot be written.
pub fn pack(args: &ExercisePackArgs, language: Language) -> Result<u8, CommandError> {
    let sources = args.tasks.iter();
    let sources = sources.map(|task| exercises::find_source(task, args.data.as_deref()));
    let mut course = Course::read(CourseFile {
        title: args.title.clone().unwrap_or_default(),
        mastery_per_cent: args.mastery,
        tasks: sources.collect::<Result<_, _>>()?,
    })?;
    if args.title.is_none() {
        course.title = match course.tasks.as_slice() {
            [task] => task.title.in_language(language).into_owned(),
            _ => say::course_default_title().text(language),
        };
    }
    let target = output::reserve_file(&args.output)?;
    let package = write_package(&course, read_page(&args.page)?)?;
    target.write(&package)?;
    let (path, size) = (args.output.display(), package.len() / 1000);
    output::print_message(&say::course_packed(path, course.tasks.len(), size));
    Ok(EXIT_OK)
}

/// Reads all files of the browser page, sorted by name.
fn read_page(folder: &Path) -> Result<Vec<(String, Vec<u8>)>, Message> {
    let named = |path: &Path, error| say::subject_reason(path.display(), say::as_written(error));
    let mut paths = platform::list(folder).map_err(|error| named(folder, error))?;
    paths.sort();
    let mut files = Vec::new();
    for path in paths {
        let is_file = platform::path_facts(&path).is_ok_and(|facts| facts.is_file);
        let name = path.file_name().and_then(|name| name.to_str());
        if let Some(name) = name.filter(|_| is_file) {
            let bytes = platform::read(&path, u64::MAX).map_err(|error| named(&path, error))?;
            files.push((name.to_owned(), bytes));
        }
    }
    Ok(files)
}
