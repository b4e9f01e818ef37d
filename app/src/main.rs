//! Entry point of the program: parses the command line and carries it out.

use std::process::ExitCode;

fn main() -> ExitCode {
    gsk_messages::install_texts(include_str!("../../assets/tables/messages.tsv"));
    gsk_app::commands::run_command_line(gsk_app::usage_hint::parse_command_line())
}
