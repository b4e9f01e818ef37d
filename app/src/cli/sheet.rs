//! Options of `sheet`.

use std::path::PathBuf;

use clap::Args;
use gsk_host::setup_args::SetupArgs;

use super::LookArgs;

/// Arguments of the command `sheet`.
#[derive(Args, Debug)]
pub struct SheetArgs {
    /// The program
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// The sheet (name ends in .html, or .pdf if Chromium, Chrome or Edge is installed); `-`: standard output [default: beside the program, shaft.CNC: shaft.sheet.html]
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// The job file (RON) with stock and tools [default: beside the program (shaft.CNC: shaft.job.ron), else guessed]
    #[arg(long, value_name = "FILE")]
    pub job: Option<PathBuf>,
    #[command(flatten)]
    pub look: LookArgs,
    #[command(flatten)]
    pub setup: SetupArgs,
}
