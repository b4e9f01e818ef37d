//! Entry point of the program: parses the command line and carries it out.

use std::process::ExitCode;

use gsk_messages::MessageTable;

static TEXTS: MessageTable = MessageTable::new(include_str!("../../assets/tables/messages.tsv"));

fn main() -> ExitCode {
    gsk_messages::install_texts(&TEXTS);
    gsk_app::commands::run_command_line(gsk_app::usage_hint::parse_command_line())
}
