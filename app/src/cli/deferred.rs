//! Builds the options of a command only when that command is called: other starts do not pay
//! for them.

use std::ops::Deref;

use clap::builder::Resettable;
use clap::error::Error;
use clap::{ArgMatches, Args, Command, FromArgMatches, Subcommand};

/// Options of a command, built when the command or its help is called.
#[derive(Debug)]
pub struct DeferredArgs<T>(T);

impl<T> DeferredArgs<T> {
    pub const fn new(args: T) -> Self {
        Self(args)
    }
}

impl<T> Deref for DeferredArgs<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0
    }
}

impl<T: FromArgMatches> FromArgMatches for DeferredArgs<T> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        T::from_arg_matches(matches).map(Self)
    }

    fn from_arg_matches_mut(matches: &mut ArgMatches) -> Result<Self, Error> {
        T::from_arg_matches_mut(matches).map(Self)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        self.0.update_from_arg_matches(matches)
    }
}

impl<T: Args> Args for DeferredArgs<T> {
    fn augment_args(command: Command) -> Command {
        command.defer(|command| add_options(command, T::augment_args))
    }

    fn augment_args_for_update(command: Command) -> Command {
        command.defer(|command| add_options(command, T::augment_args_for_update))
    }
}

/// The options of a command that consists of further commands.
#[derive(Args, Debug)]
pub struct CommandGroup<T: Subcommand> {
    /// The command to execute.
    #[command(subcommand)]
    pub command: T,
}

/// Adds the options to a command and keeps its description: building the options would
/// replace it.
fn add_options(command: Command, options: fn(Command) -> Command) -> Command {
    let about = Resettable::from(command.get_about().cloned());
    let long_about = Resettable::from(command.get_long_about().cloned());
    options(command).about(about).long_about(long_about)
}

#[cfg(test)]
mod tests {
    use clap::{Command, CommandFactory};

    use crate::cli::CommandLine;

    /// Returns name, number of options, and short and long description of every command.
    fn commands(program: &Command) -> Vec<(String, usize, [Option<String>; 2])> {
        let about = |command: &Command| {
            [command.get_about(), command.get_long_about()].map(|it| it.map(ToString::to_string))
        };
        let subcommands = program.get_subcommands();
        subcommands
            .map(|it| {
                (
                    it.get_name().to_owned(),
                    it.get_arguments().count(),
                    about(it),
                )
            })
            .collect()
    }

    #[test]
    fn a_called_command_has_its_options_and_the_description_of_the_list() {
        let listed = commands(&CommandLine::command());
        let mut program = CommandLine::command().disable_help_subcommand(true);
        program.build();
        let called = commands(&program);
        assert_eq!(listed.len(), called.len());
        for (listed, called) in listed.into_iter().zip(called) {
            assert_eq!((&listed.0, &listed.2), (&called.0, &called.2));
            assert!(listed.2[0].is_some(), "{}", listed.0);
            if ["run", "check", "plot", "operate"].contains(&&*listed.0) {
                assert!(listed.1 == 0 && called.1 > 5, "{}", listed.0);
            }
        }
        let exercise = |program: Command| {
            let command = program.find_subcommand("exercise").cloned();
            command.map_or(0, |it| it.get_subcommands().count())
        };
        assert_eq!(exercise(CommandLine::command()), 0);
        assert!(exercise(program) > 5);
    }
}
