//! Options of `ladder`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

use super::TransferPortArgs;

/// Subcommands of the command `ladder`.
#[derive(Debug, Subcommand)]
pub enum LadderCommand {
    /// Compile a ladder and report its errors
    Check(LadderArgs),
    /// Print a ladder as it was compiled
    List(LadderArgs),
    /// Compile a ladder and scan it with all inputs off
    Run(LadderRunArgs),
    /// Find an address, an instruction or a word of a comment, with row and column
    Find(LadderFindArgs),
    /// Print the diagram as a page of HTML, which a browser shows and prints on paper or as PDF
    Print(LadderPrintArgs),
    /// List the parameters of a ladder: keep relays, data, timers, counters, with their meanings
    Parameters(LadderArgs),
    /// Send a ladder to a control through a serial port, as GSKCC does
    Send(LadderSendArgs),
    /// Read the ladder of a control through a serial port
    Read(LadderReadArgs),
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
    /// Force a bit to a value, for instance X20.1=1
    #[arg(long = "set", value_name = "ADDRESS=0|1", value_parser = gsk_host::setup_args::parse_input_bit)]
    pub bits: Vec<gsk_host::setup_args::InputBit>,
}

/// The part of the ladder that `ladder find` covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FindDirection {
    /// The whole ladder
    All,
    /// From the row upwards
    Up,
    /// From the row downwards
    Down,
}

/// Arguments of the command `ladder find`.
#[derive(Args, Debug)]
pub struct LadderFindArgs {
    /// An address (G8.4), an instruction (TMRB) or a word of a comment
    #[arg(value_name = "TEXT")]
    pub text: String,
    #[command(flatten)]
    pub ladder: LadderArgs,
    /// Section of the ladder to search
    #[arg(long, value_enum, default_value_t = FindDirection::All)]
    pub direction: FindDirection,
    /// The row from which to search up or down
    #[arg(long, default_value_t = 1, value_name = "ROW")]
    pub from: u32,
}

/// Arguments of the command `ladder print`.
#[derive(Args, Debug)]
pub struct LadderPrintArgs {
    #[command(flatten)]
    pub ladder: LadderArgs,
    /// The page (name ends in .html); `-`: standard output
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
}

/// Arguments of the command `ladder send`.
#[derive(Args, Debug)]
pub struct LadderSendArgs {
    #[command(flatten)]
    pub port: TransferPortArgs,
    #[command(flatten)]
    pub ladder: LadderArgs,
}

/// Arguments of the command `ladder read`.
#[derive(Args, Debug)]
pub struct LadderReadArgs {
    #[command(flatten)]
    pub port: TransferPortArgs,
    /// File for the ladder; `-`: standard output
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
}
