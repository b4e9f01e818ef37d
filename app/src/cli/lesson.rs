//! Options of `lesson`.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use gsk_messages::Language;

use super::{language, locale};

/// `lesson`.
#[derive(Debug, Subcommand)]
pub enum LessonCommand {
    /// List the lessons: name, number of steps, title
    List(LessonListArgs),
    /// Check the file of a lesson, its solution included
    Check(LessonCheckArgs),
    /// Play the solution of a lesson and say of every step whether it comes true
    Run(LessonRunArgs),
}

impl LessonCommand {
    /// The language that is asked for.
    pub const fn language(&self) -> Option<Language> {
        match self {
            Self::List(args) => args.lang,
            Self::Check(args) => args.lang,
            Self::Run(args) => args.lang,
        }
    }
}

/// `lesson list`.
#[derive(Args, Debug)]
pub struct LessonListArgs {
    /// Data folder whose `lessons` hold those of a teacher
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Language of titles and messages [default: zh on a Chinese system, else en]
    #[arg(long, value_parser = language(), value_name = "LANG", default_value = locale(), hide_default_value = true)]
    pub lang: Option<Language>,
}

/// `lesson check`.
#[derive(Args, Debug)]
pub struct LessonCheckArgs {
    /// The file (RON)
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Language of titles and messages [default: zh on a Chinese system, else en]
    #[arg(long, value_parser = language(), value_name = "LANG", default_value = locale(), hide_default_value = true)]
    pub lang: Option<Language>,
}

/// `lesson run`.
#[derive(Args, Debug)]
pub struct LessonRunArgs {
    /// Its name, as `lesson list` says it, or its file
    #[arg(value_name = "NAME|FILE")]
    pub lesson: PathBuf,
    /// Data folder whose `lessons` hold those of a teacher
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Language of titles and messages [default: zh on a Chinese system, else en]
    #[arg(long, value_parser = language(), value_name = "LANG", default_value = locale(), hide_default_value = true)]
    pub lang: Option<Language>,
}
