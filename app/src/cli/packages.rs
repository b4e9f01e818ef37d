//! Options of `completions` and `man`, which the packages use.

use std::path::PathBuf;

use clap::Args;
use clap_complete::Shell;

/// Arguments of the command `completions`.
#[derive(Args, Debug)]
pub struct CompletionsArgs {
    /// The shell
    #[arg(value_enum, value_name = "SHELL")]
    pub shell: Shell,
}

/// Arguments of the command `man`.
#[derive(Args, Debug)]
pub struct ManArgs {
    /// Write a page for the program and one for each command into this folder instead
    #[arg(long, value_name = "DIR")]
    pub folder: Option<PathBuf>,
}
