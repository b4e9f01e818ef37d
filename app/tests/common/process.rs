//! The program as a process of its own.

use std::process::Command;

/// A call of the program that says what it says on any system, a Chinese one, too.
pub fn executable() -> Command {
    let mut call = Command::new(env!("CARGO_BIN_EXE_gsk980td"));
    call.env("LC_ALL", "C");
    call
}
