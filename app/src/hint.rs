//! Adds usage hints to the errors of a command line.

use std::env;
use std::ffi::OsString;
use std::path::Path;

use clap::error::{ContextKind, ContextValue};
use clap::{CommandFactory, Error, Parser};
use gsk_messages::{Language, Message, say};

use crate::cli::{Cli, chinese, language_of};
use crate::setup_args;

/// Parses the command line of the process. On an error, or if help is requested, prints it
/// and ends the process.
pub fn command_line() -> Cli {
    let words: Vec<OsString> = env::args_os().collect();
    Cli::try_parse_from(&words).unwrap_or_else(|error| told(error, &words).exit())
}

/// The text of a clap error, or of requested help, in the language of the command line.
fn told(error: Error, words: &[OsString]) -> Error {
    let chinese = match language_of(words) {
        Some(Language::Zh) => chinese::told(words, with_hint),
        Some(Language::En) | None => None,
    };
    chinese.unwrap_or_else(|| with_hint(error, Language::En))
}

/// Adds a hint to an unknown command: the form that was probably meant, such as an option
/// before a file.
fn with_hint(mut error: Error, language: Language) -> Error {
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else {
        return error;
    };
    let alike = error.get(ContextKind::SuggestedSubcommand).is_some();
    if let Some(hint) = hint(word, alike) {
        let hint = ContextValue::StyledStrs(vec![hint.text(language).into()]);
        error.insert(ContextKind::Suggested, hint);
    }
    error
}

/// The hint for a word that is not a command. `alike`: clap knows a command with a similar
/// name.
fn hint(word: &str, alike: bool) -> Option<Message> {
    if Cli::command().find_subcommand(word).is_some() {
        return Some(say::hint_options_behind(word));
    }
    if setup_args::switch(word).is_ok() {
        return Some(say::hint_first_start(word));
    }
    let extension = Path::new(word).extension();
    let is_path = extension.is_some() || word.contains(['/', '\\']);
    if alike && !is_path {
        return None;
    }
    Some(match extension.and_then(|end| end.to_str()) {
        Some("ron") => say::hint_file("--machine", word),
        Some("il") => say::hint_file("--ladder", word),
        _ => say::hint_program(word),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(line: &str) -> String {
        let error = Cli::try_parse_from(line.split_whitespace()).expect_err(line);
        with_hint(error, Language::En).to_string()
    }

    #[test]
    fn a_file_without_its_option_is_told_the_option() {
        for line in [
            "gsk980td --machine lathe.ron shaft.CNC",
            "gsk980td shaft.CNC",
            "gsk980td --machine lathe.ron --link COM3 shaft.CNC",
        ] {
            let told = told(line);
            assert!(told.contains("`--program shaft.CNC`"), "{told}");
            assert!(told.contains("`gsk980td run shaft.CNC`"), "{told}");
        }
        let machine = told("gsk980td --data here lathe.ron");
        assert!(machine.contains("`--machine lathe.ron`"), "{machine}");
        let ladder = told("gsk980td door.il");
        assert!(ladder.contains("`--ladder door.il`"), "{ladder}");
    }

    #[test]
    fn a_switch_apart_from_its_option_is_told_the_sign_between_them() {
        let told = told("gsk980td --first-start off");
        assert!(told.contains("`--first-start=off`"), "{told}");
        assert!(!told.contains("--program"), "{told}");
    }

    #[test]
    fn options_before_a_command_are_told_their_place() {
        for command in ["run", "check", "link"] {
            let told = told(&format!("gsk980td --machine lathe.ron {command} shaft.CNC"));
            assert!(told.contains(&format!("`gsk980td {command} …`")), "{told}");
            assert!(!told.contains("--program"), "{told}");
        }
    }

    #[test]
    fn a_slip_of_the_pen_in_a_command_is_left_to_its_own_tip() {
        let told = told("gsk980td runn shaft.CNC");
        assert!(told.contains("similar") && told.contains("'run'"), "{told}");
        assert!(!told.contains("--program"), "{told}");
    }
}
