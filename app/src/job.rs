//! Job files: the stock and the tools of a program, beside it.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;
use gsk_core::preview::Progress;
use gsk_core::setup::Setup;
use gsk_core::units::{NonFinite, find_non_finite};
use gsk_messages::{Message, say};
use gsk_runner::machining::{Machining, guess};
use gsk_workpiece::grid::from_grid;
use gsk_workpiece::job::Job;

use crate::files::atomic;
use crate::files::program_file::{self, FileError};
use crate::output::{self, WriteError};
use crate::platform;

/// On which part a program is carried out.
#[derive(Args, Clone, Debug, Default)]
pub struct JobArgs {
    /// Cut the part and look for collisions (exit code 3): stock and tools come from the job file
    /// beside the program (shaft.CNC: shaft.job.ron), else they are guessed
    #[arg(long)]
    pub part: bool,
    /// The same with this job file (RON)
    #[arg(long, value_name = "FILE")]
    pub job: Option<PathBuf>,
}

/// Whether a program is carried out on a part, and what is made of it.
#[derive(Args, Clone, Debug, Default)]
pub struct PartArgs {
    /// The part.
    #[command(flatten)]
    pub job: JobArgs,
    /// The same, and measure the part: cylinders, cones, faces, arcs, threads from front to back
    #[arg(long)]
    pub measure: bool,
    /// The same, and write the half section of the part as CSV: polygon, X (diameter), Z
    #[arg(long, value_name = "FILE")]
    pub section: Option<PathBuf>,
}

impl PartArgs {
    /// Whether there is to be a part.
    pub const fn wanted(&self) -> bool {
        self.job.wanted() || self.measure || self.section.is_some()
    }
}

impl JobArgs {
    /// Whether there is to be a part.
    pub const fn wanted(&self) -> bool {
        self.part || self.job.is_some()
    }
}

/// Why there is no job.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum JobError {
    /// Its file.
    File(#[from] FileError),
    /// A file that is no job.
    Syntax {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// What is wrong there.
        error: Box<ron::Error>,
    },
    /// A number that is not finite.
    Number {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// As it is written.
        token: String,
    },
    /// A job that breaks a rule.
    Rule {
        /// The file.
        path: PathBuf,
        /// The rule.
        rule: Message,
    },
    /// There is nothing to guess from.
    NothingCut,
}

impl JobError {
    /// What is said of it.
    pub fn message(&self) -> Message {
        match self {
            Self::File(error) => error.message(),
            Self::Syntax { path, line, error } => {
                say::job_file_line(path.display(), line, say::as_written(error))
            }
            Self::Number { path, line, token } => {
                say::job_file_line(path.display(), line, say::number_not_finite(token))
            }
            Self::Rule { path, rule } => say::subject_reason(path.display(), rule.clone()),
            Self::NothingCut => say::job_cannot_be_guessed(),
        }
    }
}

/// A job, and where it comes from.
#[derive(Clone, Debug)]
pub struct Chosen {
    /// The job.
    pub job: Job,
    /// Its file; none of a guess.
    pub file: Option<PathBuf>,
}

impl Chosen {
    /// A part to be cut.
    pub fn machining(&self) -> Machining {
        Machining::new(self.job.clone())
    }

    /// Where nobody else says where the work lies on the machine, the job does: returns
    /// what has to be said then.
    pub fn set_work_zero(&self, setup: &mut Setup) -> Option<Message> {
        let zero = self.job.zero.filter(|_| setup.absolute.is_none())?;
        setup.absolute = Some(setup.start.unwrap_or_default() - zero.point());
        Some(say::job_work_zero(zero.x.0, zero.z))
    }

    /// The name of its file.
    pub fn name(&self) -> Option<String> {
        let file = self.file.as_ref()?;
        Some(file.display().to_string())
    }
}

/// The file of the job of a program.
pub fn beside(program: &Path) -> PathBuf {
    program.with_extension("job.ron")
}

/// Reads a job file.
///
/// # Errors
/// The file, or the rule that is broken.
pub fn read(path: &Path) -> Result<Job, JobError> {
    parse(path, &program_file::read(path)?.text)
}

