//! Parses a command line that begins with a command, without the options of the window and,
//! for the commands that scripts call for each program, without the other commands.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Args, Parser};
use tracing::level_filters::LevelFilter;

use super::deferred::DeferredArgs;
use super::language::language_parser;
use super::{CheckArgs, CliCommand, CommandLine, Language, WindowArgs};

/// Options of every command and of the window.
#[derive(Args, Debug, Default)]
pub struct GlobalArgs {
    /// Level of the log: off, error, warn, info, debug or trace. The window logs into `log` of the
    /// data folder, a command to standard error [default: info in the window, off for commands]
    #[arg(long, global = true, value_name = "LEVEL", value_parser = gsk_host::log::parse_level)]
    pub log: Option<LevelFilter>,
    /// Language of messages; the panel keeps its printed legends [default: zh on a Chinese system,
    /// else English with the Chinese texts of the screen; the window keeps its last choice, `lsp`
    /// follows the editor]
    #[arg(long, global = true, value_parser = language_parser(), value_name = "LANG")]
    pub lang: Option<Language>,
}

/// A command with its options. The parser builds no option of the window, which a command does
/// not have.
#[derive(Debug, Parser)]
#[command(name = "gsk980td", disable_help_subcommand = true)]
struct CommandCall {
    #[command(subcommand)]
    command: CliCommand,
    #[command(flatten)]
    global: GlobalArgs,
}

/// The options of one command. The parser builds no other command.
#[derive(Debug, Parser)]
struct SingleCommand<T: Args> {
    #[command(flatten)]
    args: T,
    #[command(flatten)]
    global: GlobalArgs,
}

/// Parses the words from the name of the command on; `None` for an error or a request for help.
fn parse_single<T: Args>(
    words: &[OsString],
    command: fn(DeferredArgs<T>) -> CliCommand,
) -> Option<CommandCall> {
    let SingleCommand { args, global } = SingleCommand::try_parse_from(words).ok()?;
    Some(CommandCall {
        command: command(DeferredArgs::new(args)),
        global,
    })
}

/// Parses a `check` of files without options. Its options have their defaults: building them for
/// the parser would take a quarter of the start of the program. `None` for other words.
fn parse_check_of_files(words: &[OsString]) -> Option<CommandCall> {
    let (_, files) = words.split_first()?;
    let is_file = |word: &OsString| !matches!(word.as_encoded_bytes(), [] | [b'-', ..]);
    if files.is_empty() || !files.iter().all(is_file) {
        return None;
    }
    let args = CheckArgs {
        files: files.iter().map(PathBuf::from).collect(),
        ..CheckArgs::default()
    };
    Some(CommandCall {
        command: CliCommand::Check(DeferredArgs::new(args)),
        global: GlobalArgs::default(),
    })
}

impl CommandLine {
    /// Parses a command line whose first word is a command. `None` for any other one, and for one
    /// with an error, which the whole parser explains.
    pub fn parse_command_call(words: &[OsString]) -> Option<Self> {
        let first = words.get(1)?.to_str()?;
        if first.starts_with('-') {
            return None;
        }
        let call = match first {
            "check" => parse_check_of_files(&words[1..])
                .or_else(|| parse_single(&words[1..], CliCommand::Check)),
            "plot" => parse_single(&words[1..], CliCommand::Plot),
            "run" => parse_single(&words[1..], CliCommand::Run),
            _ => CommandCall::try_parse_from(words).ok(),
        };
        let CommandCall { command, global } = call?;
        Some(Self {
            command: Some(command),
            global,
            window: WindowArgs::default(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(line: &str) -> Vec<OsString> {
        line.split(' ').map(OsString::from).collect()
    }

    #[test]
    fn a_called_command_is_parsed_as_by_the_whole_parser() {
        for line in [
            "gsk980td check a.nc",
            "gsk980td check a.nc programs/b.nc c",
            "gsk980td check a.nc --lang en --start 5,6 --deny all",
            "gsk980td run a.nc --log debug --link COM3",
            "gsk980td plot a.nc -o a.png",
            "gsk980td check -- -a.nc",
            "gsk980td ladder check a.il --lang zh",
            "gsk980td notices",
        ] {
            let called = CommandLine::parse_command_call(&words(line)).expect(line);
            let whole = CommandLine::try_parse_from(words(line)).expect(line);
            let parsed = |it: &CommandLine| format!("{:?} {:?}", it.command, it.global);
            assert_eq!(parsed(&called), parsed(&whole), "{line}");
        }
    }

    #[test]
    fn the_whole_parser_handles_other_command_lines() {
        for line in [
            "gsk980td",
            "gsk980td --lang en check a.nc",
            "gsk980td check",
            "gsk980td check ",
            "gsk980td check a.nc -x",
            "gsk980td check --help",
            "gsk980td check a.nc --version",
            "gsk980td check a.nc --first-start",
            "gsk980td help-me",
        ] {
            let call = CommandLine::parse_command_call(&words(line));
            assert!(call.is_none(), "{line}");
        }
    }
}
