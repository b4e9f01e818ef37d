//! Options of `lesson`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

/// Subcommands of the command `lesson`.
#[derive(Debug, Subcommand)]
pub enum LessonCommand {
    /// List the lessons: name, number of steps, title
    List(LessonListArgs),
    /// Check the file of a lesson, its solution included
    Check(LessonCheckArgs),
    /// Run the solution of a lesson and report the result of each step
    Run(LessonRunArgs),
}

/// Arguments of the command `lesson list`.
#[derive(Args, Debug)]
pub struct LessonListArgs {
    /// Data folder with a teacher's lessons in its folder `lessons`
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
}

/// Arguments of the command `lesson check`.
#[derive(Args, Debug)]
pub struct LessonCheckArgs {
    /// The file (RON)
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
}

/// Arguments of the command `lesson run`.
#[derive(Args, Debug)]
pub struct LessonRunArgs {
    /// Name of the lesson, as `lesson list` prints it, or its file
    #[arg(value_name = "NAME|FILE")]
    pub lesson: PathBuf,
    /// Data folder with a teacher's lessons in its folder `lessons`
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
}
