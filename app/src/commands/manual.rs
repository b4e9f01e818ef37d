//! `completions` and `man`: generated from the same table that parses the command line.

use std::fs;

use clap::CommandFactory;
use clap_mangen::Man;

use super::{CommandError, FINE};
use crate::cli::{Cli, CompletionsArgs, ManArgs};
use crate::output::{self, WriteError};

const NAME: &str = "gsk980td";

/// Prints a completion script for a shell.
pub fn completions(args: &CompletionsArgs) -> u8 {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), NAME, &mut script);
    output::print(&String::from_utf8_lossy(&script));
    FINE
}

/// Prints the manual page, or writes a page for each command into a folder.
///
/// # Errors
/// The folder or a page cannot be written.
pub fn man(args: &ManArgs) -> Result<u8, CommandError> {
    let mut program = Cli::command().disable_help_subcommand(true);
    program.build();
    let Some(folder) = &args.folder else {
        output::print(&page(&program)?);
        return Ok(FINE);
    };
    fs::create_dir_all(folder).map_err(|error| WriteError::new(folder, error))?;
    for command in every(program) {
        let text = page(&command)?;
        let path = folder.join(format!("{}.1", file_name(&command)));
        fs::write(&path, text).map_err(|error| WriteError::new(&path, error))?;
    }
    Ok(FINE)
}

/// A command and all its visible subcommands.
fn every(command: clap::Command) -> Vec<clap::Command> {
    let below = command
        .get_subcommands()
        .filter(|below| !below.is_hide_set());
    let below: Vec<_> = below.cloned().flat_map(every).collect();
    [vec![command], below].concat()
}

/// The file name of a manual page: the words of the command, joined.
fn file_name(command: &clap::Command) -> String {
    command.get_display_name().unwrap_or(NAME).to_owned()
}

fn page(command: &clap::Command) -> Result<String, CommandError> {
    let mut text = Vec::new();
    let written = Man::new(command.clone()).render(&mut text);
    written.map_err(CommandError::Output)?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_a_page_of_its_own() {
        let mut program = Cli::command().disable_help_subcommand(true);
        program.build();
        let names: Vec<_> = every(program).iter().map(file_name).collect();
        for name in ["gsk980td", "gsk980td-check", "gsk980td-link-twin"] {
            assert!(names.iter().any(|page| page == name), "{name}: {names:?}");
        }
        assert!(!names.iter().any(|page| page.contains("hold-port")));
    }

    #[test]
    fn a_page_names_the_options_of_its_command() {
        let mut program = Cli::command().disable_help_subcommand(true);
        program.build();
        let check = program.find_subcommand("check").expect("check");
        let text = page(check).expect("page");
        assert!(text.contains("work\\-zero"), "{text}");
    }
}
