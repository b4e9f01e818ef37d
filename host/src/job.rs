//! Reads, writes and guesses job files: the stock and the tools of a program.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;
use gsk_core::preview::PreviewProgress;
use gsk_core::setup::Setup;
use gsk_core::units::{NonFinite, find_non_finite};
use gsk_messages::{Message, say};
use gsk_runner::machining::{Machining, guess};
use gsk_workpiece::grid::from_grid;
use gsk_workpiece::job::Job;

use crate::files::atomic;
use crate::files::program_file::{self, ProgramFileError};
use crate::files::tool_library;
use crate::output::{self, WriteError};
use crate::platform;

/// The options that select the job of a program: stock, clamping and tools.
#[derive(Args, Clone, Debug, Default)]
pub struct JobArgs {
    /// Cut the part and look for collisions (exit code 3): stock and tools come from the job file
    /// beside the program (shaft.CNC: shaft.job.ron), else they are guessed
    #[arg(long)]
    pub part: bool,
    /// Cut the part with this job file (RON)
    #[arg(long, value_name = "FILE")]
    pub job: Option<PathBuf>,
}

/// The options that cut a part and evaluate it.
#[derive(Args, Clone, Debug, Default)]
pub struct PartArgs {
    #[command(flatten)]
    pub job: JobArgs,
    /// Cut the part and measure it: cylinders, cones, faces, arcs, threads from front to back
    #[arg(long)]
    pub measure: bool,
    /// Cut the part and write its half section as CSV: polygon, X (diameter), Z
    #[arg(long, value_name = "FILE")]
    pub section: Option<PathBuf>,
}

impl PartArgs {
    /// Whether an option of the part is given.
    pub const fn is_requested(&self) -> bool {
        self.job.is_requested() || self.measure || self.section.is_some()
    }
}

impl JobArgs {
    /// Whether an option of the job is given.
    pub const fn is_requested(&self) -> bool {
        self.part || self.job.is_some()
    }
}

/// The reason why there is no job for a program.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum JobError {
    /// The job file cannot be read.
    File(#[from] ProgramFileError),
    /// The job file is not a job in RON.
    Syntax {
        path: PathBuf,
        line: usize,
        error: Box<ron::Error>,
    },
    /// A number in the job file is not finite.
    NonFiniteNumber {
        path: PathBuf,
        line: usize,
        /// The number as written in the job file.
        token: String,
    },
    /// The job in the file breaks a rule of [`Job::check`].
    BrokenRule {
        path: PathBuf,
        /// Message about the rule that the job breaks.
        rule: Message,
    },
    /// There is no job file, and the program makes no cut from which a job can be guessed.
    NothingToGuess,
}

impl JobError {
    pub fn message(&self) -> Message {
        match self {
            Self::File(error) => error.message(),
            Self::Syntax { path, line, error } => {
                say::job_file_line(path.display(), line, say::as_written(error))
            }
            Self::NonFiniteNumber { path, line, token } => {
                say::job_file_line(path.display(), line, say::number_not_finite(token))
            }
            Self::BrokenRule { path, rule } => say::subject_reason(path.display(), rule.clone()),
            Self::NothingToGuess => say::job_cannot_be_guessed(),
        }
    }
}

/// The job selected for a program, and the file from which it was read.
#[derive(Clone, Debug, PartialEq)]
pub struct SelectedJob {
    pub job: Job,
    /// Path of the job file; `None` if the job was guessed from the moves of the program.
    pub file: Option<PathBuf>,
}

impl SelectedJob {
    /// Creates an uncut part with the stock and the tools of the job.
    pub fn create_machining(&self) -> Machining {
        Machining::new(self.job.clone())
    }

    /// Sets the work zero of the job if the setup has none, and returns the message that
    /// reports it; `None` if nothing was set.
    pub fn set_work_zero(&self, setup: &mut Setup) -> Option<Message> {
        let zero = self.job.zero.filter(|_| setup.absolute.is_none())?;
        setup.absolute = Some(setup.start.unwrap_or_default() - zero.point());
        Some(say::job_work_zero(zero.x.0, zero.z))
    }

