//! `exercise new`: drafts an exercise from a program and its job, and checks it.

use gsk_exercise::draft::draft_exercise;
use gsk_host::files::atomic;
use gsk_host::job::{self, JobArgs};
use gsk_host::loading::{self, LoadError};
use gsk_host::output::WriteError;
use gsk_host::platform;
use gsk_messages::{Language, say};

use super::super::{CommandError, output};
use super::check;
use crate::cli::ExerciseNewArgs;

/// Writes the files of a new exercise and checks it. Returns exit code 1 if the check reports
/// something.
///
/// # Errors
/// The folder is not empty, a file cannot be read or written, or the program makes no part.
pub fn draft(args: &ExerciseNewArgs, language: Option<Language>) -> Result<u8, CommandError> {
    args.setup.refuse_mill().map_err(LoadError::from)?;
    let folder = args.output.as_path();
    if platform::list(folder).is_ok_and(|files| !files.is_empty()) {
        return Err(say::exercise_draft_folder(folder.display()).into());
    }
    let mut setup = loading::command_setup(&args.setup, None, language)?;
    loading::open_program(&mut setup, core::slice::from_ref(&args.file))?.print(language);
    let job_args = JobArgs {
        part: true,
        job: args.job.clone(),
    };
    let chosen = job::choose(&job_args, Some(&args.file), &setup)?;
    if chosen.file_name().is_none() {
        output::print_message(&say::exercise_draft_guessed());
    }
    // The zero is in the task.
    let _ = chosen.set_work_zero(&mut setup);
    let draft = draft_exercise(&setup, &chosen.job)?;
    platform::make_folder(folder).map_err(|error| WriteError::new(folder, error))?;
    for (name, text) in [
        ("task.ron", &draft.task),
        ("reference.txt", &draft.reference),
        ("wrong-1.txt", &draft.wrong),
    ] {
        let path = folder.join(name);
        atomic::write(&path, text.as_bytes()).map_err(|error| WriteError::new(&path, error))?;
    }
    check(folder, language.unwrap_or(Language::En))
}
