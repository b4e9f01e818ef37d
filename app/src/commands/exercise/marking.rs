//! `exercise mark`: replays the results in a folder on all processors.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;

use gsk_exercise::mark::{ResultMark, flag_repetitions, mark_result};
use gsk_exercise::mark_table::{MarkFormat, MarkTable};
use gsk_exercise::result_file::RESULT_EXTENSION;
use gsk_exercise::task::ExerciseTask;
use gsk_host::files::{exercises, program_file};
use gsk_host::output::WriteError;
use gsk_host::platform;
use gsk_messages::{Language, say};

use super::super::{CommandError, EXIT_ALARM, EXIT_OK, output};
use crate::cli::{ExerciseMarkArgs, MarkTableFormat};

/// Marks the results in a folder and writes the table. Returns exit code 1 if a result is not what
/// it claims.
///
/// # Errors
/// The folder has no results, or the table cannot be written.
pub fn mark(args: &ExerciseMarkArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let begun = Instant::now();
    let found = exercises::load_exercises(args.data.as_deref());
    for error in &found.errors {
        output::report_error(error);
    }
    let paths = result_paths(&args.folder)?;
    let mut marks = mark_all(&paths, &found.tasks);
    flag_repetitions(&mut marks);
    let table = MarkTable {
        marks: &marks,
        tasks: &found.tasks,
        language: language.unwrap_or(Language::En),
    };
    let text = table.write(match args.format {
        MarkTableFormat::Text => MarkFormat::Text,
        MarkTableFormat::Csv => MarkFormat::Csv,
        MarkTableFormat::Json => MarkFormat::Json,
        MarkTableFormat::Html => MarkFormat::Html,
        MarkTableFormat::Xapi => MarkFormat::Xapi,
    });
    match &args.output {
        None => output::print(&text),
        Some(path) => {
            let mut out = output::open(path)?;
            out.write_all(text.as_bytes())
                .and_then(|()| out.flush())
                .map_err(|error| WriteError::new(path, error))?;
        }
    }
    let flagged = marks.iter().filter(|mark| !mark.flags.is_empty()).count();
    let seconds = begun.elapsed().as_secs_f64();
    let summary = say::exercise_mark_summary(marks.len(), seconds, flagged);
    complain!("{}", output::localize(&summary));
    Ok(if flagged == 0 { EXIT_OK } else { EXIT_ALARM })
}

fn result_paths(folder: &Path) -> Result<Vec<PathBuf>, CommandError> {
    let named = |error| say::subject_reason(folder.display(), say::as_written(error));
    let mut paths = platform::list(folder).map_err(named)?;
    paths.retain(|path| {
        path.extension()
            .is_some_and(|it| it.eq_ignore_ascii_case(RESULT_EXTENSION))
    });
    paths.sort();
    match paths.is_empty() {
        true => Err(say::exercise_no_results(folder.display()).into()),
        false => Ok(paths),
    }
}

/// Marks the results, each on the next free processor, and returns the marks in their order.
fn mark_all(paths: &[PathBuf], tasks: &[ExerciseTask]) -> Vec<ResultMark> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut marks = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(path) = paths.get(index) else {
                return marks;
            };
            marks.push((index, mark_file(path, tasks)));
        }
    };
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let mut marks: Vec<(usize, ResultMark)> = thread::scope(|scope| {
        let workers: Vec<_> = (1..threads).map(|_| scope.spawn(work)).collect();
        let mut marks = work();
        // A worker does not panic; if one did, its results would be missing from the table.
        marks.extend(
            workers
                .into_iter()
                .filter_map(|it| it.join().ok())
                .flatten(),
        );
        marks
    });
    marks.sort_by_key(|(index, _)| *index);
    marks.into_iter().map(|(_, mark)| mark).collect()
}

fn mark_file(path: &Path, tasks: &[ExerciseTask]) -> ResultMark {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    match program_file::read_bytes(path) {
        Ok(bytes) => mark_result(&name, &bytes, tasks),
        Err(error) => ResultMark::refused(&name, error.message()),
    }
}
