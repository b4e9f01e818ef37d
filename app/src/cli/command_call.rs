//! Parses a command line that begins with a command, without the options of the window.

use std::ffi::OsString;

use clap::{Args, Parser};
use tracing::level_filters::LevelFilter;

use super::language::language_parser;
use super::{CliCommand, CommandLine, Language, WindowArgs};

/// Options of every command and of the window.
#[derive(Args, Debug)]
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

impl CommandLine {
    /// Parses a command line whose first word is a command. `None` for any other one, and for one
    /// with an error, which the whole parser explains.
    pub fn parse_command_call(words: &[OsString]) -> Option<Self> {
        let first = words.get(1)?.to_str()?;
        if first.starts_with('-') {
            return None;
        }
        let CommandCall { command, global } = CommandCall::try_parse_from(words).ok()?;
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
            "gsk980td check a.nc --lang en --start 5,6 --deny all",
            "gsk980td run a.nc --log debug --link COM3",
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
            "gsk980td check --help",
            "gsk980td check a.nc --first-start",
            "gsk980td help-me",
        ] {
            let call = CommandLine::parse_command_call(&words(line));
            assert!(call.is_none(), "{line}");
        }
    }
}
