//! Saves a program that has no file yet, with its job beside it, under a name that the user
//! chooses.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use egui::Context;
use gsk_core::command::ProgramId;
use gsk_core::program::Program;
use gsk_host::files::atomic;
use gsk_host::job;
use gsk_host::kernel::Console;
use gsk_messages::{Language, Message, say};
use gsk_workpiece::job::Job;

use crate::widgets::files::{self, FileChoice};

/// The program that was saved last and its new file, until the window takes them.
type SavedProgram = Arc<Mutex<Option<(ProgramId, PathBuf)>>>;

#[derive(Default)]
pub struct ProgramSaver {
    saved: SavedProgram,
}

impl ProgramSaver {
    /// Lets the user choose a file for the program `id` and writes program and job.
    pub fn save(
        &self,
        (id, program): (ProgramId, &Program),
        job: &Job,
        console: &Console,
        context: &Context,
        language: Language,
    ) {
        let name = format!("O{:04}.CNC", program.number().unwrap_or(1));
        let (text, job) = (program.text().to_owned(), job.clone());
        let saved = Arc::clone(&self.saved);
        let choice = FileChoice::Save(name, "CNC");
        let notices = &console.notice_sender;
        files::choose_file(context, language, notices, choice, move |path| {
            if let Err(why) = write_both(&path, &text, &job) {
                return Some(why);
            }
            let done = say::window_saved(path.display());
            *saved.lock().unwrap_or_else(PoisonError::into_inner) = Some((id, path));
            Some(done)
        });
    }

    /// Takes the program that was saved since the last call, with its file; `None` without one.
    pub fn take_saved(&self) -> Option<(ProgramId, PathBuf)> {
        let mut saved = self.saved.lock().unwrap_or_else(PoisonError::into_inner);
        saved.take()
    }
}

/// Writes the program, then its job beside it. Returns why one of them cannot be written as an
/// error.
fn write_both(path: &std::path::Path, text: &str, job: &Job) -> Result<(), Message> {
    atomic::write(path, text.as_bytes())
        .map_err(|error| say::subject_reason(path.display(), say::as_written(error)))?;
    job::write(&job::job_path(path), job).map_err(|error| error.message())
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_host::files::program_file;
    use gsk_workpiece::stock::Stock;

    #[test]
    fn program_and_job_are_written_beside_each_other() {
        let name = format!("gsk980td-saver-{}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&folder).expect("a folder");
        let path = folder.join("O0007.CNC");
        let job = Job::new(Stock::bar(40.0, 1.0, 60.0));
        write_both(&path, "O0007;\nM30;\n", &job).expect("written");
        let program = program_file::read(&path).expect("a program");
        assert_eq!(program.text, "O0007;\nM30;\n");
        assert_eq!(job::read(&job::job_path(&path)).expect("a job"), job);
        let missing = folder.join("none").join("O0007.CNC");
        assert!(write_both(&missing, "O0007;\n", &job).is_err());
        std::fs::remove_dir_all(&folder).expect("removed");
    }
}
