//! `help`: explains commands and symbols of the control.

use clap::{Command, CommandFactory};
use gsk_help::{Topic, article, designation, document, search_model, topics_of};
use gsk_messages::{Language, say};
use gsk_panel::glyphs::text_columns;

use super::{CommandError, FINE, output};
use crate::cli::{Cli, HelpArgs, chinese};

/// Up to this number of articles are printed in full; more are listed.
const WHOLE: usize = 4;
/// Most lines of the list.
const LISTED: usize = 40;

/// Prints help on a command or a topic.
///
/// # Errors
/// No topic matches the question.
pub fn help(args: &HelpArgs, spoken: Option<Language>) -> Result<u8, CommandError> {
    let language = spoken.unwrap_or(Language::En);
    if args.list {
        let topics = topics_of(args.model.unwrap_or_default()).iter();
        output::print(&headings(&topics.collect::<Vec<_>>(), language));
        return Ok(FINE);
    }
    if args.document {
        output::print(&document(language));
        return Ok(FINE);
    }
    let mut program = match language {
        Language::Zh => chinese::command(),
        Language::En => Cli::command(),
    };
    program.build();
    let of_command = |command: &Command| {
        let help = command.clone().render_long_help().to_string();
        match language {
            Language::Zh => chinese::said(&help),
            Language::En => help,
        }
    };
    let Some(first) = args.topic.first() else {
        output::print(&of_command(&program));
        return Ok(FINE);
    };
    let mut command = program.find_subcommand(first);
    for below in args.topic.iter().skip(1) {
        command = command.and_then(|command| command.find_subcommand(below));
    }
    if let Some(command) = command.filter(|it| !it.is_hide_set()) {
        output::print(&of_command(command));
        return Ok(FINE);
    }
    let question = args.topic.join(" ");
    let found = search_model(args.model.unwrap_or_default(), &question);
    if found.is_empty() {
        return Err(CommandError::NoTopic(question));
    }
    if found.len() <= WHOLE {
        let articles = found
            .iter()
            .map(|topic| article(topic, language).to_string());
        output::print(&articles.collect::<Vec<_>>().join("\n"));
        return Ok(FINE);
    }
    output::print(&headings(&found[..found.len().min(LISTED)], language));
    if found.len() > LISTED {
        let more = say::help_more(found.len() - LISTED);
        output::print(&format!("{}\n", more.text(language)));
    }
    Ok(FINE)
}

/// One line per topic: the words that select it, and its name.
fn headings(topics: &[&Topic], language: Language) -> String {
    let line = |topic: &&Topic| {
        let name = gsk_help::subject_name(topic.subject, language);
        let asked = match language {
            Language::Zh => designation(topic.subject, language),
            Language::En => topic.subject.to_string(),
        };
        let gap = 24_usize.saturating_sub(text_columns(&asked));
        let line = format!("{asked}{} {name}", " ".repeat(gap));
        format!("{}\n", line.trim_end())
    };
    topics.iter().map(line).collect()
}
