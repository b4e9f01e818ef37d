//! Options of `exercise`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use gsk_host::setup_args::SetupArgs;

/// Subcommands of the command `exercise`.
#[derive(Debug, Subcommand)]
pub enum ExerciseCommand {
    /// List the exercises: name, criteria, points, time, title
    List(ExerciseListArgs),
    /// Check an exercise: its reference solution gets all points, its wrong solutions fail as they
    /// state
    Check(ExerciseCheckArgs),
    /// Run an operator script as the solution of an exercise and write the result
    Solve(ExerciseSolveArgs),
    /// Replay every result in a folder and print a table of the marks
    ///
    /// Every result is replayed from the start of its exercise, on all processors. Exit code 1:
    /// a result is not what it claims.
    Mark(ExerciseMarkArgs),
    /// Draft an exercise from a program and its job: its part becomes drawing and criteria
    New(ExerciseNewArgs),
    /// Draw the part of an exercise with the dimensions that are marked, as SVG
    Drawing(ExerciseDrawingArgs),
    /// Run the reference solution of an exercise and print the outline of its part, for task.ron
    Outline(ExerciseOutlineArgs),
    /// Pack exercises for a learning platform: a SCORM 1.2 package of the page for browsers
    ///
    /// The platform gets score, state, attempts and time. A sealed result is a download of the
    /// learner.
    Pack(ExercisePackArgs),
}

/// Arguments of the command `exercise list`.
#[derive(Args, Debug)]
pub struct ExerciseListArgs {
    /// Data folder with a teacher's exercises in its folder `exercises`
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
}

/// Arguments of the command `exercise check`.
#[derive(Args, Debug)]
pub struct ExerciseCheckArgs {
    /// Folder of the exercise: task.ron, reference.txt, wrong-1.txt, wrong-2.txt, …
    #[arg(value_name = "DIR")]
    pub task: PathBuf,
}

/// Arguments of the command `exercise solve`.
#[derive(Args, Debug)]
pub struct ExerciseSolveArgs {
    /// Name of the exercise, as `exercise list` prints it, or its folder
    #[arg(value_name = "NAME|DIR")]
    pub task: PathBuf,
    /// The operator script
    #[arg(long, value_name = "FILE")]
    pub script: PathBuf,
    /// File of the result
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Name of the learner [default: the name of the script]
    #[arg(long, value_name = "NAME")]
    pub learner: Option<String>,
    /// Number of a hint that the learner read (may be repeated)
    #[arg(long, value_name = "N")]
    pub hint: Vec<u32>,
    /// Data folder with a teacher's exercises in its folder `exercises`, and with the key that
    /// seals results
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
}

/// Arguments of the command `exercise mark`.
#[derive(Args, Debug)]
pub struct ExerciseMarkArgs {
    /// The folder with the results (.gskresult)
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Format of the table
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    pub format: MarkTableFormat,
    /// File of the table [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Data folder with a teacher's exercises in its folder `exercises`
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
}

/// Arguments of the command `exercise new`.
#[derive(Args, Debug)]
pub struct ExerciseNewArgs {
    /// The program that makes the part
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Folder of the new exercise
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// The job file (RON) with stock and tools [default: beside the program (shaft.CNC:
    /// shaft.job.ron), else guessed]
    #[arg(long, value_name = "FILE")]
    pub job: Option<PathBuf>,
    #[command(flatten)]
    pub setup: SetupArgs,
}

/// Arguments of the command `exercise drawing`.
#[derive(Args, Debug)]
pub struct ExerciseDrawingArgs {
    /// Name of the exercise, as `exercise list` prints it, or its folder
    #[arg(value_name = "NAME|DIR")]
    pub task: PathBuf,
    /// File of the drawing (.svg)
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Data folder with a teacher's exercises in its folder `exercises`
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
}

/// Arguments of the command `exercise outline`.
#[derive(Args, Debug)]
pub struct ExerciseOutlineArgs {
    /// Folder of the exercise, with task.ron and reference.txt
    #[arg(value_name = "DIR")]
    pub task: PathBuf,
}

/// Arguments of the command `exercise pack`.
#[derive(Args, Debug)]
pub struct ExercisePackArgs {
    /// Names of the exercises, as `exercise list` prints them, or their folders
    #[arg(value_name = "NAME|DIR", required = true)]
    pub tasks: Vec<PathBuf>,
    /// Folder of the page for browsers (gsk980td-…-web.zip, unpacked)
    #[arg(long, value_name = "DIR")]
    pub page: PathBuf,
    /// File of the package (.zip)
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Score in percent from which the package is passed [default: no score, only completed]
    #[arg(long, value_name = "PERCENT", value_parser = clap::value_parser!(u32).range(1..=100))]
    pub mastery: Option<u32>,
    /// Title in the learning platform [default: the title of the exercise, if it is one]
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,
    /// Data folder with a teacher's exercises in its folder `exercises`
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
}

/// Format of the table of `exercise mark`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum MarkTableFormat {
    /// Aligned columns
    #[default]
    Text,
    /// Comma-separated values, for a spreadsheet
    Csv,
    /// All criteria with their evidence
    Json,
    /// HTML page with all criteria and their evidence
    Html,
    /// Statements for a learning record store (xAPI)
    Xapi,
}
