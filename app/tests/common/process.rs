//! Runs the program in a separate process.

use std::process::Command;

/// A command that runs the program with English messages on every system.
pub fn executable() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gsk980td"));
    command.env("LC_ALL", "C");
    command
}
