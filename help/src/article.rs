//! Builds the article of a topic: heading, rule, facts of the tables, example and source.

use core::fmt;
use std::borrow::Cow;

use gsk_messages::{Language, add_key_names, say};

use crate::facts::{facts, subject_name};
use crate::subject::Subject;
use crate::table::Topic;

/// The texts of a help topic in one language.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Article {
    /// Designation of the topic as a user writes it, and its name: `No. 022  Rapid speed, X
    /// axis`. For a part of the panel the name comes first.
    pub heading: String,
    /// What the topic's subject is for and what it does; empty if the tables contain
    /// everything.
    pub rule: Cow<'static, str>,
    /// The facts from the control's tables about the topic's subject, each a sentence.
    pub facts: Vec<String>,
    /// A worked example; empty if there is none.
    pub example: Cow<'static, str>,
    /// A sentence that names the section of the manual. Empty for features that only this
    /// program has.
    pub source: String,
}

/// Returns the texts of a topic in a language.
pub fn article(topic: &Topic, language: Language) -> Article {
    let name = subject_name(topic.subject, language);
    let designation = designation(topic.subject, language);
    Article {
        heading: match (topic.subject, chinese_notion(topic)) {
            (Subject::Notion(_), Some(notion)) if language == Language::Zh => {
                format!("{notion}  {designation}")
            }
            _ if name.is_empty() => designation,
            // Their designation is the name in scripts, which no panel shows.
            (Subject::Key(_) | Subject::Lamp(_) | Subject::Page(_), _) => {
                format!("{name}  {designation}")
            }
            _ => format!("{designation}  {name}"),
        },
        rule: name_keys(topic.rule(language), language),
        facts: facts(topic.subject, language)
            .into_iter()
            .map(|fact| match language {
                Language::Zh => fact,
                Language::En => add_key_names(&fact).into_owned(),
            })
            .collect(),
        example: name_keys(topic.example(language), language),
        source: match topic.source() {
            "" => String::new(),
            section => say::help_source(section).text(language),
        },
    }
}

/// Returns the Chinese name of a notion: its Chinese rule begins with it and a colon.
pub(crate) fn chinese_notion(topic: &Topic) -> Option<&'static str> {
    Some(topic.rule(Language::Zh).split_once('：')?.0)
}

/// Adds the English names of the keys to an English text of the help.
fn name_keys(text: &'static str, language: Language) -> Cow<'static, str> {
    match language {
        Language::Zh => Cow::Borrowed(text),
        Language::En => add_key_names(text),
    }
}

/// Returns the label that the LCD shows in a language. `label` is one text, or Chinese, `|`
/// and English.
fn label_in(label: &str, language: Language) -> &str {
    let (zh, en) = label.split_once('|').unwrap_or((label, label));
    match language {
        Language::Zh => zh,
        Language::En => en,
    }
}

/// Returns how headings name a subject: `alarm 031`, `No. 022`. A search accepts it too.
pub fn designation(subject: Subject<'_>, language: Language) -> String {
    let message = match subject {
        Subject::Alarm(number) => say::help_alarm(format!("{number:03}")),
        Subject::Parameter(number) => say::help_parameter(format!("{number:03}")),
        Subject::Bit(number, bit) => say::help_parameter(format!("{number:03}.{bit}")),
        Subject::Key(id) => say::help_key(id),
        Subject::Lamp(id) => say::help_lamp(id),
        Subject::Page(id) => say::help_page(id),
        Subject::Field("*", label) => say::help_field_everywhere(label_in(label, language)),
        Subject::Field(page, label) => {
            let title = subject_name(Subject::Page(page), language);
            say::help_field(label_in(label, language), title)
        }
        Subject::Diagnosis(number) => say::help_diagnosis(format!("{number:03}")),
        Subject::Code(name) | Subject::Signal(name) | Subject::Notion(name) => {
            return name.to_owned();
        }
    };
    message.text(language)
}

/// Writes the article as text, one paragraph on each line.
impl fmt::Display for Article {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.heading)?;
        if !self.rule.is_empty() {
            writeln!(f, "{}", self.rule)?;
        }
        for fact in &self.facts {
            writeln!(f, "{fact}")?;
        }
        for text in [self.example.as_ref(), &self.source] {
            if !text.is_empty() {
                writeln!(f, "{text}")?;
            }
        }
        Ok(())
    }
}
