//! A command line that is wrong is told with the form that is right.

use std::path::Path;

use clap::error::{ContextKind, ContextValue};
use clap::{CommandFactory, Error, Parser};

use crate::cli::Cli;
use crate::setup_args;

/// The command line of this program; a wrong one is told, and the program ends.
pub fn command_line() -> Cli {
    Cli::try_parse().unwrap_or_else(|error| with_hint(error).exit())
}

/// The form that was probably meant, where the window was called as a command is, or
/// a command as the window is.
fn with_hint(mut error: Error) -> Error {
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else {
        return error;
    };
    let alike = error.get(ContextKind::SuggestedSubcommand).is_some();
    if let Some(hint) = hint(word, alike) {
        let hint = ContextValue::StyledStrs(vec![hint.into()]);
        error.insert(ContextKind::Suggested, hint);
    }
    error
}

/// What to say of a word that is no command here; `alike`: one is called much the same.
fn hint(word: &str, alike: bool) -> Option<String> {
    if Cli::command().find_subcommand(word).is_some() {
        return Some(format!(
            "the options stand behind the command: `gsk980td {word} …`; `gsk980td {word} --help` \
             lists them"
        ));
    }
    if setup_args::switch(word).is_ok() {
        return Some(format!(
            "the value of `--first-start` comes after `=`: `--first-start={word}`"
        ));
    }
    let extension = Path::new(word).extension();
    let is_path = extension.is_some() || word.contains(['/', '\\']);
    if alike && !is_path {
        return None;
    }
    let option = match extension.and_then(|end| end.to_str()) {
        Some("ron") => "--machine",
        Some("il") => "--ladder",
        _ => {
            return Some(format!(
                "the window opens a program with `--program {word}`; without a window `gsk980td \
                 check {word}` looks it through and `gsk980td run {word}` executes it"
            ));
        }
    };
    Some(format!("the window takes this file with `{option} {word}`"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(line: &str) -> String {
        let error = Cli::try_parse_from(line.split_whitespace()).expect_err(line);
        with_hint(error).to_string()
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
