//! Chooses the job of a program: the one that the user has changed, else the one of its file, its
//! sample or its forms.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use gsk_core::command::ProgramId;
use gsk_core::program::Program;
use gsk_host::job::{self, SelectedJob};
use gsk_messages::Message;
use gsk_workpiece::job::Job;

use crate::samples;

/// The program to which a job belongs, and its file if it has one.
pub type JobOwner = (Option<ProgramId>, Option<PathBuf>);

/// Jobs that the user has changed. They are kept while the view is closed.
#[derive(Clone, Debug, Default)]
pub struct ChangedJobs(Arc<Mutex<Vec<(JobOwner, SelectedJob)>>>);

impl ChangedJobs {
    /// Returns the changed job of a program.
    pub fn find(&self, owner: &JobOwner) -> Option<Job> {
        let all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let entry = all.iter().find(|(of, _)| of == owner);
        entry.map(|(_, chosen)| chosen.job.clone())
    }

    /// Keeps a job as that of a program.
    pub fn keep(&self, owner: JobOwner, chosen: SelectedJob) {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        all.retain(|(of, _)| *of != owner);
        all.push((owner, chosen));
    }

    /// Drops the changed job of a program; returns false if there is none.
    pub fn forget(&self, owner: &JobOwner) -> bool {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let before = all.len();
        all.retain(|(of, _)| of != owner);
        all.len() < before
    }

    /// Keeps the stock that the user has clamped without a program, when he then creates
    /// `program`.
    pub fn keep_clamped_stock(&self, program: &Program, owner: &JobOwner) {
        let is_new = program.block_count() <= 1 && owner.1.is_none();
        if is_new
            && self.find(owner).is_none()
            && let Some(job) = self.find(&(None, None))
        {
            self.keep(owner.clone(), SelectedJob { job, file: None });
        }
    }
}

/// Returns a job that the user has changed, with the name of the job file beside `program_file` if
/// that exists.
fn to_selected_job(job: Job, program_file: Option<&Path>) -> SelectedJob {
    let file = program_file.map(job::job_path);
    SelectedJob {
        job,
        file: file.filter(|path| path.exists()),
    }
}

/// Returns the job as `changed` by the user, else that of the program; `None` if there is none. The
/// second value is the error in the job file.
pub fn choose_job(
    program: Option<&Program>,
    changed: Option<&Job>,
    program_file: Option<&Path>,
) -> (Option<SelectedJob>, Option<Message>) {
    let (read, error) = read_job(program, program_file);
    let changed = changed.map(|job| {
        let own = to_selected_job(job.clone(), program_file);
        // Changed, the job of a sample is still a given one.
        let file = own.file.clone();
        let file = file.or_else(|| read.as_ref().and_then(|it| it.file.clone()));
        SelectedJob { file, ..own }
    });
    (changed.or(read), error)
}

/// Reads the job file beside the program, or takes the built-in job of a sample, or that of the
/// forms in the program.
fn read_job(
    program: Option<&Program>,
    program_file: Option<&Path>,
) -> (Option<SelectedJob>, Option<Message>) {
    let job_file = program_file.map(job::job_path);
    let Some(path) = job_file.filter(|path| path.exists()) else {
        return (program.and_then(job_of_text), None);
    };
    match job::read(&path) {
        Ok(job) => {
            let file = Some(path);
            (Some(SelectedJob { job, file }), None)
        }
        Err(error) => (None, Some(error.message())),
    }
}

/// The built-in job of a sample, or the stock and the tools of the forms in a program.
fn job_of_text(program: &Program) -> Option<SelectedJob> {
    samples::job_of(program).or_else(|| {
        let job = gsk_forms::program_job(program.text())?;
        Some(SelectedJob { job, file: None })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clamped() -> SelectedJob {
        let job = gsk_runner::machining::guess::practice_job(&Default::default());
        SelectedJob { job, file: None }
    }

    #[test]
    fn stock_clamped_without_a_program_stays_for_a_new_one() {
        let jobs = ChangedJobs::default();
        jobs.keep((None, None), clamped());
        let owner = (Some(ProgramId::Stored(7)), None);
        jobs.keep_clamped_stock(&Program::new("O0007;\nG01 X1;\nM30;\n"), &owner);
        assert_eq!(jobs.find(&owner), None);
        jobs.keep_clamped_stock(&Program::new("O0007;\n"), &owner);
        assert_eq!(jobs.find(&owner), Some(clamped().job));
    }

    #[test]
    fn a_changed_job_of_a_sample_is_still_a_given_one() {
        let sample = samples::samples_of(gsk_core::model::ModelId::Gsk980td)
            .next()
            .expect("a sample");
        let program = sample.to_opened().program;
        let (own, _) = choose_job(Some(&program), None, None);
        let own = own.expect("a job");
        assert!(own.file.is_some());
        let (changed, _) = choose_job(Some(&program), Some(&clamped().job), None);
        let changed = changed.expect("a job");
        assert_eq!((&changed.job, &changed.file), (&clamped().job, &own.file));
        let (guessed, _) = choose_job(None, Some(&clamped().job), None);
        assert_eq!(guessed.expect("a job").file, None);
    }

    #[test]
    fn a_program_keeps_the_job_that_the_user_has_changed() {
        let jobs = ChangedJobs::default();
        let owner = (Some(ProgramId::Stored(7)), None);
        let mut own = clamped();
        own.job.tools.clear();
        jobs.keep(owner.clone(), own.clone());
        jobs.keep((None, None), clamped());
        jobs.keep_clamped_stock(&Program::new("O0007;\n"), &owner);
        assert_eq!(jobs.find(&owner), Some(own.job));
        // Opened anew, it has its own job again.
        assert!(jobs.forget(&owner) && !jobs.forget(&owner));
        assert_eq!(jobs.find(&owner), None);
    }
}
