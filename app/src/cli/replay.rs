//! Options of `replay`.

use std::path::PathBuf;

use clap::Args;
use gsk_host::setup_args;

/// Arguments of the command `replay`.
#[derive(Args, Debug)]
pub struct ReplayArgs {
    /// The recording
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Print the LCD at this machine time since the start of the program, for instance 90s, 10m
    #[arg(long, value_name = "TIME", value_parser = setup_args::parse_duration_ms)]
    pub at: Option<u64>,
    /// Print the recorded exchange with a pulse board: machine time in s, > to the board, < from it
    #[arg(long)]
    pub exchange: bool,
}