    /// The name of the job file; `None` if the job was guessed.
    pub fn file_name(&self) -> Option<String> {
        let file = self.file.as_ref()?;
        Some(file.display().to_string())
    }
}

/// Returns the path of the job file of a program: `shaft.CNC` has `shaft.job.ron`.
pub fn job_path(program: &Path) -> PathBuf {
    program.with_extension("job.ron")
}

/// Reads a job file, with the tools that it takes from the tool library.
///
/// # Errors
/// The file cannot be read, or breaks a rule.
pub fn read(path: &Path) -> Result<Job, JobError> {
    let mut job = parse(path, &program_file::read(path)?.text)?;
    tool_library::fill_in_tools(&mut job).map_err(|rule| JobError::BrokenRule {
        path: path.to_owned(),
        rule,
    })?;
    Ok(job)
}

/// Writes a job file. A file written by hand is kept under the next free name with a `~`,
/// because its comments would be lost.
///
/// # Errors
/// The file cannot be written; the old one remains.
pub fn write(path: &Path, job: &Job) -> Result<(), WriteError> {
    let text =
        to_ron_text(job).map_err(|error| WriteError::new(path, std::io::Error::other(error)))?;
    if let Ok(before) = platform::read(path, u64::MAX) {
        let old_text = std::str::from_utf8(&before).ok();
        let old_text = old_text.and_then(|text| Some((text, parse(path, text).ok()?)));
        let is_generated =
            old_text.is_some_and(|(text, job)| to_ron_text(&job).is_ok_and(|own| own == text));
        if !is_generated {
            let backup_path = free_backup_path(path);
            atomic::write(&backup_path, &before)
                .map_err(|error| WriteError::new(&backup_path, error))?;
        }
    }
    atomic::write(path, text.as_bytes()).map_err(|error| WriteError::new(path, error))
}

/// Formats a job as RON text; an error only for values that RON cannot store.
fn to_ron_text(job: &Job) -> Result<String, ron::Error> {
    let pretty = ron::ser::PrettyConfig::new()
        .depth_limit(3)
        .indentor("    ")
        .new_line("\n");
    Ok(ron_options().to_string_pretty(job, pretty)? + "\n")
}

/// Returns the first name of `part.job.ron~`, `part.job.ron~2`, … that does not exist.
fn free_backup_path(path: &Path) -> PathBuf {
    let with_suffix = |ending: String| {
        let mut name = path.as_os_str().to_owned();
        name.push(ending);
        PathBuf::from(name)
    };
    let numbered = (2..).map(|number: u32| with_suffix(format!("~{number}")));
    let mut names = core::iter::once(with_suffix("~".to_owned())).chain(numbered);
    names
        .find(|name| !platform::is_taken(name))
        .unwrap_or_else(|| with_suffix("~".to_owned()))
}

fn ron_options() -> ron::Options {
    ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
}

/// Parses the text of a job file. `path` is for error messages only.
///
/// # Errors
/// The line that is malformed, or the rule that is broken.
pub fn parse(path: &Path, text: &str) -> Result<Job, JobError> {
    if let Some(NonFinite { line, token }) = find_non_finite(text) {
        return Err(JobError::NonFiniteNumber {
            path: path.to_owned(),
            line,
            token,
        });
    }
    let job: Job = ron_options()
        .from_str(text)
        .map_err(|error| JobError::Syntax {
            path: path.to_owned(),
            line: error.span.start.line,
            error: Box::new(error.code),
        })?;
    job.check().map_err(|rule| JobError::BrokenRule {
        path: path.to_owned(),
        rule,
    })?;
    Ok(job)
}

