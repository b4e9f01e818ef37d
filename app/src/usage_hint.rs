//! Adds usage hints to the errors of a command line.

use std::env;
use std::ffi::OsString;
use std::path::Path;

use clap::error::{ContextKind, ContextValue};
use clap::{CommandFactory, Error, Parser};
use gsk_host::setup_args;
use gsk_messages::{Language, Message, say};

use crate::cli::{CommandLine, chinese, find_language};

/// Parses the command line of the process. Prints an error or requested help and ends the
/// process.
pub fn parse_command_line() -> CommandLine {
    let words: Vec<OsString> = env::args_os().collect();
    let parse_whole = || CommandLine::try_parse_from(&words);
    CommandLine::parse_command_call(&words)
        .map_or_else(parse_whole, Ok)
        .unwrap_or_else(|error| localize_error(error, &words).exit())
}

/// Translates a clap error, or requested help, into the language of the command line `words`.
fn localize_error(error: Error, words: &[OsString]) -> Error {
    let localized = match find_language(words) {
        Some(Language::Zh) => chinese::translate_error(words, with_hint),
        Some(Language::En) | None => None,
    };
    localized.unwrap_or_else(|| with_hint(error, Language::En))
}

/// Adds a hint to the error for an unknown command: the form that was probably meant, such as
/// an option before a file.
fn with_hint(mut error: Error, language: Language) -> Error {
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else {
        return error;
    };
    let has_similar_command = error.get(ContextKind::SuggestedSubcommand).is_some();
    if let Some(hint) = hint_for_word(word, has_similar_command) {
        let hint = ContextValue::StyledStrs(vec![hint.text(language).into()]);
        error.insert(ContextKind::Suggested, hint);
    }
    error
}

/// Returns the hint for a word that is not a command; `None` if there is none.
/// `has_similar_command`: clap knows a command with a similar name.
fn hint_for_word(word: &str, has_similar_command: bool) -> Option<Message> {
    if CommandLine::command().find_subcommand(word).is_some() {
        return Some(say::hint_options_after_command(word));
    }
    if setup_args::parse_switch(word).is_ok() {
        return Some(say::hint_first_start(word));
    }
    let extension = Path::new(word).extension();
    let is_path = extension.is_some() || word.contains(['/', '\\']);
    if has_similar_command && !is_path {
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

    fn error_text(line: &str) -> String {
        let error = CommandLine::try_parse_from(line.split_whitespace()).expect_err(line);
        with_hint(error, Language::En).to_string()
    }

    #[test]
    fn a_file_gets_a_hint_with_its_option() {
        for line in [
            "gsk980td --machine lathe.ron shaft.CNC",
            "gsk980td shaft.CNC",
            "gsk980td --machine lathe.ron --link COM3 shaft.CNC",
        ] {
            let text = error_text(line);
            assert!(text.contains("`--program shaft.CNC`"), "{text}");
            assert!(text.contains("`gsk980td run shaft.CNC`"), "{text}");
        }
        let machine = error_text("gsk980td --data here lathe.ron");
        assert!(machine.contains("`--machine lathe.ron`"), "{machine}");
        let ladder = error_text("gsk980td door.il");
        assert!(ladder.contains("`--ladder door.il`"), "{ladder}");
    }

    #[test]
    fn a_switch_without_its_equals_sign_gets_a_hint() {
        let text = error_text("gsk980td --first-start off");
        assert!(text.contains("`--first-start=off`"), "{text}");
        assert!(!text.contains("--program"), "{text}");
    }

    #[test]
    fn options_before_a_command_get_a_hint() {
        for command in ["run", "check", "link"] {
            let text = error_text(&format!("gsk980td --machine lathe.ron {command} shaft.CNC"));
            assert!(text.contains(&format!("`gsk980td {command} …`")), "{text}");
            assert!(!text.contains("--program"), "{text}");
        }
    }

    #[test]
    fn a_mistyped_command_keeps_the_tip_of_clap() {
        let text = error_text("gsk980td runn shaft.CNC");
        assert!(text.contains("similar") && text.contains("'run'"), "{text}");
        assert!(!text.contains("--program"), "{text}");
    }
}
