//! The GSK980TD program.

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    gsk_app::commands::carry_out(gsk_app::cli::Cli::parse())
}
