//! Entry point of the program: parses the command line and carries it out.

use std::process::ExitCode;

fn main() -> ExitCode {
    gsk_app::commands::carry_out(gsk_app::hint::command_line())
}
