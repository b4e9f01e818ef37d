//! The GSK980TD program.

use std::process::ExitCode;

fn main() -> ExitCode {
    gsk_app::commands::carry_out(gsk_app::hint::command_line())
}