/// Selects the job of a program: the file named by an option, else the file beside the
/// program, else a guess from its moves.
///
/// # Errors
/// The file is faulty, or there is nothing to guess from.
pub fn choose(
    args: &JobArgs,
    program: Option<&Path>,
    setup: &Setup,
) -> Result<SelectedJob, JobError> {
    let beside = program
        .map(job_path)
        .filter(|path| platform::path_facts(path).is_ok());
    if let Some(path) = args.job.clone().or(beside) {
        let job = read(&path)?;
        return Ok(SelectedJob {
            job,
            file: Some(path),
        });
    }
    let within_budget =
        &mut |progress: &PreviewProgress| progress.moves < guess::MAX_GUESS_MOVES as u64;
    let job = guess::guess_program_job(setup, within_budget).ok_or(JobError::NothingToGuess)?;
    Ok(SelectedJob { job, file: None })
}

/// Writes the half section of a part as CSV: one line per corner with polygon number, X
/// (diameter) and Z in mm.
///
/// # Errors
/// The file cannot be written.
pub fn write_section(path: &Path, machining: &Machining) -> Result<(), WriteError> {
    let mut out = output::open(path)?;
    let section = machining.scene().part().section();
    let mut write = || -> std::io::Result<()> {
        writeln!(out, "polygon,x,z")?;
        for (number, contour) in section.contours().iter().enumerate() {
            for point in contour {
                let point = from_grid(*point);
                writeln!(out, "{number},{:.4},{:.4}", point.diameter().0, point.z)?;
            }
        }
        out.flush()
    };
    write().map_err(|error| WriteError::new(path, error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::units::{Diameter, Point};
    use gsk_workpiece::job::DiameterPoint;
    use gsk_workpiece::stock::{Stock, Tailstock};
    use gsk_workpiece::tool::Tool;

    #[test]
    fn the_job_of_a_program_lies_beside_it() {
        assert_eq!(
            job_path(Path::new("a/shaft.v2.CNC")),
            Path::new("a/shaft.v2.job.ron")
        );
    }

    #[test]
    fn a_written_job_is_read_again_and_a_file_by_hand_is_kept() {
        let folder = gsk_tests::test_folder("jobs");
        let path = folder.join("part.job.ron");
        let old = "// by hand\n(stock: (form: Bar(diameter: 40), length: 90, overhang: 50))";
        std::fs::write(&path, old).unwrap();
        let mut job = read(&path).unwrap();
        job.tools.insert(1, Tool::turning());
        job.tools.insert(12, Tool::drill(8.5));
        job.zero = Some(DiameterPoint::from(Point::new(-40.5, -320.25)));
        job.lengths
            .insert(12, DiameterPoint::from(Point::new(0.0, 31.007)));
        job.stock.tailstock = Some(Tailstock {
            quill: Diameter(40.0),
            center: Diameter(6.0),
        });
        write(&path, &job).unwrap();
        assert_eq!(read(&path).unwrap(), job);
        write(&path, &Job::new(Stock::bar(30.0, 0.0, 40.0))).unwrap();
        let read_backup = |name: &str| std::fs::read_to_string(folder.join(name)).ok();
        assert_eq!(read_backup("part.job.ron~").unwrap(), old);
        assert_eq!(
            read_backup("part.job.ron~2"),
            None,
            "what was written here is not kept"
        );
        std::fs::write(&path, "(misspelt").unwrap();
        write(&path, &job).unwrap();
        assert_eq!(read_backup("part.job.ron~2").unwrap(), "(misspelt");
    }

    #[test]
    fn a_malformed_job_is_reported_with_its_line() {
        let folder = gsk_tests::test_folder("job");
        let path = folder.join("part.job.ron");
        for (text, wanted) in [
            ("(\n stock: 5\n)", "line 2"),
            (
                "(stock: (form: Bar(diameter: -4), length: 9, overhang: 5))",
                "-4",
            ),
            ("(stok: 1)", "stok"),
        ] {
            std::fs::write(&path, text).unwrap();
            let error_text = read(&path).unwrap_err().to_string();
            assert!(error_text.contains(wanted), "{error_text}");
        }
    }
}
