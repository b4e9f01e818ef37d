//! Options of `ladder`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

/// Subcommands of the command `ladder`.
#[derive(Debug, Subcommand)]
pub enum LadderCommand {
    /// Compile a ladder and say whether it is right
    Check(LadderArgs),
    /// Print a ladder as it was compiled
    List(LadderArgs),
    /// Compile a ladder and scan it with all inputs off
    Run(LadderRunArgs),
}

/// A ladder file.
#[derive(Args, Debug)]
pub struct LadderArgs {
    /// The ladder; without it the standard ladder
    #[arg(value_name = "FILE")]
    pub file: Option<PathBuf>,
}

/// Arguments of the command `ladder run`.
#[derive(Args, Debug)]
pub struct LadderRunArgs {
    /// The ladder; without it the standard ladder
    #[arg(value_name = "FILE")]
    pub file: Option<PathBuf>,
    /// Number of 8 ms slots to scan
    #[arg(long, default_value_t = 1000, value_name = "N")]
    pub slots: u32,
    /// Hold a bit, for instance X20.1=1
    #[arg(long = "set", value_name = "ADDRESS=0|1", value_parser = gsk_host::setup_args::parse_input_bit)]
    pub bits: Vec<gsk_host::setup_args::InputBit>,
}
