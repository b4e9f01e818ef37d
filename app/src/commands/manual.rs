//! `completions` and `man`: generated from the same table that parses the command line.

use std::fs;

use clap::CommandFactory;
use clap_mangen::Man;
use gsk_host::output::{self, WriteError};

use super::{CommandError, EXIT_OK};
use crate::cli::{CommandLine, CompletionsArgs, ManArgs};

const NAME: &str = "gsk980td";

/// Prints the completion script for the shell in `args`; returns the exit code.
pub fn completions(args: &CompletionsArgs) -> u8 {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut CommandLine::command(), NAME, &mut script);
    output::print(&String::from_utf8_lossy(&script));
    EXIT_OK
}

/// Prints the manual page, or writes a page for each command into a folder.
///
/// # Errors
/// The folder or a page cannot be written.
pub fn man(args: &ManArgs) -> Result<u8, CommandError> {
    let mut program = CommandLine::command().disable_help_subcommand(true);
    program.build();
    let Some(folder) = &args.folder else {
        output::print(&manual_page(&program)?);
        return Ok(EXIT_OK);
    };
    fs::create_dir_all(folder).map_err(|error| WriteError::new(folder, error))?;
    for command in visible_commands(program) {
        let text = manual_page(&command)?;
        let path = folder.join(format!("{}.1", file_name(&command)));
        fs::write(&path, text).map_err(|error| WriteError::new(&path, error))?;
    }
    Ok(EXIT_OK)
}

/// Returns a command and all its visible subcommands.
fn visible_commands(command: clap::Command) -> Vec<clap::Command> {
    let below = command
        .get_subcommands()
        .filter(|below| !below.is_hide_set());
    let below: Vec<_> = below.cloned().flat_map(visible_commands).collect();
    [vec![command], below].concat()
}

/// The file name of a manual page without extension: the words of the command, joined.
fn file_name(command: &clap::Command) -> String {
    command.get_display_name().unwrap_or(NAME).to_owned()
}

fn manual_page(command: &clap::Command) -> Result<String, CommandError> {
    let mut text = Vec::new();
    let written = Man::new(command.clone()).render(&mut text);
    written.map_err(CommandError::output)?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_a_manual_page() {
        let mut program = CommandLine::command().disable_help_subcommand(true);
        program.build();
        let names: Vec<_> = visible_commands(program).iter().map(file_name).collect();
        for name in ["gsk980td", "gsk980td-check", "gsk980td-link-twin"] {
            assert!(names.iter().any(|page| page == name), "{name}: {names:?}");
        }
        assert!(!names.iter().any(|page| page.contains("hold-port")));
    }

    #[test]
    fn a_page_names_the_options_of_its_command() {
        let mut program = CommandLine::command().disable_help_subcommand(true);
        program.build();
        let check = program.find_subcommand("check").expect("check");
        let text = manual_page(check).expect("page");
        assert!(text.contains("work\\-zero"), "{text}");
    }
}