/// Writes a job file. One that a person wrote stays beside it under the next free name
/// with a `~`: its comments are not written again.
///
/// # Errors
/// What the system says; the old file stands.
pub fn write(path: &Path, job: &Job) -> Result<(), WriteError> {
    let text = text_of(job).map_err(|error| WriteError::new(path, std::io::Error::other(error)))?;
    if let Ok(before) = platform::read(path, u64::MAX) {
        let own = std::str::from_utf8(&before).ok();
        let own = own.and_then(|text| Some((text, parse(path, text).ok()?)));
        let is_own = own.is_some_and(|(text, job)| text_of(&job).is_ok_and(|own| own == text));
        if !is_own {
            let kept = free_beside(path);
            atomic::write(&kept, &before).map_err(|error| WriteError::new(&kept, error))?;
        }
    }
    atomic::write(path, text.as_bytes()).map_err(|error| WriteError::new(path, error))
}

/// A job as it is written.
fn text_of(job: &Job) -> Result<String, ron::Error> {
    let pretty = ron::ser::PrettyConfig::new()
        .depth_limit(3)
        .indentor("    ")
        .new_line("\n");
    Ok(options().to_string_pretty(job, pretty)? + "\n")
}

/// `part.job.ron~`, `part.job.ron~2`, …: the first that is free.
fn free_beside(path: &Path) -> PathBuf {
    let named = |ending: String| {
        let mut name = path.as_os_str().to_owned();
        name.push(ending);
        PathBuf::from(name)
    };
    let numbered = (2..).map(|number: u32| named(format!("~{number}")));
    let mut names = core::iter::once(named("~".to_owned())).chain(numbered);
    names
        .find(|name| !platform::is_taken(name))
        .unwrap_or_else(|| named("~".to_owned()))
}

fn options() -> ron::Options {
    ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
}

/// The job in the text of a file.
///
/// # Errors
/// The line, or the rule that is broken.
pub fn parse(path: &Path, text: &str) -> Result<Job, JobError> {
    if let Some(NonFinite { line, token }) = find_non_finite(text) {
        return Err(JobError::Number {
            path: path.to_owned(),
            line,
            token,
        });
    }
    let job: Job = options().from_str(text).map_err(|error| JobError::Syntax {
        path: path.to_owned(),
        line: error.span.start.line,
        error: Box::new(error.code),
    })?;
    job.check().map_err(|rule| JobError::Rule {
        path: path.to_owned(),
        rule,
    })?;
    Ok(job)
}

/// The job of the program in a set-up: the file that was named, the one beside the
/// program, or a guess.
///
/// # Errors
/// No job can be had.
pub fn choose(args: &JobArgs, program: Option<&Path>, setup: &Setup) -> Result<Chosen, JobError> {
    let beside = program
        .map(beside)
        .filter(|path| platform::facts(path).is_ok());
    if let Some(path) = args.job.clone().or(beside) {
        let job = read(&path)?;
        return Ok(Chosen {
            job,
            file: Some(path),
        });
    }
    let goes_on = &mut |progress: &Progress| progress.moves < guess::MOST_MOVES as u64;
    let job = guess::of_program(setup, goes_on).ok_or(JobError::NothingCut)?;
    Ok(Chosen { job, file: None })
}

/// Writes the half section of a part: a line for each corner, with the number of its
/// polygon.
///
/// # Errors
/// It cannot be written.
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
            beside(Path::new("a/shaft.v2.CNC")),
            Path::new("a/shaft.v2.job.ron")
        );
    }

    #[test]
    fn what_is_written_is_read_again_and_the_file_before_is_kept() {
        let folder = crate::files::test_folder("jobs");
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
        let kept = |name: &str| std::fs::read_to_string(folder.join(name)).ok();
        assert_eq!(kept("part.job.ron~").unwrap(), old);
        assert_eq!(
            kept("part.job.ron~2"),
            None,
            "what was written here is not kept"
        );
        std::fs::write(&path, "(misspelt").unwrap();
        write(&path, &job).unwrap();
        assert_eq!(kept("part.job.ron~2").unwrap(), "(misspelt");
    }

    #[test]
    fn a_file_that_is_no_job_is_named_with_its_line() {
        let folder = crate::files::test_folder("job");
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
            let said = read(&path).unwrap_err().to_string();
            assert!(said.contains(wanted), "{said}");
        }
    }
}
