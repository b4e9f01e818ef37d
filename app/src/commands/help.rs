//! `help`: explains commands and symbols of the control.

use clap::{Command, CommandFactory};
use gsk_help::{Topic, article, designation, document, search_model, topics_of};
use gsk_messages::{Language, say};
use gsk_panel::glyphs::text_columns;

use super::{CommandError, EXIT_OK, output};
use crate::cli::{CommandLine, HelpArgs, chinese};

/// Up to this number of articles are printed in full; more are listed.
const MAX_FULL_ARTICLES: usize = 4;
/// Maximum number of lines in the list of topics.
const MAX_LISTED_TOPICS: usize = 40;

/// Prints help on a command or a topic.
///
/// # Errors
/// No topic matches the question.
pub fn help(args: &HelpArgs, spoken: Option<Language>) -> Result<u8, CommandError> {
    let language = spoken.unwrap_or(Language::En);
    if args.list {
        let topics = topics_of(args.model.unwrap_or_default()).iter();
        output::print(&format_headings(&topics.collect::<Vec<_>>(), language));
        return Ok(EXIT_OK);
    }
    if args.document {
        output::print(&document(language));
        return Ok(EXIT_OK);
    }
    let mut program = match language {
        Language::Zh => chinese::chinese_command(),
        Language::En => CommandLine::command(),
    };
    program.build();
    let render_help = |command: &Command| {
        let help = command.clone().render_long_help().to_string();
        match language {
            Language::Zh => chinese::translate_clap_text(&help),
            Language::En => help,
        }
    };
    let Some(first) = args.topic.first() else {
        output::print(&render_help(&program));
        return Ok(EXIT_OK);
    };
    let mut command = program.find_subcommand(first);
    for word in args.topic.iter().skip(1) {
        command = command.and_then(|command| command.find_subcommand(word));
    }
    if let Some(command) = command.filter(|it| !it.is_hide_set()) {
        output::print(&render_help(command));
        return Ok(EXIT_OK);
    }
    let question = args.topic.join(" ");
    let found = search_model(args.model.unwrap_or_default(), &question);
    if found.is_empty() {
        return Err(say::help_nothing(question).into());
    }
    if found.len() <= MAX_FULL_ARTICLES {
        let articles = found
            .iter()
            .map(|topic| article(topic, language).to_string());
        output::print(&articles.collect::<Vec<_>>().join("\n"));
        return Ok(EXIT_OK);
    }
    output::print(&format_headings(
        &found[..found.len().min(MAX_LISTED_TOPICS)],
        language,
    ));
    if found.len() > MAX_LISTED_TOPICS {
        let more = say::help_more(found.len() - MAX_LISTED_TOPICS);
        output::print(&format!("{}\n", more.text(language)));
    }
    Ok(EXIT_OK)
}

/// Formats one line per topic: the words that select it, and its name.
fn format_headings(topics: &[&Topic], language: Language) -> String {
    let line = |topic: &&Topic| {
        let name = gsk_help::subject_name(topic.subject, language);
        let query = match language {
            Language::Zh => designation(topic.subject, language),
            Language::En => topic.subject.to_string(),
        };
        let gap = 24_usize.saturating_sub(text_columns(&query));
        let line = format!("{query}{} {name}", " ".repeat(gap));
        format!("{}\n", line.trim_end())
    };
    topics.iter().map(line).collect()
}
